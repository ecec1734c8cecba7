"""Motions that stay in place, for tests of durations and labels."""

import numpy as np

from ictamp_drake.core.types import GripperCommand, Segment


def stay(duration: float, label: str = "stay") -> Segment:
    """A segment of the given duration [s] in which the arm stands still."""
    return Segment(label, duration, GripperCommand(0.08), 1, np.array([0.0, duration]), np.zeros((1, 7)))
