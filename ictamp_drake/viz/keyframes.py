"""Keyframes of a recorded track: moments to keep so that straight lines between them approximate the rest."""

import numpy as np

from ictamp_drake.core.types import FloatArray


def keyframes(times: FloatArray, values: FloatArray, tolerance: float) -> list[int]:
    """Return the indices of the moments to keep, in order (Ramer-Douglas-Peucker algorithm over time).

    Args:
        times: Increasing times [s], shape (n,).
        values: Recorded values at these times, shape (n, m).
        tolerance: Maximum distance of any value from the line between two kept moments.

    Returns:
        The first moment, the last one and those needed between them; only the first one when nothing moves.
    """
    last = len(times) - 1
    if np.all(np.abs(values - values[0]) <= tolerance):
        return [0]
    kept, spans = {0, last}, [(0, last)]
    while spans:
        begin, end = np.array(spans).T
        count = end - begin + 1
        stops = np.cumsum(count)
        span = np.repeat(np.arange(len(spans)), count)
        moment = np.arange(len(span)) - (stops - count - begin)[span]
        share = (times[moment] - times[begin][span]) / (times[end] - times[begin])[span]
        line = values[begin][span] + share[:, None] * (values[end] - values[begin])[span]
        error = np.abs(values[moment] - line).max(axis=1)
        worst = [int(start + np.argmax(error[start:stop])) for start, stop in zip(stops - count, stops, strict=True)]
        split = [(*spans[span[at]], int(moment[at])) for at in worst if error[at] > tolerance]
        kept.update(middle for _, _, middle in split)
        spans = [part for start, stop, middle in split for part in ((start, middle), (middle, stop))]
    return sorted(kept)


def same_hemisphere(quaternions: FloatArray) -> FloatArray:
    """Flip signs so that each quaternion is nearest to the previous one; the rotations stay the same, shape (n, 4)."""
    agree = np.sum(quaternions[1:] * quaternions[:-1], axis=1) >= 0
    signs = np.cumprod(np.append(1.0, np.where(agree, 1.0, -1.0)))
    return quaternions * signs[:, None]
