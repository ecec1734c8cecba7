"""A small scene and a short motion for the tests of pictures: the arm swings and carries one box along."""

from dataclasses import replace

import numpy as np

from ictamp_drake.core.types import Configuration
from ictamp_drake.scenes.spec import BoxSpec, SceneSpec, SupportSpec
from ictamp_drake.world.outcome import Frame
from tests.panda import HOME

SPEC = SceneSpec(
    supports={"table": SupportSpec("table", (0.3, 0.0, 0.0)), "rack": SupportSpec("rack", (0.44, -0.3, 0.16), 90.0)},
    boxes={
        "red_box": BoxSpec((0.05, 0.05, 0.118), (0.65, 0.2, 0.059), color=(0.82, 0.16, 0.16)),
        "blue_box": BoxSpec((0.05, 0.05, 0.106), (0.45, 0.0, 0.053), color=(0.16, 0.32, 0.75)),
    },
    goal="(on red_box rack)",
)

DURATION = 20.0
"""Duration of the motion [s]."""


START = Configuration(HOME, np.array([0.04, 0.04]), {name: box.X_WO for name, box in SPEC.boxes.items()})
"""The arm at home, the boxes on the table."""


def swing(share: float) -> Configuration:
    """The arm turned to its left, and the blue box moved along, by a share of the whole motion."""
    q = START.q + share * np.array([0.9, 0.3, 0, 0, 0, 0, 0])
    blue = START.poses["blue_box"] + share * np.array([0, 0, 0, 0, 0.15, 0.0, 0.0])
    return replace(START, q=q, poses={**START.poses, "blue_box": blue})


def recording() -> list[Frame]:
    """The motion at 30 Hz."""
    return [Frame(time, swing(time / DURATION)) for time in np.linspace(0.0, DURATION, 601)]
