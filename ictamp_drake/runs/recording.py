"""The steps of a search as they were executed.

Those of the verified plan are cut from its replay; every other one is simulated once more from its node, which gives
the same again. The search itself records nothing, so that its times are those of planning.
"""

from collections.abc import Iterator, Sequence
from contextlib import suppress
from itertools import pairwise

import numpy as np

from ictamp_drake.core.types import Attempt, Configuration
from ictamp_drake.planning.tree import ROOT, Step, Tree
from ictamp_drake.runs.replay import Replay, starts
from ictamp_drake.skills.runner import execute
from ictamp_drake.world.simulate import Frame, Physics

MAX_STEPS = 60
"""How many steps of a search are recorded: each takes about 25 kB of a page, and 0.4 s when it is simulated."""


def record_steps(
    physics: Physics, tree: Tree[Configuration], replay: Replay | None, limit: int = MAX_STEPS
) -> dict[int, list[Frame]]:
    """Recordings of the executed steps by their place in the tree's log, each from its node's c to where it ended.

    Args:
        physics: a simulator of the scene with the search's own options.
        tree: what the search left.
        replay: of its verified plan, None when there is none.
        limit: how many to record; first those of the verified plan, then the other successes, then the failures.
    """
    executed = [(n, step) for n, step in enumerate(tree.log) if isinstance(step, Step) and step.attempt.motion]
    plan = tree.path(ROOT if tree.solution is None else tree.solution)
    executed.sort(key=lambda item: (item[1].attempt not in plan, item[1].child is None))
    parts = {} if replay is None else dict(zip(plan, _parts(replay, plan), strict=True))
    return {number: _record(physics, tree, step, parts.get(step.attempt)) for number, step in executed[:limit]}


def _parts(replay: Replay, plan: Sequence[Attempt[Configuration]]) -> Iterator[list[Frame]]:
    """What the replay shows of each attempt after the moment in which it begins."""
    begins = starts(plan)
    bounds = [*np.searchsorted([frame.time for frame in replay.frames], begins, side="right"), len(replay.frames)]
    for begin, (first, end) in zip(begins, pairwise(bounds), strict=True):
        yield [Frame(frame.time - begin, frame.c) for frame in replay.frames[first:end]]


def _record(
    physics: Physics, tree: Tree[Configuration], step: Step[Configuration], part: list[Frame] | None
) -> list[Frame]:
    """From the node's configuration to the successor's."""
    c, attempt = tree.nodes[step.node].c, step.attempt
    frames = [Frame(0.0, c), *part] if part is not None else _simulate(physics, c, attempt)
    if attempt.successor is not None:
        frames.append(Frame(frames[-1].time + physics.config.record_period, attempt.successor))
    return frames


def _simulate(physics: Physics, c: Configuration, attempt: Attempt[Configuration]) -> list[Frame]:
    frames: list[Frame] = []
    with suppress(RuntimeError):  # the step ended like this, too
        execute(physics, c, attempt.action, attempt.motion, frames.append)
    return frames
