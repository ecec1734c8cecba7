"""Splines from 0 to 1 with evenly spaced knots: their derivatives, and the quickest ways from rest to rest."""

from functools import lru_cache

import numpy as np

from ictamp_drake.core.types import FloatArray


@lru_cache
def knots(points: int, order: int) -> FloatArray:
    """Knots of a spline with `points` control points, shape (points + order,)."""
    degree = order - 1
    found = np.concatenate([np.zeros(degree), np.linspace(0.0, 1.0, points - degree + 1), np.ones(degree)])
    found.setflags(write=False)
    return found


@lru_cache
def differentiation(points: int, order: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Matrices that turn control points into those of the first, second and third derivative.

    Returns:
        Shapes (points - 1, points), (points - 2, points) and (points - 3, points).
    """
    t, matrix, found = knots(points, order), np.eye(points), []
    for degree in range(order - 1, order - 4, -1):
        widths = t[degree + 1 : -1] - t[1 : -degree - 1]
        matrix = degree * np.diff(matrix, axis=0) / widths[:, None]
        found.append(matrix)
        t = t[1:-1]
    first, second, third = found
    return first, second, third


@lru_cache
def paces(points: int, order: int) -> FloatArray:
    """Ways from 0 to 1 from rest to rest as control points of splines, shape (number, points).

    The first three control points coincide, and so do the last three. All ways accelerate evenly, cruise, and slow
    down in the same manner. They differ in how long they cruise.
    """
    free = points - 4
    return np.array([_pace(free, cruise, order) for cruise in range(free % 2, free - 1, 2)])


def _pace(free: int, cruise: int, order: int) -> FloatArray:
    """Control points integrated from those of the acceleration: `free` between the ends, of which `cruise` are zero."""
    up = np.ones((free - cruise) // 2)
    acceleration = np.concatenate([[0.0], up, np.zeros(cruise), -up, [0.0]])
    t, degree = knots(free + 4, order), order - 1
    speed = np.append(0.0, np.cumsum(acceleration * (t[degree + 1 : -2] - t[2 : -degree - 1])))
    way = np.append(0.0, np.cumsum(speed * (t[degree + 1 : -1] - t[1 : -degree - 1])))
    way /= way[-1]
    way[-3:] = 1.0  # exactly
    return way
