"""The steps of a search as they were executed, for the page of the search."""

from ictamp_drake.core.types import Configuration
from ictamp_drake.planning.tree import ROOT, Step, Tree
from ictamp_drake.world.outcome import Frame
from ictamp_drake.world.simulate import Physics

MAX_STEPS = 60
"""How many steps of a search are shown in motion: each takes about 25 kB of a page."""


def recorded_steps(physics: Physics, tree: Tree[Configuration], limit: int = MAX_STEPS) -> dict[int, list[Frame]]:
    """Recordings of the executed steps by their place in the tree's log, each from its node's c to where it ended.

    Args:
        physics: a simulator of the scene.
        tree: what the search left.
        limit: how many to show; first those of the plan, then the other successes, then the failures.
    """
    executed = [
        (number, step)
        for number, step in enumerate(tree.log)
        if isinstance(step, Step) and step.attempt.recording is not None
    ]
    plan = tree.path(ROOT if tree.solution is None else tree.solution)
    executed.sort(key=lambda item: (item[1].attempt not in plan, item[1].child is None))
    recordings = ((number, step.attempt.recording) for number, step in executed[:limit])
    return {number: physics.frames(recording) for number, recording in recordings if recording is not None}
