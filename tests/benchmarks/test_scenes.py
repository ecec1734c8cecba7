"""The committed scenes equal those of their generator, and planning can start in them."""

from pathlib import Path

import pytest

from benchmarks import small_scenes
from benchmarks.scenes import COUNT, KINDS, SCENES, WARM_UP, write_scenes
from benchmarks.small_scenes import SMALL
from ictamp_drake.scenes.spec import load_scene
from ictamp_drake.tamp.method import Method
from ictamp_drake.tamp.task import load
from tests.scenes.solids import check_clearances

FILES = [*(SCENES / kind / f"{number:02d}.yaml" for kind in KINDS for number in range(COUNT)), WARM_UP]
MANY, FEW = SCENES / "bystanders" / "many.yaml", SCENES / "bystanders" / "few.yaml"
FIRST = [SCENES / kind / "00.yaml" for kind in KINDS]


def test_the_generator_writes_the_committed_bytes(tmp_path: Path) -> None:
    write_scenes(tmp_path)
    written = {path.relative_to(tmp_path): path.read_bytes() for path in tmp_path.rglob("*.yaml")}
    assert written == {path.relative_to(SCENES): path.read_bytes() for path in FILES}


def test_no_two_scenes_have_a_cube_in_the_same_place() -> None:
    places = [box.position for path in FILES for box in load_scene(path).boxes.values()]
    assert len(set(places)) == len(places)


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(SCENES)))
def test_cubes_stand_apart_and_the_goal_is_about_them(path: Path) -> None:
    spec = load_scene(path)
    check_clearances(spec)
    tower = path.parent.name if path != WARM_UP else "tower_2"
    assert len(spec.boxes) in (range(3, 7) if tower == "scattered" else [int(tower[-1])])
    assert spec.goal.count("(on ") == (2 if tower == "scattered" else len(spec.boxes))


@pytest.mark.parametrize("path", [*FIRST, FEW, pytest.param(MANY, marks=pytest.mark.slow)])
def test_planning_can_begin(path: Path) -> None:
    task = load(path, Method())
    assert not task.goal.holds(task.abstraction(task.c))


def test_the_scenes_with_and_without_bystanders_share_their_cubes() -> None:
    many, few = load_scene(MANY), load_scene(FEW)
    assert (len(many.boxes), len(few.boxes)) == (21, 4)
    assert few.boxes.items() <= many.boxes.items()
    assert few.supports == many.supports


def test_small_scenes_are_committed_as_their_generator_writes_them(tmp_path: Path) -> None:
    small_scenes.write_scenes(tmp_path)
    written = {path.relative_to(tmp_path): path.read_bytes() for path in tmp_path.rglob("*.yaml")}
    assert written == {path.relative_to(SMALL): path.read_bytes() for path in SMALL.rglob("*.yaml")}
    assert len(written) == 2 * small_scenes.COUNT


@pytest.mark.parametrize(("group", "most"), small_scenes.MOST_BOXES.items())
def test_no_goal_of_a_small_scene_holds_at_its_start(group: str, most: int) -> None:
    for path in sorted((SMALL / group).glob("*.yaml"))[::5]:
        task = load(path, Method())
        assert 2 <= len(task.spec.boxes) <= most
        assert not task.goal.holds(task.s)
