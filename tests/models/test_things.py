"""Sizes read from the committed files of boxes and supports agree with those that Drake reads."""

import numpy as np
import pytest
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant

from ictamp_drake.models.things import BOXES, FOLDER, SUPPORTS, read_thing
from ictamp_drake.scenes.levels import PAPER_LEVELS
from ictamp_drake.scenes.spec import SupportSpec


def test_every_box_of_a_level_has_a_file() -> None:
    used = {name for level in PAPER_LEVELS.values() for name in (*level.tower, *level.bystanders, *level.extras)}
    assert used == set(BOXES)


@pytest.mark.parametrize("name", BOXES)
def test_mass_and_sides_are_those_of_the_body(name: str) -> None:
    plant = MultibodyPlant(0.0)
    Parser(plant).AddModels(str(FOLDER / f"{name}.sdf"))
    plant.Finalize()
    thing, body = read_thing(name), plant.GetBodyByName(name)
    assert body.default_mass() == thing.mass
    moments = body.default_spatial_inertia().CalcRotationalInertia().get_moments()
    squares = np.array(thing.size) ** 2
    np.testing.assert_allclose(moments, thing.mass / 12 * (squares.sum() - squares), rtol=1e-9)


@pytest.mark.parametrize("kind", SUPPORTS)
def test_supports_have_the_size_of_their_kind(kind: str) -> None:
    assert SupportSpec(kind, (0.0, 0.0, 0.0)).size == read_thing(kind).size
