"""Random streams: explicit generators handed down, apart for data, training and evaluation."""

from enum import IntEnum

import numpy as np


class Stream(IntEnum):
    """What the numbers are for; streams of one seed never overlap."""

    EVALUATION = 0
    DATA = 1
    TRAINING = 2
    SCENES = 3


def generator(stream: Stream, *seed: int) -> np.random.Generator:
    """A generator for the stream, keyed by any number of non-negative integers (seed, problem number, ...).

    The number of keys is one of them, since a SeedSequence ignores zeros at its end.
    """
    return np.random.Generator(np.random.PCG64(np.random.SeedSequence((int(stream), len(seed), *seed))))
