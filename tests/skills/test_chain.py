"""Samplers that take turns."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice
from typing import cast

import numpy as np

from ictamp_drake.core.failures import Failure
from ictamp_drake.core.types import Action, Configuration, Parameter
from ictamp_drake.skills.chain import ChainSampler

ACTION = Action("pick", ("red_box", "table"))
NOWHERE = cast(Configuration, None)


@dataclass(frozen=True)
class Numbers:
    """Draws a number, as often as it is told, and then a failure if it has one."""

    number: float
    count: int = 1000
    failure: Failure | None = None

    def draws(self, *_: object) -> Iterator[Parameter | Failure]:
        yield from [np.array([self.number])] * self.count
        if self.failure:
            yield self.failure


class Never(Numbers):
    """Applies to nothing."""

    def applies(self, *_: object) -> bool:
        return False


class Always(Numbers):
    """Applies to all."""

    def applies(self, *_: object) -> bool:
        return True


def draw(*samplers: Numbers, turn: int = 2, count: int = 8) -> list[float | Failure]:
    drawn = ChainSampler(samplers, turn).draws(NOWHERE, ACTION, np.random.default_rng(0))
    return [k if isinstance(k, Failure) else float(k[0]) for k in islice(drawn, count)]


def test_samplers_take_turns() -> None:
    assert draw(Numbers(1), Numbers(2)) == [1, 1, 2, 2, 1, 1, 2, 2]


def test_a_sampler_that_has_no_more_is_left_out() -> None:
    assert draw(Numbers(1, count=3), Numbers(2)) == [1, 1, 2, 2, 1, 2, 2, 2]
    assert draw(Numbers(1, count=3)) == [1, 1, 1]


def test_a_sampler_that_does_not_apply_is_left_out() -> None:
    assert draw(Never(1), Always(2), Numbers(3)) == [2, 2, 3, 3, 2, 2, 3, 3]
    assert draw(Never(1)) == []


def test_a_failure_counts_when_no_other_sampler_has_more() -> None:
    failing = Numbers(1, count=1, failure=Failure.GOAL_IN_COLLISION)
    assert draw(failing, Numbers(2, count=3)) == [1, 2, 2, 2, Failure.GOAL_IN_COLLISION]
    assert draw(failing, Numbers(2), count=4) == [1, 2, 2, 2]
