"""Files that once ended the program, or took all of its time: each is refused in a short sentence at once, or read."""

import time
from dataclasses import replace
from pathlib import Path

import pytest

from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.scenes.spec import MAX_BOXES, MAX_BYTES, MAX_SUPPORTS, load_scene
from ictamp_drake.symbolic.goal_reading import parse_goal
from ictamp_drake.tamp.task import load
from tests.refusals import refusal

FILES = Path(__file__).parent / "cases" / "files"
LONGEST = 1000

REFUSED = {
    "f01-yaw-of-310-digits": (Code.WRONG_TYPE, "supports.rack.yaw"),
    "f02-seed-of-310-digits": (Code.WRONG_TYPE, "seed"),
    "f03-seed-of-3600-hex-digits": (Code.TOO_LARGE, ""),
    "f04-sexagesimal-float": (Code.NOT_YAML, ""),
    "f05-nested-lists-492": (Code.TOO_DEEP, ""),
    "f06-nested-maps-327": (Code.TOO_DEEP, ""),
    "f07-goal-of-498-brackets": (Code.NOT_PDDL, "goal"),
    "f09-aliases-in-a-field": (Code.TOO_LARGE, ""),
}
SCENE = (FILES / "f08-colour-1e-38.yaml").read_text()


def sentence_of(path: Path) -> str:
    """Return the sentence with which a scene is refused, after less than a second of computing."""
    started = time.process_time()
    with pytest.raises(IctampError) as caught:
        load(path)
    text = str(caught.value)
    assert time.process_time() - started < 1
    assert text.isprintable()
    assert len(text) < LONGEST + len(str(path))
    return text


@pytest.mark.parametrize("name", REFUSED)
def test_a_broken_file_is_refused_at_once(name: str) -> None:
    code, field = REFUSED[name]
    path = FILES / f"{name}.yaml"
    sentence_of(path)
    with refusal(code, field, file=path):
        load(path)


def test_a_color_near_zero_is_dark() -> None:
    assert load(FILES / "f08-colour-1e-38.yaml").goal


@pytest.mark.slow
def test_thirty_boxes_are_ready_for_planning_within_five_seconds() -> None:
    load(FILES / "f08-colour-1e-38.yaml")  # loads modules
    started = time.process_time()
    assert len(load(FILES / "f10-thirty-boxes.yaml").spec.boxes) == 30
    assert time.process_time() - started < 5


@pytest.mark.parametrize(
    "text",
    {
        "accounts": "root:x:0:0:root:/root:/bin/bash\n" * 1000,
        "long name": SCENE.replace("red_box", "x" * 100_000),
        "long field": SCENE + f"{'y' * 100_000}: 1",
        "long key": SCENE + f"? {'y' * 100_000}\n: 1",
        "long goal": SCENE.replace("(on red_box rack)", f"(on red_box {'z' * 100_000})"),
        "large goal": SCENE.replace("(on red_box rack)", f"(and {'(on red_box rack) ' * 5_000} (on red_box table))"),
        "many boxes": SCENE.replace("boxes:", "boxes:\n" + "".join(f"  b{n}: {{mass: 1}}\n" for n in range(5_000))),
        "long number": SCENE + f"seed: {'9' * 100_000}",
        "long binary": SCENE + f"seed: 0b{'1' * 100_000}",
        "long time": SCENE + f"seed: 1{':59' * 40_000}",
        "long date": SCENE + f"seed: 2020-01-01 00:00:00.{'1' * 100_000}",
        "long tag": SCENE + f"seed: !{'t' * 100_000} 1",
        "long anchor": SCENE + f"seed: &{'t' * 100_000} [1]",
        "many numbers": SCENE + f"seed: [{'0,' * 60_000}]",
        "brackets": SCENE + f"seed: {'[],' * 40_000}",
        "open brackets": SCENE + f"seed: [{'[0],' * 30_000}",
        "many lines": SCENE + f"description: {chr(10) * 100_000}",
        "a name on two lines": SCENE + '"a\\nb\\u2028\\e[31m": 1',
        "too large": SCENE + "#" * MAX_BYTES,
    }.items(),
    ids=lambda pair: pair[0],
)
def test_what_is_long_is_refused_at_once_and_quoted_in_part(text: tuple[str, str], tmp_path: Path) -> None:
    path = tmp_path / "scene.yaml"
    path.write_text(text[1])
    sentence_of(path)


def test_a_file_of_accounts_is_not_quoted_at_length() -> None:
    assert len(sentence_of(Path("/etc/passwd"))) < 400


def test_an_unknown_object_does_not_list_all_boxes(tmp_path: Path) -> None:
    box = "{size: [0.05, 0.05, 0.1], position: [0.45, 0.1, 0.05]}"
    path = tmp_path / "scene.yaml"
    boxes = "".join(f"  b{number}_{'x' * 90}: {box}\n" for number in range(MAX_BOXES - 1))
    path.write_text(SCENE.replace("boxes:\n", f"boxes:\n{boxes}").replace("(on red_box rack)", "(on red_bix rack)"))
    spec = load_scene(path)
    with pytest.raises(IctampError) as caught:
        parse_goal(spec.goal, sorted(spec.boxes), sorted(spec.supports))
    assert len(str(caught.value)) < 500


@pytest.mark.parametrize(("old", "section"), [("red_box", "boxes"), ("rack", "supports")])
@pytest.mark.parametrize("name", ["on", "upright", "pick", "thing"])
def test_a_name_that_the_planning_domain_has_is_refused_in_its_file(
    old: str, section: str, name: str, tmp_path: Path
) -> None:
    path = tmp_path / "scene.yaml"
    text = SCENE.replace(f"  {old}:", f"  '{name}':").replace("(on red_box rack)", "(on BOX RACK)")
    path.write_text(
        text.replace("BOX", name if old == "red_box" else "red_box").replace("RACK", name if old == "rack" else "rack")
    )
    with refusal(Code.BAD_NAME, f"{section}.{name}", file=path):
        load(path)


@pytest.mark.parametrize(
    ("section", "area"), [("regions", "{on: table, size: [0.1, 0.1]}"), ("poses", "{on: table, position: [0, 0]}")]
)
def test_such_a_name_of_a_region_or_pose_is_refused_too(section: str, area: str, tmp_path: Path) -> None:
    path = tmp_path / "scene.yaml"
    path.write_text(SCENE + f"{section}: {{upright: {area}}}\n")
    with refusal(Code.BAD_NAME, f"{section}.upright", file=path):
        load(path)


@pytest.mark.parametrize(("section", "most"), [("boxes", MAX_BOXES), ("supports", MAX_SUPPORTS)])
def test_more_than_can_be_planned_for_is_refused(section: str, most: int) -> None:
    scene = load_scene(FILES / "f08-colour-1e-38.yaml")
    (_, one), *_ = getattr(scene, section).items()
    with refusal(Code.TOO_LARGE, section, value=most + 1):
        replace(scene, **{section: {f"b{number}": one for number in range(most + 1)}})


def test_ends_of_ranges_are_exact() -> None:
    with pytest.raises(IctampError) as caught:
        replace(load_scene(FILES / "f08-colour-1e-38.yaml"), seed=2**63)
    assert str(2**63 - 1) in str(caught.value)
    assert str(2**63) in str(caught.value)
