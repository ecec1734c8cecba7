"""k from several samplers, which take turns."""

from collections.abc import Iterator, Sequence
from itertools import islice

import numpy as np

from ictamp_drake.core.failures import Failure
from ictamp_drake.core.protocols import Sampler, Selective
from ictamp_drake.core.types import Action, Configuration, Parameter


class ChainSampler:
    """Samplers in turns. Those that do not apply to an action are left out.

    Args:
        samplers: Samplers, the most promising first.
        turn: Number of k that a sampler draws in its turn.
    """

    def __init__(self, samplers: Sequence[Sampler[Configuration]], turn: int) -> None:
        self._samplers = samplers
        self._turn = turn

    def serving(self, c: Configuration, action: Action) -> list[Sampler[Configuration]]:
        """Samplers that apply to the action from c."""
        return [each for each in self._samplers if not isinstance(each, Selective) or each.applies(c, action)]

    def draws(self, c: Configuration, action: Action, rng: np.random.Generator) -> Iterator[Parameter | Failure]:
        """k of all samplers that apply, until none has more. The failure of one counts when the others have no more."""
        open_, failures = [each.draws(c, action, rng) for each in self.serving(c, action)], list[Failure]()
        while open_:
            for drawing in list(open_):
                count = 0
                for k in islice(drawing, self._turn):
                    if isinstance(k, Failure):
                        failures.append(k)
                        break
                    count += 1
                    yield k
                if count < self._turn:
                    open_.remove(drawing)
        yield from failures[:1]
