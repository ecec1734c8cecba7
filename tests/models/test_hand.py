"""The measures of the Panda's hand in its file, and those of the networks, agree with the collision shapes."""

from itertools import product

import numpy as np
from scipy.spatial.transform import Rotation

from ictamp_drake.core.types import FloatArray
from ictamp_drake.learning.clearance import FINGER, OPENING, PALM
from ictamp_drake.models.panda import FINGER_OFFSET, GRASP_OFFSET
from ictamp_drake.models.sdf_text import Shape
from ictamp_drake.robots.hand import Outline
from tests.panda import HAND, MAX_OPENING, MAX_SIDE, TIP
from tools.panda import panda_collision


def corners(*shapes: Shape) -> FloatArray:
    """Corners of boxes in their link's frame, shape (n, 3) [m]."""
    signs = np.array(list(product((-0.5, 0.5), repeat=3)))
    turned = [Rotation.from_euler("xyz", shape.rpy).apply(signs * shape.size) + shape.xyz for shape in shapes]
    return np.concatenate(turned)


def check_outline(outline: Outline, points: FloatArray, offset: float) -> None:
    """Assert that the outline contains the points, `offset` [m] from the flange, with less than 1 mm of room."""
    middle = (points.min(axis=0) + points.max(axis=0))[:2] / 2
    half = np.abs(points[:, :2] - middle).max(axis=0)
    bottom = GRASP_OFFSET - offset - points[:, 2].max()
    room = np.array([outline.half_length - half[0], outline.half_width - half[1], bottom - outline.bottom])
    assert np.all(room > -1e-9)
    assert np.all(room < 1e-3)


def test_outlines_hold_the_collision_shapes() -> None:
    check_outline(HAND.finger, corners(*panda_collision.FINGER, panda_collision.PAD), FINGER_OFFSET)
    (palm,) = (shape for shape in panda_collision.LINKS["panda_hand"] if shape.name == "palm")
    check_outline(Outline(*PALM), corners(palm), 0.0)


def test_tips_are_below_the_pads_and_sides_fit_into_the_opening() -> None:
    assert -HAND.finger.bottom < TIP < -HAND.finger.bottom + 0.005
    assert 0.002 < MAX_OPENING - MAX_SIDE < 0.01


def test_networks_know_the_same_hand() -> None:
    assert HAND.finger == FINGER
    assert HAND.palm == PALM[2]
    assert MAX_OPENING == OPENING
