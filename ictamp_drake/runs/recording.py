"""The steps of a search as they were executed: each is simulated once more from its node, which gives the same again.

The search itself records nothing, so that its times are those of planning.
"""

from contextlib import suppress

from ictamp_drake.core.types import Configuration
from ictamp_drake.planning.tree import ROOT, Step, Tree
from ictamp_drake.skills.runner import execute
from ictamp_drake.world.simulate import Frame, Physics

MAX_STEPS = 60
"""How many steps of a search are recorded: each takes about 0.4 s and 25 kB of a page."""


def record_steps(physics: Physics, tree: Tree[Configuration], limit: int = MAX_STEPS) -> dict[int, list[Frame]]:
    """Recordings of the executed steps by their place in the tree's log.

    Args:
        physics: a simulator of the scene with the search's own options.
        tree: what the search left.
        limit: how many to record; first those of the verified plan, then the other successes, then the failures.
    """
    executed = [(n, step) for n, step in enumerate(tree.log) if isinstance(step, Step) and step.attempt.motion]
    solution = tree.path(ROOT if tree.solution is None else tree.solution)
    executed.sort(key=lambda item: (item[1].attempt not in solution, item[1].child is None))
    return {number: _record(physics, tree, step) for number, step in executed[:limit]}


def _record(physics: Physics, tree: Tree[Configuration], step: Step[Configuration]) -> list[Frame]:
    """From the node's configuration to the successor's."""
    frames: list[Frame] = []
    attempt = step.attempt
    with suppress(RuntimeError):  # the step ended like this, too
        execute(physics, tree.nodes[step.node].c, attempt.action, attempt.motion, frames.append)
    if attempt.successor is not None:
        frames.append(Frame(frames[-1].time + physics.config.record_period, attempt.successor))
    return frames
