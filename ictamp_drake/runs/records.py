"""`results.jsonl`: one JSON object a problem, safe against interruption at any moment."""

import dataclasses
import errno
import json
import os
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeVar

from ictamp_drake.core.decoding import decode, mapping
from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.failures import Failure
from ictamp_drake.core.reading import parse_json, read_bytes
from ictamp_drake.planning.result import StopReason
from ictamp_drake.tamp.explanation import Blocked, Explanation
from ictamp_drake.tamp.replay import duration
from ictamp_drake.tamp.solve import Solution

K = TypeVar("K")

OWN = "own scenes"
"""Level of problems without one, as it is shown."""


@dataclass(frozen=True, kw_only=True)
class Record:
    """What is known of one problem when it is over. Failures are keyed by the names of `core.failures.Failure`.

    Attributes:
        problem: its name.
        strategy: name of the method, empty in a run of one method.
        level: easy, medium, hard, extreme or varied; None for a scene of one's own.
        interference: kinds of interference of the boxes outside the goal.
        seed: the run's seed.
        solved: a plan was carried out and holds.
        verified: whether the last plan that was carried out holds: its skills were executed in physics one after the
            other, each from the complete state in which the one before ended, H of the last configuration holds the
            goal, and so does it after another execution where --verify asks for one. None when no plan was carried out,
            or when this was interrupted.
        stop_reason: why the search ended, by the name in `planning.result.StopReason`; "CRASHED" or "HUNG" when its
            process died or was ended because it took too long.
        planning_time_s: time until a plan was found or the search ended [s]: loading the scene, building it in Drake,
            search and verification. Importing modules and writing files are not in it.
        cpu_time_s: processor time of the process in the same span [s]; None in records of earlier versions.
        kinematic_time_s: the part of it that is not physics [s].
        geometric_time_s: processor time until the first plan was finished of which no step had run in physics yet [s],
            with --physics whole-plan; otherwise None.
        high_level_plans: plans opened.
        low_level_steps: runs of a skill.
        steps_by_depth: how many of these started from a node of depth 0, 1, ...
        plan_length: skills in the plan, None when unsolved.
        plan_duration_s: how long its motions take the arm [s], None when unsolved.
        failures: failed low-level steps by cause.
        rejections: parameters k that were refused, by cause, before the last one of their step.
        seconds_by_stage: computing time by stage [s]; "setup" is loading and building the scene.
        replay_time_s: computing time of executing the found plan once [s], None when unsolved. In records of earlier
            versions, which executed it a second time, the whole scene was awake and recorded meanwhile.
        blocked: for each action that was tried and never succeeded, how many parameters k were refused by what.
        obstacles: for each of these, with how many of the k the arm or the held box would have touched what.
        error: traceback when the problem was not brought to an end by itself, else None.
        load: the machine's load averages over 1, 5 and 15 minutes at the end.
    """

    problem: str
    strategy: str = ""
    level: str | None
    seed: int
    interference: tuple[str, ...] = ()
    solved: bool = False
    verified: bool | None = None
    stop_reason: str
    planning_time_s: float
    cpu_time_s: float | None = None
    kinematic_time_s: float | None = None
    geometric_time_s: float | None = None
    high_level_plans: int = 0
    low_level_steps: int = 0
    steps_by_depth: tuple[int, ...] = ()
    plan_length: int | None = None
    plan_duration_s: float | None = None
    failures: dict[str, int] = field(default_factory=dict)
    rejections: dict[str, int] = field(default_factory=dict)
    seconds_by_stage: dict[str, float] = field(default_factory=dict)
    replay_time_s: float | None = None
    blocked: dict[str, dict[str, int]] = field(default_factory=dict)
    obstacles: dict[str, dict[str, int]] = field(default_factory=dict)
    error: str | None = None
    load: tuple[float, ...] = field(default_factory=os.getloadavg)

    @property
    def name(self) -> str:
        """See `run_name`."""
        return run_name(self.problem, self.strategy, self.seed)

    @property
    def explanation(self) -> Explanation:
        """Why the search ended."""
        blocked = (Blocked(a, _causes(counts), self.obstacles.get(a, {})) for a, counts in self.blocked.items())
        return Explanation(
            stop_reason=self.stop_reason,
            blocked=tuple(blocked),
            failures=_causes(self.failures),
            steps=self.low_level_steps,
            plans=self.high_level_plans,
            verified=self.verified,
            planning_time_s=self.planning_time_s,
            generating_time_s=self.seconds_by_stage.get("plan_generator", 0.0),
        )

    @property
    def is_final(self) -> bool:
        """False when the problem was interrupted or broke down, so that a run which is continued tries it again."""
        return self.error is None and self.stop_reason != StopReason.STOPPED.name


def run_name(problem: str, strategy: str, seed: int) -> str:
    """Of a record and its folder: the problem's, or with several methods e.g. els/0/easy-003."""
    return f"{strategy}/{seed}/{problem}" if strategy else problem


def record_of(problem: str, strategy: str, level: str | None, seed: int, solution: Solution) -> Record:
    """The record of a search that came to its end."""
    result = solution.result
    plan = result.plan if result.solved else None
    return Record(
        problem=problem,
        strategy=strategy,
        level=level,
        seed=seed,
        interference=solution.task.spec.interference,
        solved=result.solved,
        verified=result.verified,
        stop_reason=result.stop_reason.name,
        planning_time_s=_round_seconds(solution.planning_time_s),
        cpu_time_s=_round_seconds(solution.cpu_time_s),
        kinematic_time_s=_round_seconds(solution.kinematic_time_s),
        geometric_time_s=None if solution.geometric_time_s is None else _round_seconds(solution.geometric_time_s),
        high_level_plans=result.high_level_plans,
        low_level_steps=result.low_level_steps,
        steps_by_depth=result.steps_by_depth,
        plan_length=None if plan is None else len(plan),
        plan_duration_s=None if plan is None else _round_seconds(duration(plan)),
        failures=_to_names(result.failures),
        rejections=_to_names(sum((report.rejections for report in result.reports.values()), Counter[Failure]())),
        seconds_by_stage={
            "setup": _round_seconds(solution.setup_time_s),
            **{stage: _round_seconds(seconds) for stage, seconds in result.seconds_by_stage.items()},
        },
        replay_time_s=None if solution.execution_time_s is None else _round_seconds(solution.execution_time_s),
        blocked={str(report.action): _to_names(report.refusals) for report in result.blocked},
        obstacles={str(report.action): dict(report.obstacles) for report in result.blocked if report.obstacles},
    )


def append(record: Record, path: Path) -> None:
    """Add a line by a single write, and wait until it is on the disk.

    Raises:
        IctampError: that failed, e.g. since the disk is full; the file is as before.
    """
    line = json.dumps(dataclasses.asdict(record)) + "\n"
    with path.open("ab", buffering=0) as file:
        before = file.tell()
        try:
            if file.write(line.encode()) < len(line):
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
            os.fsync(file.fileno())
        except OSError as error:
            file.truncate(before)
            problem = f"a record cannot be written: {error.strerror}"
            raise IctampError(Code.NOT_WRITABLE, problem, file=path) from error


def drop_torn_line(path: Path) -> None:
    """Cut off a last line without an end, left when a machine died while it wrote; a whole record gets an end."""
    before, newline, last = path.read_bytes().rpartition(b"\n") if path.exists() else (b"", b"", b"")
    if not last:
        return
    try:
        _parse(last)
        with path.open("ab") as file:
            file.write(b"\n")
    except IctampError:
        os.truncate(path, len(before) + len(newline))


def read_records(path: Path) -> dict[str, Record]:
    """The last record of each name, in the order in which they were written.

    Raises:
        IctampError: A line is not a record.
    """
    records: dict[str, Record] = {}
    lines = read_bytes(path).splitlines() if path.exists() else []
    for number, line in enumerate(lines, 1):
        try:
            record = _parse(line)
        except IctampError as error:
            error.add_file(path, number)
            raise
        records.pop(record.name, None)
        records[record.name] = record
    return records


def _parse(line: bytes) -> Record:
    return decode(Record, {"load": [], **mapping(parse_json(line))})


def _to_names(counts: Counter[Failure]) -> dict[str, int]:
    return {failure.name: count for failure, count in counts.most_common()}


def _causes(counts: Mapping[str, int]) -> dict[Failure, int]:
    return {Failure[name]: count for name, count in counts.items()}


def _round_seconds(seconds: float) -> float:
    return round(seconds, 4)
