"""What there is to do in a run. Knows no Drake, so that programs can name their work and show their help at once."""

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
    """A scene to be solved.

    Attributes:
        name: Name of its record and folder, usually that of its file.
        spec: The scene.
        level: One of easy, medium, hard, extreme and varied; None for a scene of one's own.
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
    """A problem and how it is to be solved.

    Attributes:
        problem: The problem.
        method: Options and seed.
        strategy: Name of the method, empty when there is only one.
        task: The problem's task where it was loaded in this process already; it does not go to another one.
    """

    problem: Problem
    method: Method
    strategy: str = ""
    task: "Task | None" = field(default=None, compare=False, repr=False)

    def __getstate__(self) -> dict[str, Any]:
        return {**vars(self), "task": None}

    @property
    def name(self) -> str:
        """Of its record and folder."""
        return run_name(self.problem.name, self.strategy, self.method.seed)

    def make_failure_record(self, reason: str, seconds: float, error: str) -> Record:
        """The record of a job that did not come to its end."""
        return Record(
            problem=self.problem.name,
            strategy=self.strategy,
            level=self.problem.level,
            seed=self.method.seed,
            stop_reason=reason,
            planning_time_s=round(seconds, 4),
            error=error,
        )
