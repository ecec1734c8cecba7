"""Levels with each robot: `python -m benchmarks.robots`, half an hour on one core.

Every problem is solved by each robot in turn, all with the same geometric sampler and a constant P. The ratio compares
processor times of problems that both robots solve. A plan counts as verified when another execution, in a fresh
simulator in which no box sleeps, ends in the goal, too.
"""

import gc
import json
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import Any

import tyro

from ictamp_drake.core.errors import IctampError
from ictamp_drake.reports.markdown import table
from ictamp_drake.robots.spec import DEFAULT
from ictamp_drake.scenes.levels import load_problem, problem_files
from ictamp_drake.tamp.method import Method
from ictamp_drake.tamp.solve import solve
from ictamp_drake.tamp.task import prepare

Row = dict[str, Any]


@dataclass(frozen=True)
class Options:
    """Compare robots.

    Attributes:
        robots: Names or files of robots, the one to compare with first.
        levels: Levels whose problems are solved.
        limit: Time limit of a problem [s].
        out: File to which rows are added as JSON lines. What has a row there is not solved again.
    """

    robots: tuple[str, ...] = (DEFAULT, "iiwa14_wsg50", "ur5e_2f85")
    levels: tuple[str, ...] = ("easy", "medium")
    limit: float = 60.0
    out: Path = Path("runs/robots.jsonl")


def solve_with(robot: str, path: Path, limit: float) -> Row:
    """Solve a problem with a robot."""
    method = Method(sampler="geometric", estimator="constant", time_limit=limit, verify="awake")
    gc.collect()
    start = time.process_time()
    try:
        solution = solve(prepare(load_problem(path, robot), method), method)
    except IctampError as error:
        return {"solved": False, "cpu_s": time.process_time() - start, "stop": str(error)}
    seconds, plan = time.process_time() - start, solution.plan
    found = {"skills": len(plan), "duration_s": plan.duration} if plan else {}
    return {"solved": plan is not None, "cpu_s": seconds, "stop": str(solution.result.stop_reason), **found}


def solve_all(options: Options) -> Iterator[Row]:
    """Yield the rows of the file, then those that are missing."""
    rows = [json.loads(line) for line in options.out.read_text().splitlines()] if options.out.exists() else []
    yield from rows
    done = {(row["robot"], row["problem"]) for row in rows}
    options.out.parent.mkdir(parents=True, exist_ok=True)
    for path in (path for level in options.levels for path in problem_files(level)):
        problem = f"{path.parent.name}-{path.stem}"
        for robot in options.robots:
            if (robot, problem) not in done:
                row = {"robot": robot, "problem": problem, **solve_with(robot, path, options.limit)}
                with options.out.open("a") as file:
                    file.write(json.dumps(row) + "\n")
                yield row


def summarize(rows: list[Row], options: Options) -> str:
    """Return the table of solved problems and processor times, as Markdown."""
    by = {(row["robot"], row["problem"]): row for row in rows}
    lines = []
    for level in options.levels:
        for robot in options.robots:
            mine = {p: row for (r, p), row in by.items() if r == robot and p.startswith(f"{level}-")}
            solved = {p: row for p, row in mine.items() if row["solved"]}
            first = {p: by.get((options.robots[0], p), {"solved": False}) for p in solved}
            ratios = [solved[p]["cpu_s"] / row["cpu_s"] for p, row in first.items() if row["solved"]]
            times = [row["cpu_s"] for row in solved.values()]
            unsolved = ", ".join(sorted(mine.keys() - solved.keys())) or "-"
            numbers = [f"{median(each):.2f}" if each else "-" for each in (times, ratios)]
            lines.append([level, robot, f"{len(solved)} of {len(mine)}", *numbers, unsolved])
    heads = ["level", "robot", "solved and verified", "processor time [s]", "ratio", "not solved"]
    return "\n".join(table(heads, lines, left=2))


if __name__ == "__main__":
    chosen = tyro.cli(Options)
    print(summarize(list(solve_all(chosen)), chosen))
