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
    """The same rotations, each with the sign nearer to the one before, shape (n, 4)."""
    agree = np.sum(quaternions[1:] * quaternions[:-1], axis=1) >= 0
    signs = np.cumprod(np.append(1.0, np.where(agree, 1.0, -1.0)))
    return quaternions * signs[:, None]
