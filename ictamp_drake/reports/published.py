"""The paper's own figures (Task and Motion Planning Using Infinite Completion Tree and Agnostic Skills, Table 1)."""

from typing import NamedTuple

TIME_LIMIT = 1200.0
"""Time limit of a problem [s] (paper, Investigating Search Behavior)."""


class Published(NamedTuple):
    """A row of the paper's Table 1. Its means are over the solved problems, and None when there are none.

    Attributes:
        level: Level of difficulty.
        strategy: Name of the algorithm.
        problems: Number of problems.
        solved: Number of solved problems.
        seconds: Mean time [s].
        plans: Mean number of high-level plans.
        steps: Mean number of low-level steps.
    """

    level: str
    strategy: str
    problems: int
    solved: int
    seconds: float | None = None
    plans: float | None = None
    steps: float | None = None


TABLE_1 = (
    Published("easy", "p_score", 55, 45, 167.7, 1.2, 131.7),
    Published("easy", "q_value", 55, 42, 213.4, 1.5, 110.3),
    Published("easy", "ELS (round robin)", 55, 42, 453.2, 7.9, 397.0),
    Published("easy", "ELS (p_w = 3, p_c = 1)", 55, 20, 314.3, 1.1, 67.8),
    Published("easy", "ELS (p_w = 1, p_c = 1)", 55, 23, 351.9, 2.2, 84.52),
    Published("medium", "p_score", 37, 16, 293.2, 1.2, 286.8),
    Published("medium", "q_value", 37, 12, 389.3, 1.4, 304.8),
    Published("medium", "ELS (round robin)", 37, 15, 519.6, 2.0, 444.1),
    Published("medium", "ELS (p_w = 3, p_c = 1)", 37, 1, 196.84, 1.0, 60.0),
    Published("medium", "ELS (p_w = 1, p_c = 1)", 37, 2, 259.86, 1.8, 106.0),
    Published("hard", "p_score", 17, 1, 593.0, 1.0, 451.0),
    Published("hard", "q_value", 17, 0),
    Published("hard", "ELS (round robin)", 17, 0),
    Published("hard", "ELS (p_w = 3, p_c = 1)", 17, 0),
    Published("hard", "ELS (p_w = 1, p_c = 1)", 17, 0),
)
