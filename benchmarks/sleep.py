"""Effect of sleeping bodies on executions: `python benchmarks/sleep.py --problems 0:6`.

Solves problems of each level, then executes each plan from c_0 both as in the search and with the whole scene awake.
Compares the poses of all boxes, and H, at the end of every skill. Takes about 12 s per problem on one core. Writes a
table to benchmarks/sleep.md.
"""

import shlex
import sys
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from multiprocessing import get_context
from pathlib import Path
from statistics import median

import numpy as np
import tyro

from ictamp_drake.core.types import Configuration, Motion
from ictamp_drake.reports import markdown
from ictamp_drake.scenes.levels import LEVELS, problem_files
from ictamp_drake.tamp.method import Method
from ictamp_drake.tamp.replay import Replay, replay
from ictamp_drake.tamp.solve import solve
from ictamp_drake.tamp.task import Task, load
from ictamp_drake.world.outcome import Outcome
from ictamp_drake.world.poses import to_transform
from ictamp_drake.world.simulate import Physics, Watcher

OUT = Path(__file__).with_suffix(".md")


@dataclass(frozen=True)
class Options:
    """Compare executions with and without sleep.

    Attributes:
        problems: Number of a problem of each level, or a slice.
        levels: Levels of the problems.
        workers: Number of worker processes.
    """

    problems: str = "0:6"
    levels: tuple[str, ...] = LEVELS
    workers: int = 1


@dataclass(frozen=True)
class Comparison:
    """Comparison of a plan's execution with sleep to that with the whole scene awake.

    Attributes:
        level: Level of the problem.
        problem: Name of the problem.
        shifts: Maximum distance between the two positions of a box at the end of each skill [mm].
        turns: Maximum angle between the two orientations of a box at the end of each skill [deg].
        same: Number of skills after which H is the same.
        ratio: Processor time with sleep, relative to that without.
        executed: Number of steps of the search that physics executed.
        woken: Number of these steps that the guard executed again with the whole scene awake.
    """

    level: str
    problem: str
    shifts: tuple[float, ...]
    turns: tuple[float, ...]
    same: int
    ratio: float
    executed: int
    woken: int


class Counted(Physics):
    """A simulator that counts how often the guard woke the whole scene."""

    runs = 0
    executions = 0

    def proceed(self, motion: Sequence, *, watch: Watcher | None = None, record: bool = True) -> Outcome:  # type: ignore[type-arg]
        """Count the call, and proceed as the simulator does."""
        self.runs += 1
        return super().proceed(motion, watch=watch, record=record)

    def _execute(self, motion: Motion, watch: Watcher | None, record: bool, *, sleep: bool) -> Outcome:  # type: ignore[override]
        self.executions += 1
        return super()._execute(motion, watch, record, sleep=sleep)


def compare(level: str, path: Path) -> Comparison | None:
    """Solve a problem and execute its plan both ways; None when it was not solved."""
    method = Method()
    task = load(path, method)
    counted = Counted(task.world, method.physics)
    result = solve(replace(task, physics=counted), method).result
    if not result.solved or result.plan is None:
        return None

    def execute(*, sleep: bool) -> Replay:
        physics = replace(method.physics, sleep=sleep).create(task.world)
        return replay(physics, abstraction=task.abstraction, goal=task.goal, c=task.c, attempts=result.plan or ())

    asleep, awake = execute(sleep=True), execute(sleep=False)
    pairs = [(one.c, other.c) for one, other in zip(asleep.outcomes, awake.outcomes, strict=True)]
    shifts, turns = zip(*(difference(*pair) for pair in pairs), strict=True)
    same = sum(holds(task, *pair) for pair in pairs)
    woken = counted.executions - counted.runs
    ratio = asleep.seconds / awake.seconds
    return Comparison(level, f"{level}-{path.stem}", shifts, turns, same, ratio, counted.runs, woken)


def holds(task: Task, one: Configuration, other: Configuration) -> bool:
    """Whether H is the same."""
    return task.abstraction(one) == task.abstraction(other)


def difference(one: Configuration, other: Configuration) -> tuple[float, float]:
    """Maximum distance [mm] and maximum angle [deg] between the poses of a box in two configurations."""
    X = [to_transform(pose).inverse() @ to_transform(other.poses[name]) for name, pose in one.poses.items()]
    shift = max(np.linalg.norm(each.translation()) for each in X)
    return 1000 * float(shift), float(np.degrees(max(each.rotation().ToAngleAxis().angle() for each in X)))


def table(found: Sequence[Comparison]) -> list[str]:
    """Format one row per level and one for all."""
    rows = []
    for level in [*dict.fromkeys(each.level for each in found), "all"]:
        group = [each for each in found if level in (each.level, "all")]
        shifts, turns = ([v for each in group for v in getattr(each, name)] for name in ("shifts", "turns"))
        rows.append(
            (
                level,
                len(group),
                len(shifts),
                f"{max(shifts):.3f}",
                f"{median(shifts):.4f}",
                f"{max(turns):.3f}",
                f"{median(turns):.4f}",
                f"{sum(each.same for each in group)} of {len(shifts)}",
                f"{median(each.ratio for each in group):.2f}",
                f"{sum(each.woken for each in group)} of {sum(each.executed for each in group)}",
            )
        )
    head = ["level", "plans", "skills", "mm, worst", "median", "deg, worst", "median", "same H", "time", "woken"]
    return markdown.table(head, rows, left=1)


def main() -> None:
    """Solve the problems, execute and compare the plans, and write the table."""
    options = tyro.cli(Options, description=__doc__)
    problems = [(level, path) for level in options.levels for path in problem_files(level, options.problems)]
    with ProcessPoolExecutor(options.workers, mp_context=get_context("spawn")) as pool:
        futures = [pool.submit(compare, *problem) for problem in problems]
        found = []
        for (level, path), future in zip(problems, futures, strict=True):
            result = future.result()
            print(result or f"{level}-{path.stem}: not solved", file=sys.stderr, flush=True)
            found += [result] if result else []
    lines = [
        "# Plans executed with boxes asleep and with the whole scene awake",
        "",
        f"By `{shlex.join(['python', *sys.argv])}`. Compared is every box at the end of every skill.",
        "time: processor time with sleep as a part of that without, median over plans. woken: how many of the steps",
        "that physics executed in the search were executed again with the whole scene awake, because something awake",
        "touched something asleep.",
        "",
        *table(found),
        "",
        f"Not solved: {len(problems) - len(found)} of {len(problems)}.",
    ]
    OUT.write_text("\n".join(lines) + "\n")
    print(OUT.read_text())


if __name__ == "__main__":
    main()
