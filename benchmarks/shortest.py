"""Needless skills: `python benchmarks/shortest.py`, half an hour. It prints a row for each small scene, then the sums.

The default method, or each of the chosen planners in turn, solves every scene of the set once. A plan with as many
skills as the shortest high-level plan has no needless ones. For the other scenes, every strategy tries to find a
shorter plan, with five seeds; the least number of skills that any of them needed is the least one known.
"""

import json
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import Any, Literal

import tyro

import ictamp_drake as ict
from benchmarks.small_scenes import SMALL
from ictamp_drake.symbolic.context import GeneratorContext
from ictamp_drake.symbolic.skeletons import BestFirst
from ictamp_drake.tamp.method import SCENE_METHOD, Method, Planners
from ictamp_drake.tamp.task import Task

SEEDS = range(5)
Row = dict[str, Any]


@dataclass(frozen=True)
class Options:
    """Count needless skills.

    Attributes:
        group: Set of scenes.
        planners: Planners to compare; by default the one of the default method.
        limit: Limit of the processor time of a run [s].
        least: Look for the least number of skills known where a plan has more than the shortest high-level plan.
        out: File to which the rows are added as JSON lines. Scenes with a row there are not solved again.
    """

    group: Literal["development", "evaluation"] = "evaluation"
    planners: tuple[str, ...] = (str(SCENE_METHOD.planner),)
    limit: float = 120.0
    least: bool = True
    out: Path = Path("runs/shortest.jsonl")


def method(planner: str, limit: float, seed: int = 0) -> Method:
    """Return the default method with another planner, limited by its processor time alone."""
    return SCENE_METHOD.with_options(planner=planner, seed=seed, time_limit=20 * limit, cpu_limit=limit)


def solve(scene: Path, planner: str, limit: float, seed: int = 0) -> tuple[Task, int | None, float]:
    """Return the task, the number of skills of the plan, None if none was found, and the processor time [s]."""
    chosen = method(planner, limit, seed)
    task = ict.load(scene, chosen)
    solution = ict.solve(task, chosen)
    return task, None if solution.plan is None else len(solution.plan), solution.cpu_time_s


def bound(task: Task) -> int:
    """Return the number of actions of the shortest high-level plan, which no plan can have fewer of."""
    stream = BestFirst(weight=1.0).create(GeneratorContext(task.domain, task.s, task.goal))
    while (plan := stream.next_plan(10_000)) is None:
        pass
    return len(plan.actions)


def measure(scene: Path, options: Options) -> Row:
    """Solve a scene with each planner, and look for the least number of skills known."""
    row: Row = {"scene": scene.stem}
    for planner in options.planners:
        task, skills, seconds = solve(scene, planner, options.limit)
        row[planner] = {"skills": skills, "cpu_s": round(seconds, 2)}
    row["bound"] = bound(task)
    found = [row[planner]["skills"] for planner in options.planners if row[planner]["skills"] is not None]
    if options.least and row["bound"] not in found:
        found += _others(scene, row["bound"], options.limit)
    row["least"] = min(found, default=None)
    return row


def _others(scene: Path, least: int, limit: float) -> Iterator[int]:
    """Yield the numbers of skills that the strategies find, up to the first one that is the least possible."""
    for seed in SEEDS:
        for planner in Planners().by_name():
            skills = solve(scene, planner, limit, seed)[1]
            if skills is not None:
                yield skills
            if skills == least:
                return


def report(rows: Sequence[Row], planners: Iterable[str]) -> Iterator[str]:
    """Yield a line per scene, then one per planner."""
    yield f"{'scene':6} {'bound':>6} {'least':>6}" + "".join(f" {planner:>24}" for planner in planners)
    for row in rows:
        cells = (f"{row[p]['skills'] or 'no'} skills in {row[p]['cpu_s']:5.1f} s" for p in planners)
        yield f"{row['scene']:6} {row['bound']:6} {row['least'] or 'none':>6}" + "".join(
            f" {cell:>24}" for cell in cells
        )
    for planner in planners:
        solved = [row for row in rows if row[planner]["skills"] is not None]
        least = sum(row[planner]["skills"] == row["least"] for row in solved)
        skills = sum(row[planner]["skills"] for row in solved)
        seconds = [row[planner]["cpu_s"] for row in rows]
        yield (
            f"{planner}: {len(solved)} of {len(rows)} solved, {least} with the least number of skills; {skills} skills "
            f"in all; processor time {median(seconds):.1f} s in the median, {sum(seconds):.0f} s in all"
        )


def main(options: Options) -> None:
    """Measure what is not in the file, and print the report."""
    options.out.parent.mkdir(parents=True, exist_ok=True)
    rows = [json.loads(line) for line in options.out.read_text().splitlines()] if options.out.exists() else []
    done = {row["scene"] for row in rows}
    for scene in sorted((SMALL / options.group).glob("*.yaml")):
        if scene.stem not in done:
            rows.append(measure(scene, options))
            with options.out.open("a") as file:
                file.write(json.dumps(rows[-1]) + "\n")
    print("\n".join(report(rows, options.planners)))


if __name__ == "__main__":
    main(tyro.cli(Options, description=__doc__))
