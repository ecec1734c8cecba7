"""What all learned estimators do: one matrix an option, one call of a network a skill."""

from collections.abc import Callable, Sequence

import numpy as np

from ictamp_drake.core.types import Configuration, FloatArray, Skeleton
from ictamp_drake.world.observation import Observation, Observer

Option = tuple[Configuration, Skeleton]


def by_skill(
    observer: Observer, options: Sequence[Option], score: Callable[[str, Observation], FloatArray], numbers: int = 1
) -> FloatArray:
    """Scores of the first actions of all options, skill by skill.

    Args:
        observer: makes the matrices.
        options: n of them.
        score: of m observations for one skill, shape (numbers, m).
        numbers: in a score.

    Returns:
        Shape (numbers, n).
    """
    steps = [(c, plan.actions[0]) for c, plan in options]
    observation = observer.observe_all(steps)
    names = np.array([action.name for _, action in steps], dtype=np.str_)
    scores = np.empty((numbers, len(options)))
    for skill in sorted(set(names.tolist())):
        rows = np.flatnonzero(names == skill)
        scores[:, rows] = score(skill, Observation(observation.matrix[rows], observation.mask[rows]))
    return scores
