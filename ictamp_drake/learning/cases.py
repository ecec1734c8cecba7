"""Counted success: repeated attempts at the same action from the same c, the ground truth for estimates."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.dataset as pads
from numpy.typing import NDArray

from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.reading import in_file
from ictamp_drake.core.spelling import spellings
from ictamp_drake.core.types import Action, Configuration, FloatArray
from ictamp_drake.learning.dataset import action, check_objects, configuration, read_rows

_CASE = ("scene", "state", "action", "box", "place")
_START = ("spec", "q", "poses", "held", "gripper")


@dataclass(frozen=True, eq=False)
class Case:
    """An action that was executed repeatedly from one c.

    Attributes:
        scene: Number of the training scene.
        state: Number of c among those of its scene.
        spec: Scene as JSON.
        c: Configuration from which every execution started.
        action: Action that was tried.
        outcomes: Whether the promised state was reached, in order of the draws, shape (executions,).
    """

    scene: int
    state: int
    spec: str
    c: Configuration
    action: Action
    outcomes: NDArray[np.bool_]

    def __len__(self) -> int:
        return len(self.outcomes)


@dataclass(frozen=True, eq=False)
class Counts:
    """Executions of n cases.

    Attributes:
        scene: Number of the training scene, shape (n,).
        attempts: Number of executions and of refusals by motion planning, shape (n,).
        successes: Number of successful attempts, shape (n,).
    """

    scene: NDArray[np.int_]
    attempts: FloatArray
    successes: FloatArray

    def __len__(self) -> int:
        return len(self.scene)

    @property
    def share(self) -> FloatArray:
        """Ground truth GT: the share of successes, shape (n,)."""
        return self.successes / self.attempts


def read_cases(folder: Path, skill: str, least: int, sampler: str | None = None) -> list[Case]:
    """Read the cases of a skill, in order of scene and state; refusals by motion planning count as failures.

    Args:
        folder: Folder of recorded attempts.
        skill: Skill, pick or place.
        least: Number of attempts that count in each case. Cases with fewer are left out, and further attempts are
            ignored, so that no case counts for more than another.
        sampler: Sampler that k must come from; any sampler by default.

    Raises:
        IctampError: There are no attempts, too few of them, or all have the same outcome or are in one scene.
    """
    groups = _group_rows(folder, skill, sampler)
    with in_file(folder):
        cases = [_case(rows[:least]) for _, rows in sorted(groups.items()) if len(rows) >= least]
    if not cases:
        most = max(map(len, groups.values()), default=0)
        problem = f"expected {least} attempts to {skill} from the same c, got at most {{value}}"
        advice = f"collect with --walk.draws {least}, lower --least or leave {skill} out of --skills"
        raise IctampError(Code.TOO_FEW_DATA, problem, file=folder, value=most, advice=advice)
    _check(folder, skill, cases)
    return cases


def _group_rows(folder: Path, skill: str, sampler: str | None) -> dict[tuple[Any, ...], list[dict[str, Any]]]:
    """Group the rows by case, in order of the draws."""
    wanted = pads.field("action").cast(pa.string()) == skill
    if sampler is not None:
        wanted &= pads.field("sampler").cast(pa.string()).isin(spellings(sampler))
    table = read_rows(folder, [*_CASE, *_START, "draw", "failure"], wanted)
    groups: dict[tuple[Any, ...], list[dict[str, Any]]] = {}
    for row in table.to_pylist():
        groups.setdefault(tuple(row[name] for name in _CASE), []).append(row)
    return groups


def _case(rows: Sequence[dict[str, Any]]) -> Case:
    check_objects(rows[0])
    first, outcomes = rows[0], np.array([row["failure"] is None for row in rows])
    return Case(first["scene"], first["state"], first["spec"], configuration(first), action(first), outcomes)


def _check(folder: Path, skill: str, cases: Sequence[Case]) -> None:
    """Raise IctampError unless figures and their intervals can be computed."""
    attempts, successes = sum(map(len, cases)), sum(int(case.outcomes.sum()) for case in cases)
    if successes in (0, attempts):
        problem = f"expected successes and failures, got {{value}} successes in {attempts} attempts to {skill}"
        raise IctampError(Code.TOO_FEW_DATA, problem, file=folder, value=successes, advice="collect in more scenes")
    if len({case.scene for case in cases}) < 2:
        problem = f"expected cases of {skill} in two scenes at least, got one"
        raise IctampError(Code.TOO_FEW_DATA, problem, file=folder, value=1, advice="collect in more scenes")


def count_outcomes(cases: Sequence[Case]) -> Counts:
    """Count all executions of the cases."""
    return _counts(cases, [case.outcomes for case in cases])


def halves(cases: Sequence[Case]) -> tuple[Counts, Counts]:
    """Count each half of the executions of each case, and the opposite half of each, both as 2 n cases.

    Neighboring draws are in different halves.
    """
    even, odd = ([case.outcomes[start::2] for case in cases] for start in (0, 1))
    twice = [*cases, *cases]
    return _counts(twice, [*even, *odd]), _counts(twice, [*odd, *even])


def _counts(cases: Sequence[Case], outcomes: Sequence[NDArray[np.bool_]]) -> Counts:
    return Counts(
        scene=np.array([case.scene for case in cases]),
        attempts=np.array([len(each) for each in outcomes], dtype=np.float64),
        successes=np.array([each.sum() for each in outcomes], dtype=np.float64),
    )
