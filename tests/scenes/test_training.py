"""Training scenes are reproducible, differ from all problems, and vary more widely."""

import hashlib
import itertools
import math
from collections import Counter

import pytest

from ictamp_drake.core.seeding import Stream, generator
from ictamp_drake.scenes.levels import LEVELS, PAPER_LEVELS, problem_files
from ictamp_drake.scenes.packing import make_problem
from ictamp_drake.scenes.spec import SceneSpec, load_scene, to_yaml
from ictamp_drake.scenes.training import CYCLE, MAX_BOXES, training_scene

SCENES = [training_scene(number) for number in range(160)]
WIDER = [spec for number, spec in enumerate(SCENES) if number % CYCLE >= len(PAPER_LEVELS)]


def places(spec: SceneSpec) -> tuple[object, ...]:
    """Places of the boxes, which tell scenes apart."""
    return tuple((name, box.size, box.position, box.rotation) for name, box in sorted(spec.boxes.items()))


def test_the_same_number_gives_the_same_scene_and_another_seed_another() -> None:
    assert [training_scene(number) for number in range(16)] == SCENES[:16]
    assert all(training_scene(number, seed=1) != SCENES[number] for number in range(16))


def test_the_scenes_are_those_that_the_committed_attempts_were_made_in() -> None:
    text = "".join(map(to_yaml, SCENES)).replace("color:", "colour:")  # as it was spelled when the hash was taken
    assert hashlib.sha256(text.encode()).hexdigest() == (
        "1b2056d2cef699c8194d0fd003ffbf36759eef373ca85f6cbb8b61d9b834e34c"
    )


def test_all_scenes_differ() -> None:
    assert len({places(spec) for spec in SCENES}) == len(SCENES)


@pytest.mark.parametrize("level", LEVELS)
def test_no_problem_is_among_them(level: str) -> None:
    committed = {places(load_scene(path)) for path in problem_files(level)}
    made = {places(make_problem(level, number, seed)) for number in range(40) for seed in (0, 1)}
    assert not (committed | made) & {places(spec) for spec in SCENES}


def test_streams_of_scenes_and_data_never_give_the_same_numbers() -> None:
    keys = list(itertools.product(range(3), repeat=3))
    drawn = [generator(stream, *key).integers(2**62) for stream in (Stream.SCENES, Stream.DATA) for key in keys]
    assert len(set(drawn)) == len(drawn)


def test_levels_of_the_problems_take_turns_with_wider_scenes() -> None:
    boxes = [set(training_scene(number).boxes) for number in range(len(PAPER_LEVELS))]
    assert all(set(level.tower) <= names for level, names in zip(PAPER_LEVELS.values(), boxes, strict=True))
    assert {len(spec.boxes) for spec in WIDER} == set(range(1, MAX_BOXES + 1))


def test_wider_scenes_show_all_that_they_promise() -> None:
    seen: Counter[str] = Counter()
    for spec in WIDER:
        for box in spec.boxes.values():
            seen["tipped"] += any(box.rotation[:2])
            seen["behind"] += box.position[0] < -0.15
            seen["raised"] += any(
                s.position[2] > 0.05 and math.dist(s.position[:2], box.position[:2]) < 0.1
                for s in spec.supports.values()
            )
        seen["several supports"] += len(spec.supports) > 2
        seen["table only"] += len(spec.supports) == 1
        seen["tower"] += any(
            math.dist(a.position[:2], b.position[:2]) < 0.02 for a, b in itertools.combinations(spec.boxes.values(), 2)
        )
    kinds = ("tipped", "behind", "raised", "several supports", "table only", "tower")
    assert {kind: seen[kind] for kind in kinds if seen[kind] < 5} == {}


def test_boxes_are_within_reach_and_above_the_table() -> None:
    for spec in WIDER:
        for box in spec.boxes.values():
            assert 0.2 < math.hypot(*box.position[:2]) < 0.75
            assert box.position[2] >= min(box.size) / 2 - 1e-6
