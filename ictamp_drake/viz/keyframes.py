"""Which moments of a recorded track must be kept, so that straight lines between them show the rest."""

import numpy as np

from ictamp_drake.core.types import FloatArray


def keyframes(times: FloatArray, values: FloatArray, tolerance: float) -> list[int]:
    """Indices of the moments to keep, in order (Ramer, Douglas and Peucker's algorithm over time).

    Args:
        times: increasing [s], shape (n,).
        values: what is recorded at them, shape (n, m).
        tolerance: how far any value may be from the line between two moments kept.

    Returns:
        First and last and what is needed between them; the first alone when nothing moves.
    """
    last = len(times) - 1
    if np.all(np.abs(values - values[0]) <= tolerance):
        return [0]
    kept, spans = {0, last}, [(0, last)]
    while spans:
        start, end = spans.pop()
        share = (times[start : end + 1] - times[start]) / (times[end] - times[start])
        line = values[start] + share[:, None] * (values[end] - values[start])
        error = np.max(np.abs(values[start : end + 1] - line), axis=1)
        if np.max(error) > tolerance:
            middle = start + int(np.argmax(error))
            kept.add(middle)
            spans += [(start, middle), (middle, end)]
    return sorted(kept)


def same_hemisphere(quaternions: FloatArray) -> FloatArray:
    """The same rotations, each with the sign nearer to the one before, shape (n, 4)."""
    agree = np.sum(quaternions[1:] * quaternions[:-1], axis=1) >= 0
    signs = np.cumprod(np.append(1.0, np.where(agree, 1.0, -1.0)))
    return quaternions * signs[:, None]
