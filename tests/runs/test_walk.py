"""Random walks through training scenes."""

from dataclasses import replace

import numpy as np
import pytest

from ictamp_drake.learning.dataset import Row
from ictamp_drake.runs.walk import WalkConfig, walk
from ictamp_drake.scenes.training import training_scene
from ictamp_drake.symbolic.domain import Domain
from ictamp_drake.world.abstraction import Abstraction
from ictamp_drake.world.simulate import PhysicsConfig
from ictamp_drake.world.world import World

SHORT = WalkConfig(states=5, draws=2)
SCENE = 0


@pytest.fixture(scope="module")
def rows() -> list[Row]:
    return walk(SCENE, 0, SHORT)


def timeless(row: Row) -> dict[str, object]:
    """A row without what differs from run to run."""
    return {name: str(value) for name, value in row.values().items() if not name.endswith("_ms")}


def test_the_same_walk_gives_the_same_rows(rows: list[Row]) -> None:
    assert [timeless(row) for row in walk(SCENE, 0, SHORT)] == [timeless(row) for row in rows]


def test_every_round_has_its_draws_and_every_attempt_its_own_number(rows: list[Row]) -> None:
    assert len(rows) == SHORT.states * SHORT.draws
    assert len({(row.state, row.draw) for row in rows}) == len(rows)
    assert len({row.state for row in rows}) > 1


def test_every_action_was_applicable_and_labels_are_what_physics_says(rows: list[Row]) -> None:
    world = World(training_scene(SCENE))
    abstraction, physics = Abstraction(world), PhysicsConfig().create(world.spec)
    boxes, supports = sorted(world.spec.boxes), sorted(world.spec.supports)
    for row in rows:
        state = abstraction(row.c)
        promised = dict(Domain.create(boxes, supports, state).successors(state))[row.attempt.action]
        if row.attempt.motion:
            assert (abstraction(physics.run(row.c, row.attempt.motion).c) == promised) == row.attempt.succeeded
        else:
            assert not row.attempt.succeeded


def test_the_walk_goes_on_from_where_attempts_ended(rows: list[Row]) -> None:
    ends = {row.attempt.successor for row in rows if row.attempt.succeeded}
    later = {row.c for row in rows if row.state > 0}
    assert later & ends


def test_all_sources_of_k_take_part() -> None:
    found = walk(3, 0, replace(SHORT, states=4, draws=6, optimisation=0.4, perturbed=0.3, uniform=0.3))
    assert {row.sampler for row in found} == {"optimisation", "perturbed", "uniform"}


def test_one_source_alone_can_be_chosen() -> None:
    found = walk(3, 0, replace(SHORT, states=1, draws=3, optimisation=1.0, perturbed=0.0, uniform=0.0))
    assert {row.sampler for row in found} == {"optimisation"}
    assert all(np.isfinite(row.attempt.k).all() for row in found if row.attempt.k is not None)
