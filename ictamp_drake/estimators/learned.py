"""Common part of all learned estimators: one matrix per situation, one call of a network per skill."""

from collections.abc import Callable, Sequence

import numpy as np

from ictamp_drake.core.types import Action, Configuration, FloatArray, Skeleton
from ictamp_drake.observation.situations import Numbers
from ictamp_drake.observation.state_matrix import Observation

ConfiguredPlan = tuple[Configuration, Skeleton]


def score_by_skill(
    actions: Sequence[Action], seen: Observation, score: Callable[[str, Observation, Numbers], FloatArray]
) -> FloatArray:
    """Numbers of all situations, computed skill by skill.

    Args:
        actions: Actions, n of them and at least one.
        seen: Observations of the n situations.
        score: Function of a skill, the observations of m situations and their indices, with a result of shape (m, ...).

    Returns:
        Shape (n, ...).
    """
    names = np.array([action.name for action in actions], dtype=np.str_)
    groups = [(skill, np.flatnonzero(names == skill)) for skill in sorted(set(names.tolist()))]
    scores = np.concatenate([score(skill, Observation(seen.matrix[at], seen.mask[at]), at) for skill, at in groups])
    return scores[np.argsort(np.concatenate([at for _, at in groups]))]
