"""Random walks through training scenes."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from ictamp_drake.collection.walk import Sources, WalkConfig, walk
from ictamp_drake.core.errors import Code
from ictamp_drake.learning.dataset import AttemptRow
from ictamp_drake.scenes.training import training_scene
from ictamp_drake.symbolic.domain import Domain
from ictamp_drake.world.abstraction import SceneAbstraction
from ictamp_drake.world.config import PhysicsConfig
from ictamp_drake.world.world import World
from tests.learning.synthetic import write_untrained
from tests.refusals import refusal

SHORT = WalkConfig(states=5, draws=2)
SCENE = 0


@pytest.fixture(scope="module")
def rows() -> list[AttemptRow]:
    return walk(SCENE, 0, SHORT)


def timeless(row: AttemptRow) -> dict[str, object]:
    """A row without the values that differ from run to run."""
    return {name: str(value) for name, value in row.values().items() if not name.endswith("_ms")}


def test_the_same_walk_gives_the_same_rows(rows: list[AttemptRow]) -> None:
    assert [timeless(row) for row in walk(SCENE, 0, SHORT)] == [timeless(row) for row in rows]


def test_every_round_has_its_draws_and_every_attempt_its_own_number(rows: list[AttemptRow]) -> None:
    assert len(rows) == SHORT.states * SHORT.draws
    assert len({(row.state, row.draw) for row in rows}) == len(rows)
    assert len({row.state for row in rows}) > 1


def test_every_action_was_applicable_and_labels_are_what_physics_says(rows: list[AttemptRow]) -> None:
    world = World(training_scene(SCENE))
    abstraction, physics = SceneAbstraction(world), PhysicsConfig().create(world)
    boxes, supports = sorted(world.spec.boxes), sorted(world.spec.supports)
    for row in rows:
        state = abstraction(row.c)
        promised = dict(Domain.create(boxes, supports, state).successors(state))[row.attempt.action]
        if row.attempt.motion:
            assert (abstraction(physics.run(row.c, row.attempt.motion).c) == promised) == row.attempt.succeeded
        else:
            assert not row.attempt.succeeded


def test_the_walk_goes_on_from_where_attempts_ended(rows: list[AttemptRow]) -> None:
    ends = {row.attempt.successor for row in rows if row.attempt.succeeded}
    later = {row.c for row in rows if row.state > 0}
    assert later & ends


def test_an_attempt_can_be_left_out(rows: list[AttemptRow]) -> None:
    begun: list[int] = []
    found = walk(SCENE, 0, SHORT, spared=[1], begin=begun.append)
    assert begun == [0, *range(2, SHORT.states * SHORT.draws)]
    assert len(found) == len(begun)
    assert timeless(found[0]) == timeless(rows[0])


def test_all_sources_of_k_take_part() -> None:
    found = walk(3, 0, replace(SHORT, states=4, draws=6, sources=Sources(4, 3, 3)))
    assert {row.sampler for row in found} == {"optimization", "perturbed", "uniform"}


def test_one_source_alone_can_be_chosen() -> None:
    found = walk(3, 0, replace(SHORT, states=1, draws=3, sources=Sources(1, 0, 0)))
    assert {row.sampler for row in found} == {"optimization"}
    assert all(np.isfinite(row.attempt.k).all() for row in found if row.attempt.k is not None)


def test_trained_policies_are_compared_with_other_sources_attempt_by_attempt(tmp_path: Path) -> None:
    folder = write_untrained(tmp_path)
    sources = Sources(1, 0, 0, policy=1, best=1, product=1, reference=1)
    config = replace(SHORT, states=2, draws=2, sources=sources, compare=True, checkpoints=folder, reference=folder)
    found = walk(3, 0, config)
    assert [row.sampler for row in found] == 4 * ["optimization", "policy", "best", "product", "reference"]
    assert all(len({(row.c, row.attempt.action) for row in found[start : start + 10]}) == 1 for start in (0, 10))
    product = [row.attempt for row in found if row.sampler == "product"]
    assert all(attempt.motion or len(attempt.rejections) == 15 for attempt in product)


@pytest.mark.parametrize(
    ("make", "code", "field"),
    [
        (lambda: Sources(policy=-1), Code.OUT_OF_RANGE, "walk.sources.policy"),
        (lambda: Sources(0, 0, 0), Code.OUT_OF_RANGE, "walk.sources"),
        (lambda: WalkConfig(draws=0), Code.OUT_OF_RANGE, "walk.draws"),
        (lambda: WalkConfig(sources=Sources(reference=1)), Code.CONFLICT, "walk.reference"),
        (lambda: WalkConfig(sources=Sources(best=1), checkpoints=Path("/nowhere")).check(), Code.NOT_FOUND, ""),
    ],
)
def test_mistakes_are_refused(make: Callable[[], object], code: Code, field: str) -> None:
    with refusal(code, field):
        make()
