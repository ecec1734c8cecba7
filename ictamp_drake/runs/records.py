"""`results.jsonl`: one JSON object per problem, safe against interruption at any moment."""

import dataclasses
import errno
import json
import os
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from ictamp_drake.core.decoding import decode, mapping
from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.failures import Cause, Failure
from ictamp_drake.core.files import refuse_unwritable
from ictamp_drake.core.reading import parse_json, read_bytes
from ictamp_drake.core.spelling import respell
from ictamp_drake.planning.result import StopReason
from ictamp_drake.robots.spec import DEFAULT
from ictamp_drake.tamp.explanation import Blocked, Explanation
from ictamp_drake.tamp.torque_use import TorqueUse

if TYPE_CHECKING:
    from ictamp_drake.tamp.solve import Solution

K = TypeVar("K")

MAX_BYTES = 2**30
"""Largest file of records that is read [bytes], about half a million problems."""
OWN = "own scenes"
"""Displayed level of problems without a level."""


@dataclass(frozen=True, kw_only=True)
class Record:
    """Result of one finished problem. Failures are keyed by the names of `core.failures.Failure`.

    Attributes:
        problem: Name of the problem.
        strategy: Name of the method. Empty in a run with one method.
        level: Level of the problem: easy, medium, hard, extreme or varied. None for your own scene.
        robot: Robot of the scene: the name of one that ships, or the path of a robot file.
        stand_ins: Names of the sampler and the estimator that served in place of those chosen, which were trained with
            another robot.
        interference: Kinds of interference of the boxes outside the goal.
        seed: Random seed of the run.
        solved: Whether a plan was executed and verified.
        verified: Whether the last executed plan holds. Its skills ran in physics one after the other, each from the
            complete state in which the one before ended. H of the final configuration contains the goal, and so does H
            after another execution if --verify asks for one. None when no plan was executed or the execution was
            interrupted.
        stop_reason: Reason why the search ended, by its name in `planning.result.StopReason`. "CRASHED" when the
            process died, "HUNG" when it was ended because it took too long.
        planning_time_s: Time until a plan was found or the search ended [s]. It includes loading the scene, building it
            in Drake, search and verification, but not importing modules and writing files.
        cpu_time_s: Processor time of the process over the same span [s]. None in records of earlier versions.
        kinematic_time_s: Part of the processor time spent on everything but physics [s].
        geometric_time_s: Processor time until the first complete plan that had not run in physics yet [s], with
            --physics whole-plan. Otherwise None.
        high_level_plans: Number of plans opened.
        low_level_steps: Number of skill runs.
        steps_by_depth: Number of low-level steps from nodes of depth 0, 1, ...
        plan_length: Number of skills in the plan. None when unsolved.
        plan_duration_s: Duration of the arm's motions in the plan [s]. None when unsolved.
        failures: Number of failed low-level steps by cause.
        rejections: Number of rejected parameters k by cause, without the last k of each step.
        seconds_by_stage: Computing time by stage [s]. "setup" is loading and building the scene.
        found: Plans in the order in which they were found, with --improve: for each its number of skills, the duration
            of its motions [s], and the planning time until then [s]. `plan_length` and `plan_duration_s` are those of
            the last one, the best. All other times and counts end with the first one.
        stuck: Whether boxes were in the way of blocked actions, and the planner never asks for plans that move them.
        torque: Largest share of a joint's torque limit that the plan uses. None when unsolved.
        replay_time_s: Computing time of one execution of the found plan [s]. None when unsolved. Earlier versions
            executed the plan a second time for this, with the whole scene awake and recorded.
        blocked: Number of rejected parameters k by cause, for each action that was tried and never succeeded, or that
            a sweep found to be impossible.
        obstacles: Number of parameters k with which the arm or the held box would have touched an obstacle, by
            obstacle, for each of these actions.
        beyond: Number of parameters k for which the arm has no posture, by the joint whose limits are in the way, for
            each of these actions; an empty name is out of reach. Only some k are looked at if there are many.
        error: Traceback when the problem broke down. Otherwise None.
        load: Load averages of the machine over 1, 5 and 15 minutes at the end.
    """

    problem: str
    strategy: str = ""
    level: str | None
    seed: int
    robot: str = DEFAULT
    stand_ins: dict[str, str] = field(default_factory=dict)
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
    found: tuple[tuple[float, ...], ...] = ()
    stuck: bool = False
    torque: TorqueUse | None = None
    replay_time_s: float | None = None
    blocked: dict[str, dict[str, int]] = field(default_factory=dict)
    obstacles: dict[str, dict[str, int]] = field(default_factory=dict)
    beyond: dict[str, dict[str, int]] = field(default_factory=dict)
    error: str | None = None
    load: tuple[float, ...] = field(default_factory=os.getloadavg)

    @property
    def name(self) -> str:
        """Name of the record, see `run_name`."""
        return run_name(self.problem, self.strategy, self.seed)

    @property
    def explanation(self) -> Explanation:
        """Explanation of why the search ended."""
        swept = self.stop_reason == StopReason.IMPOSSIBLE.name
        blocked = (
            Blocked(a, _causes(counts), self.obstacles.get(a, {}), swept, self.beyond.get(a, {}))
            for a, counts in self.blocked.items()
        )
        return Explanation(
            stop_reason=self.stop_reason,
            blocked=tuple(blocked),
            failures=_causes(self.failures),
            steps=self.low_level_steps,
            plans=self.high_level_plans,
            verified=self.verified,
            planning_time_s=self.planning_time_s,
            generating_time_s=self.seconds_by_stage.get("plan_generator", 0.0),
            stuck=self.stuck,
        )

    @property
    def is_final(self) -> bool:
        """Whether the problem is done. False after an interruption or breakdown, so that a continued run retries it."""
        return self.error is None and self.stop_reason != StopReason.STOPPED.name


def run_name(problem: str, strategy: str, seed: int) -> str:
    """Name of a record and its folder: the name of the problem or, with several methods, e.g. els/0/easy-003."""
    return f"{strategy}/{seed}/{problem}" if strategy else problem


def record_of(problem: str, strategy: str, level: str | None, seed: int, solution: "Solution") -> Record:
    """The record of a search that came to its end."""
    result, explanation = solution.result, solution.explain()
    plan = result.plan if result.solved else None
    before = solution.planning_time_s - result.planning_time_s
    found = zip(solution.plans, result.found, strict=True) if solution.method.improve else ()
    return Record(
        problem=problem,
        strategy=strategy,
        level=level,
        seed=seed,
        robot=solution.task.spec.robot,
        stand_ins=dict(solution.stand_ins),
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
        plan_duration_s=None if plan is None else _round_seconds(sum(attempt.duration for attempt in plan)),
        failures=_to_names(result.failures),
        rejections=_to_names(sum((report.rejections for report in result.reports.values()), Counter[Failure]())),
        seconds_by_stage={
            "setup": _round_seconds(solution.setup_time_s),
            **{stage: _round_seconds(seconds) for stage, seconds in result.seconds_by_stage.items()},
        },
        found=tuple((len(p), *map(_round_seconds, (p.duration, before + each.seconds))) for p, each in found),
        stuck=explanation.stuck,
        torque=solution.plan.torque if solution.plan is not None else None,
        replay_time_s=None if solution.execution_time_s is None else _round_seconds(solution.execution_time_s),
        blocked={str(report.action): _to_names(report.refusals) for report in result.blocked},
        obstacles={str(report.action): dict(report.obstacles) for report in result.blocked if report.obstacles},
        beyond={blocked.action: dict(blocked.beyond) for blocked in explanation.blocked if blocked.beyond},
    )


def append(record: Record, path: Path) -> None:
    """Append a line with a single write, and wait until it is on the disk.

    Raises:
        IctampError: The write failed, e.g. because the disk is full. The file is as before.
    """
    line = json.dumps(dataclasses.asdict(record)) + "\n"
    with refuse_unwritable(path), path.open("ab", buffering=0) as file:
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
    """Remove an incomplete last line, as left by a crash during a write. A complete record gets its line end."""
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
    """Read the last record of each name, in the order in which they were written.

    Raises:
        IctampError: A line is not a record.
    """
    records: dict[str, Record] = {}
    lines = read_bytes(path, MAX_BYTES).splitlines() if path.exists() else []
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
    record = decode(Record, {"load": [], **mapping(parse_json(line))})
    return dataclasses.replace(record, strategy=respell(record.strategy))


def _to_names(counts: Counter[Failure]) -> dict[str, int]:
    return {failure.name: count for failure, count in counts.most_common()}


def _causes(counts: Mapping[str, int]) -> dict[Cause, int]:
    """Return the counts by failure; names that this version does not know stay names."""
    return {Failure.__members__.get(name, name): count for name, count in counts.items()}


def _round_seconds(seconds: float) -> float:
    return round(seconds, 4)
