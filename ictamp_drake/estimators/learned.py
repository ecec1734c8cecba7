"""What all learned estimators do: one matrix an option, one call of a network a skill."""

from collections.abc import Callable, Sequence

import numpy as np

from ictamp_drake.core.types import Action, Configuration, FloatArray
from ictamp_drake.world.observation import Observation, Observer

Option = tuple[Configuration, Action]


def by_skill(
    observer: Observer, options: Sequence[Option], score: Callable[[str, Observation], FloatArray], numbers: int = 1
) -> FloatArray:
    """Scores of all options, skill by skill.

    Args:
        observer: makes the matrices.
        options: n of them.
        score: of m observations for one skill, shape (numbers, m).
        numbers: in a score.

    Returns:
        Shape (numbers, n).
    """
    observation = observer.observe_all(options)
    names = np.array([action.name for _, action in options], dtype=np.str_)
    scores = np.empty((numbers, len(options)))
    for skill in sorted(set(names.tolist())):
        rows = np.flatnonzero(names == skill)
        scores[:, rows] = score(skill, Observation(observation.matrix[rows], observation.mask[rows]))
    return scores
