"""Random generators, passed explicitly, with separate streams for data, training and evaluation."""

from enum import IntEnum

import numpy as np


class Stream(IntEnum):
    """Purpose of the random numbers; streams of one seed never overlap."""

    EVALUATION = 0
    DATA = 1
    TRAINING = 2
    SCENES = 3
    NOISE = 4


def generator(stream: Stream, *seed: int) -> np.random.Generator:
    """Return a generator of the stream, keyed by any number of non-negative integers (seed, problem number, ...).

    The number of keys is a key too, since a SeedSequence ignores trailing zeros.
    """
    return np.random.Generator(np.random.PCG64(np.random.SeedSequence((int(stream), len(seed), *seed))))
