"""The live view follows the planner's events."""

from dataclasses import replace

import numpy as np
import pytest

from ictamp_drake.core.failures import Failure
from ictamp_drake.core.types import Action, Attempt
from ictamp_drake.planning.events import Event, PlanOpened, StepDone, StepStarted, Verified
from ictamp_drake.planning.tree import Node
from ictamp_drake.viz.live import LiveView
from tests.viz.meshcat_page import download, position
from tests.viz.scene import SPEC, START, swing

PICK = Action("pick", ("blue_box", "table"))
MOVED = swing(1.0)
ROOT, CHILD = Node(0, START, frozenset()), Node(1, MOVED, frozenset(), parent=0)


@pytest.fixture(scope="module")
def view() -> LiveView:
    return LiveView()


def blue(view: LiveView) -> np.ndarray:
    return position(download(view.url), "/scene/blue_box/blue_box")


@pytest.mark.parametrize(
    ("event", "c"),
    [
        (StepStarted(ROOT, PICK), START),
        (StepDone(ROOT, Attempt(PICK, None, MOVED), CHILD), MOVED),
        (StepDone(ROOT, Attempt(PICK, Failure.SLIPPED, MOVED), None), MOVED),
        (Verified(CHILD, (), True), MOVED),
    ],
)
def test_every_low_level_step_is_shown(view: LiveView, event: Event, c: object) -> None:
    listener = view.listener(SPEC)
    listener(StepStarted(Node(2, swing(0.3), frozenset()), PICK))
    listener(event)
    np.testing.assert_allclose(blue(view), (START if c is START else MOVED).poses["blue_box"][4:])


@pytest.mark.parametrize(
    "event", [PlanOpened(None, 1000, False), StepDone(ROOT, Attempt(PICK, Failure.NO_INVERSE_KINEMATICS), None)]
)
def test_what_moves_nothing_leaves_the_view_as_it_is(view: LiveView, event: Event) -> None:
    listener = view.listener(SPEC)
    listener(StepStarted(CHILD, PICK))
    listener(event)
    np.testing.assert_allclose(blue(view), MOVED.poses["blue_box"][4:])


def test_the_next_problem_takes_the_place_of_the_last(view: LiveView) -> None:
    view.listener(SPEC)(StepStarted(ROOT, PICK))
    assert b"red_box" in b"".join(download(view.url))
    without = replace(SPEC, boxes={"blue_box": SPEC.boxes["blue_box"]})
    c = replace(START, poses={"blue_box": START.poses["blue_box"]})
    view.listener(without)(StepStarted(Node(0, c, frozenset()), PICK))
    commands = download(view.url)
    assert b"red_box" not in b"".join(commands)
    np.testing.assert_allclose(position(commands, "/scene/blue_box/blue_box"), c.poses["blue_box"][4:])


def test_the_address_is_printed_once(capfd: pytest.CaptureFixture[str]) -> None:
    url = LiveView().url
    assert url.startswith("http://localhost:")
    out, err = capfd.readouterr()
    assert (out + err).count(url) == 1
