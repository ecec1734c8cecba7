"""Commanded opening of the hand."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ictamp_drake.core.errors import Code
from ictamp_drake.skills.base import openings
from ictamp_drake.skills.config import CLEARANCES, PickConfig, PlaceConfig
from tests.panda import GRIPPER, MAX_OPENING
from tests.refusals import refusal


@given(needed=st.floats(0, 0.1), clearances=st.lists(st.floats(0, 0.05), min_size=1, max_size=4))
def test_the_hand_leaves_room_on_both_sides_or_is_as_far_open_as_it_goes(
    needed: float, clearances: list[float]
) -> None:
    commands = openings(GRIPPER, needed, clearances)
    widths = [command.width for command in commands]
    assert len(set(widths)) == len(widths)
    assert all(command.force == 0 for command in commands)
    assert max(widths) <= MAX_OPENING
    for clearance in clearances:
        assert min(needed + 2 * clearance, MAX_OPENING) in widths
    assert all(width >= min(needed + 2 * min(clearances), MAX_OPENING) for width in widths)


def test_a_comfortable_opening_is_tried_first() -> None:
    assert list(CLEARANCES) == sorted(CLEARANCES, reverse=True)


@pytest.mark.parametrize("config", [PickConfig, PlaceConfig])
@pytest.mark.parametrize(("clearances", "code"), [((), Code.EMPTY), ((0.01, -0.001), Code.OUT_OF_RANGE)])
def test_clearances_are_checked(
    config: type[PickConfig | PlaceConfig], clearances: tuple[float, ...], code: Code
) -> None:
    with refusal(code, value=clearances):
        config(clearances=clearances)
