"""Problems and jobs of a run, and their results.

This module does not import Drake, so that programs show their help without delay.
"""

import os
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, NamedTuple

from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.runs.folder import CONFIG, INDEX, RESULTS
from ictamp_drake.runs.records import Record, run_name
from ictamp_drake.scenes.spec import SceneSpec
from ictamp_drake.tamp.method import Method

if TYPE_CHECKING:
    from ictamp_drake.tamp.task import Task

CRASHED, HUNG = "CRASHED", "HUNG"
"""Stop reasons of problems whose process could not report one."""


LONGEST_NAME = 200
"""Length of the longest name of a problem or strategy [bytes]; file systems allow 255, and the time may follow."""


def check_folder_name(field: str, name: str) -> None:
    """Raise IctampError unless a folder in that of a run can have the name of a problem or strategy."""
    problem = ""
    if name.startswith(".") or not name:
        problem = "expected a name that does not begin with a dot, got {value}"
    elif "/" in name or "\0" in name:
        problem = "expected a name without / and NUL, got {value}"
    elif name in (CONFIG, RESULTS, INDEX):
        problem = "{value} is the name of a file of the run"
    elif len(os.fsencode(name)) > LONGEST_NAME:
        problem = f"expected a name of at most {LONGEST_NAME} bytes, got {{value}}"
    if problem:
        raise IctampError(Code.BAD_NAME, problem, field=field, value=name, advice="rename the file or choose another")


@dataclass(frozen=True)
class Problem:
    """A scene to solve.

    Attributes:
        name: Name of the problem's record and folder, usually that of its file.
        spec: Scene to plan in.
        level: Level easy, medium, hard, extreme or varied; None for your own scene.
    """

    name: str
    spec: SceneSpec
    level: str | None = None

    def __post_init__(self) -> None:
        check_folder_name("name", self.name)


@dataclass(frozen=True)
class Job:
    """A problem and the method that solves it.

    Attributes:
        problem: Problem to solve.
        method: Options and seed.
        strategy: Name of the method; empty when there is only one.
        task: Task of the problem if this process loaded it already; other processes do not receive it.
    """

    problem: Problem
    method: Method
    strategy: str = ""
    task: "Task | None" = field(default=None, compare=False, repr=False)

    def __getstate__(self) -> dict[str, Any]:
        return {**vars(self), "task": None}

    @property
    def suited(self) -> Method:
        """The method with the parts that serve with the robot of the problem."""
        return self.method.suited_to(self.problem.spec.robot)

    @property
    def name(self) -> str:
        """Name of the job's record and folder."""
        return run_name(self.problem.name, self.strategy, self.method.seed)

    def make_failure_record(self, reason: str, seconds: float, error: str) -> Record:
        """Return the record of a job that did not finish."""
        return Record(
            problem=self.problem.name,
            strategy=self.strategy,
            level=self.problem.level,
            robot=self.problem.spec.robot,
            seed=self.method.seed,
            stop_reason=reason,
            planning_time_s=round(seconds, 4),
            error=error,
        )


class Pages(NamedTuple):
    """Pages of a problem: file contents by name, and the error if some could not be made."""

    files: dict[str, bytes]
    error: str | None


class Finished(NamedTuple):
    """Result of a job.

    Attributes:
        record: Record of the job.
        files: Contents of the files to keep, by name.
        pages: Function that makes the remaining files. None when there are none.
    """

    record: Record
    files: dict[str, bytes]
    pages: Callable[[], Pages] | None = None
