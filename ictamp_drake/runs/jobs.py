"""Problems and jobs of a run. This module does not import Drake, so that programs show their help without delay."""

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.runs.records import Record, run_name
from ictamp_drake.scenes.spec import SceneSpec
from ictamp_drake.tamp.method import Method

if TYPE_CHECKING:
    from ictamp_drake.tamp.task import Task


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
        if self.name.startswith("."):
            problem = "expected a name that does not begin with a dot, got {value}"
            raise IctampError(Code.BAD_NAME, problem, field="name", value=self.name)


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
    def name(self) -> str:
        """Name of the job's record and folder."""
        return run_name(self.problem.name, self.strategy, self.method.seed)

    def make_failure_record(self, reason: str, seconds: float, error: str) -> Record:
        """Return the record of a job that did not finish."""
        return Record(
            problem=self.problem.name,
            strategy=self.strategy,
            level=self.problem.level,
            seed=self.method.seed,
            stop_reason=reason,
            planning_time_s=round(seconds, 4),
            error=error,
        )
