"""Grippers with two fingers: the joints that a width takes, and the efforts that a grip force takes."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ictamp_drake.core.types import FloatArray
from ictamp_drake.robots.hand import Hand
from ictamp_drake.robots.spec import GripperSpec

_STRAIGHT = 1e-9
"""Largest deviation from a straight line up to which joints count as proportional to the width [m or rad]."""


@dataclass(frozen=True, eq=False)
class Gripper:
    """A gripper as its fingers move, from closed to open.

    Attributes:
        spec: Description of the gripper.
        joints: Names of all joints of the fingers, in the order of `Configuration.fingers`.
        driven: Numbers of the driven ones among them.
        hand: Measures of the hand.
        widths: Distances between the pads, ascending, shape (n,) [m].
        places: Positions of all joints at these widths, shape (n, joints) [rad or m].
        rises: Positions of the pads' centers along G's z axis at these widths, shape (n,) [m].
        pulls: Change of each pad's distance from the other by each driven joint at these widths, shape (n, driven, 2)
            [m/rad or 1].
    """

    spec: GripperSpec
    joints: tuple[str, ...]
    driven: tuple[int, ...]
    hand: Hand
    widths: FloatArray
    places: FloatArray
    rises: FloatArray
    pulls: FloatArray

    @property
    def opening(self) -> float:
        """Largest distance between the pads [m]."""
        return self.spec.opening

    @property
    def max_side(self) -> float:
        """Widest side of a box that is gripped [m]."""
        return self.spec.max_side

    @property
    def force(self) -> float:
        """Largest continuous force of each finger [N]."""
        return self.spec.force

    @property
    def speed(self) -> float:
        """Speed of each finger [m/s]."""
        return self.spec.speed

    @cached_property
    def shares(self) -> FloatArray | None:
        """Position of each joint as a multiple of the width, shape (joints,); None for linkages."""
        shares = np.round((self.places[-1] - self.places[0]) / np.ptp(self.widths), 9)
        is_straight = np.abs(self.places - self.widths[:, None] * shares).max() < _STRAIGHT
        return shares if is_straight else None

    def positions(self, width: float) -> FloatArray:
        """Return the positions of all joints of the fingers at a width [m], shape (joints,)."""
        return self._places(np.array([width]))[0]

    @cached_property
    def movers(self) -> tuple[int, int]:
        """Numbers of the driven joints, among all joints, that move the first and the second pad."""
        first, second = np.abs(self.pulls).max(axis=0).argmax(axis=0)
        return self.driven[int(first)], self.driven[int(second)]

    def enclose(self, width: float, middle: float) -> FloatArray:
        """Return the positions of all joints at which the pads touch something of a width, shape (joints,).

        Args:
            width: Its width [m].
            middle: Position of its center along G's y axis [m]. It is ignored if one joint drives both fingers.
        """
        places = self.positions(width)
        first, second = self.movers
        if self.shares is None or first == second:
            return places
        for joint, side in ((first, 1.0), (second, -1.0)):
            open_ = self.opening * self.shares[joint]
            place = (width / 2 + side * middle) * 2 * self.shares[joint]
            places[joint] = np.clip(place, min(open_, 0.0), max(open_, 0.0))
        return places

    def drive(self, widths: FloatArray) -> FloatArray:
        """Return the positions of the driven joints at widths, shape (n,) [m] -> (driven, n)."""
        return self._places(widths)[:, list(self.driven)].T

    def _places(self, widths: FloatArray) -> FloatArray:
        if self.shares is not None:
            return widths[:, None] * self.shares
        columns = [np.interp(widths, self.widths, column) for column in self.places.T]
        return np.stack(columns, axis=-1)

    def efforts(self, widths: FloatArray, forces: FloatArray) -> FloatArray:
        """Return the efforts of the driven joints that press each finger inwards.

        Args:
            widths: Distances between the pads, shape (n,) [m].
            forces: Forces of each finger, shape (n,) [N].

        Returns:
            Shape (driven, n) [N m or N], by virtual work: the force times the change of the width.
        """
        pulls = self.pulls.sum(axis=2).T
        return np.array([-forces * np.interp(widths, self.widths, pull) for pull in pulls])

    def width(self, fingers: FloatArray) -> float:
        """Return the distance between the pads at positions of all joints, shape (joints,) [rad or m] -> [m]."""
        if self.shares is not None:
            moving = self.shares != 0
            return float(np.mean(fingers[moving] / self.shares[moving]))
        (first, *_) = self.driven
        column = self.places[:, first]
        order = np.argsort(column)
        return float(np.interp(fingers[first], column[order], self.widths[order]))

    def rise(self, width: float) -> float:
        """Return how far along G's z axis the pads' centers are when they are `width` apart [m]."""
        return float(np.interp(width, self.widths, self.rises))

    def gains(self, stiffness: float | None = None, damping: float | None = None) -> tuple[FloatArray, FloatArray]:
        """Return stiffness and damping of the driven joints' controllers, each of shape (driven,).

        Those of the pads are converted by the lever arms at the middle of the widths.

        Args:
            stiffness: Stiffness at the pads [N/m]; by default that of the robot's file.
            damping: Damping at the pads [N s/m]; by default that of the robot's file.
        """
        levers = (self.pulls[len(self.pulls) // 2] ** 2).sum(axis=1)
        stiffness = self.spec.stiffness if stiffness is None else stiffness
        return stiffness * levers, (self.spec.damping if damping is None else damping) * levers
