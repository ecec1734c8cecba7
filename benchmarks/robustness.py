"""Plans executed where the world differs from the one they were found in: `make robustness`.

Solves development problems and generated scenes of wide boxes with the default options, and executes each plan open
loop: with boxes that start elsewhere, and with changed friction, mass, grip force and stiffness of the arm. Appends a
line per execution to results.jsonl in the folder of the run, where plans are kept too, goes on there when it is started
again, and writes the table to benchmarks/robustness.md after each plan. Takes about half a minute per plan on one core.
"""

import json
import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import tyro

from ictamp_drake.core.seeding import Stream, generator
from ictamp_drake.core.types import State
from ictamp_drake.reports import markdown
from ictamp_drake.reports.results_table import wilson
from ictamp_drake.scenes.layout import Zone, place_stacks
from ictamp_drake.scenes.levels import SUPPORTS, goal_of, problem_files
from ictamp_drake.scenes.spec import BoxSpec, SceneSpec, load_scene
from ictamp_drake.tamp.changes import Changes
from ictamp_drake.tamp.expected import compare_steps, expected_states
from ictamp_drake.tamp.method import Method
from ictamp_drake.tamp.plan import Plan
from ictamp_drake.tamp.solve import solve
from ictamp_drake.tamp.task import load
from ictamp_drake.world.abstraction import SceneAbstraction
from ictamp_drake.world.config import PhysicsConfig
from ictamp_drake.world.world import World

OUT = Path(__file__).with_suffix(".md")

CHANGES = {
    "none": Changes(),
    "start 3 mm, 2°": Changes(noise=(0.003, 2.0)),
    "start 6 mm, 4°": Changes(noise=(0.006, 4.0)),
    "start 10 mm, 6°": Changes(noise=(0.010, 6.0)),
    "friction × 0.7": Changes(friction=0.7),
    "friction × 1.3": Changes(friction=1.3),
    "mass × 0.8": Changes(mass=0.8),
    "mass × 1.2": Changes(mass=1.2),
    "grip force × 0.7": Changes(grip_force=0.7),
    "stiffness × 0.5": Changes(stiffness=0.5),
}
"""Differences from the world in which the plans were found, by their name in the table."""

WIDE = "65 to 75 mm"
"""Name of the set of generated scenes."""
SIDES = (0.065, 0.075)
"""Range of the horizontal sides of wide boxes [m]. The open hand leaves them 2.5 to 7.5 mm on each side."""
HEIGHTS = (0.05, 0.1)
"""Range of the heights of wide boxes [m]."""


@dataclass(frozen=True)
class Options:
    """Execute plans in changed worlds.

    Attributes:
        out: Folder of plans and results.
        easy: Problems of the level easy.
        medium: Problems of the level medium.
        hard: Problems of the level hard.
        varied: Problems of the level varied.
        wide: Number of generated scenes with wide boxes.
    """

    out: Path = Path("runs/robustness")
    easy: str = "0:10"
    medium: str = "0:4"
    hard: str = "0:2"
    varied: str = "0:5"
    wide: int = 21


KINDS = ("a grasp missed", "a box tipped over", "boxes not at rest", "another state")
"""What can be the first thing that goes wrong."""

Rows = list[dict[str, Any]]


def make_wide_scene(number: int) -> SceneSpec:
    """Make the scene of that number: three boxes on the table, two of which become a tower on the rack.

    Its random generator has five keys, and those of levels, training and `scenes.py` have fewer.
    """
    rng = generator(Stream.SCENES, 0, 0, 0, number, 0)
    names = ("wide_box", "other_box", "third_box")
    sizes = [tuple(round(rng.uniform(*ends), 4) for ends in (SIDES, SIDES, HEIGHTS)) for _ in names]
    spots = place_stacks([math.hypot(*size[:2]) / 2 + 0.02 for size in sizes], [Zone.FRONT] * 3, [False] * 3, rng)
    boxes = {
        name: BoxSpec(size, (*spot, size[2] / 2), (0.0, 0.0, round(rng.uniform(-180, 180), 1)))
        for name, size, spot in zip(names, sizes, spots, strict=True)
    }
    goal = goal_of(("rack", *names[:2]))
    return SceneSpec(supports=SUPPORTS, boxes=boxes, goal=goal, seed=number, description="Boxes of 65 to 75 mm.")


def find_scenes(options: Options) -> Iterator[tuple[str, str, SceneSpec]]:
    """Yield set, name and scene of each problem, the sets in turn."""
    levels = {level: problem_files(level, getattr(options, level)) for level in ("easy", "medium", "hard", "varied")}
    sets = [[(level, f"{level}-{path.stem}", load_scene(path)) for path in paths] for level, paths in levels.items()]
    development = [
        scene for number in range(max(map(len, sets))) for each in sets for scene in each[number : number + 1]
    ]
    wide = [(WIDE, f"wide-{number:03d}", make_wide_scene(number)) for number in range(options.wide)]
    for number in range(max(len(development), len(wide))):
        yield from (*development[number : number + 1], *wide[number : number + 1])


def find_plan(name: str, spec: SceneSpec, folder: Path) -> Plan | None:
    """Return the plan of a scene, solved for now or before; None when none is found."""
    path = folder / f"{name}.yaml"
    if not path.exists():
        method = Method()
        plan = solve(load(spec, method), method).plan
        if plan is None:
            return None
        plan.save(path)
    return Plan.load(path)


def execute(plan: Plan, changes: Changes, world: World, states: Sequence[State]) -> dict[str, Any]:
    """Execute a plan in the changed world: whether the goal holds, and the first step that misses its state.

    No change alters the shapes of the scene or the expected states, so `world` and `states` are those of the plan.
    """
    replay = changes.apply(plan).replay(changes.physics(PhysicsConfig()))
    steps = compare_steps(replay, SceneAbstraction(world), plan.actions, states)
    end = next((number for number, step in enumerate(steps) if not step.as_expected), None)
    return {
        "reached": replay.holds,
        "missed": None if end is None else str(steps[end].action),
        "how": None if end is None else str(steps[end]),
        "grasps": sum(step.action.name == "pick" for step in steps[: None if end is None else end + 1]),
    }


def execute_all(plan: Plan | None, todo: Mapping[str, Changes]) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield the name and result of each change, or a single result without a name when there is no plan."""
    if plan is None:
        yield "", {"reached": None}
        return
    world = World(plan.spec)
    states = expected_states(world, plan.c, plan.actions)
    for change, changes in todo.items():
        yield change, execute(plan, changes, world, states)


def run(options: Options) -> Rows:
    """Solve and execute what is not in the results yet, and write as it goes."""
    plans, results = options.out / "plans", options.out / "results.jsonl"
    plans.mkdir(parents=True, exist_ok=True)
    rows: Rows = [json.loads(line) for line in results.read_text().splitlines()] if results.exists() else []
    done = {(row["problem"], row["change"]) for row in rows}
    for group, name, spec in find_scenes(options):
        if {(name, change) for change in CHANGES} <= done or (name, "") in done:
            continue
        todo = {change: changes for change, changes in CHANGES.items() if (name, change) not in done}
        for change, found in execute_all(find_plan(name, spec, plans), todo):
            rows.append({"set": group, "problem": name, "change": change, **found})
            with results.open("a") as file:
                file.write(json.dumps(rows[-1], ensure_ascii=False) + "\n")
        write_table(rows)
    return rows


def share(rows: Rows) -> str:
    """Format how many executions reach the goal, with Wilson's interval of 95 %."""
    if not rows:
        return "-"
    held = sum(row["reached"] for row in rows)
    interval = wilson(held / len(rows), len(rows))
    return f"{held} of {len(rows)} ({100 * interval.low:.0f} to {100 * interval.high:.0f} %)"


def write_table(rows: Rows) -> None:
    """Write the table by set and change, and what failed first."""
    unsolved = [row["problem"] for row in rows if row["reached"] is None]
    rows = [row for row in rows if row["reached"] is not None]
    groups = list(dict.fromkeys(row["set"] for row in rows))
    development = [group for group in groups if group != WIDE]
    counts = {group: len({row["problem"] for row in rows if row["set"] == group}) for group in groups}
    columns = [[group] for group in development] + [development, [WIDE]]
    headings = ["change", *development, "all four levels", f"boxes of {WIDE}"]
    lucky = sum(bool(row["reached"] and row["missed"]) for row in rows)
    lines = []
    for change in CHANGES:
        cells = [[row for row in rows if row["change"] == change and row["set"] in column] for column in columns]
        short = [f"{sum(row['reached'] for row in cell)}/{len(cell)}" for cell in cells[:-2]]
        lines.append([change, *short, *map(share, cells[-2:])])
    plans = ", ".join(f"{group} {count}" for group, count in counts.items())
    text = [
        "# Plans executed in changed worlds",
        "",
        "By `make robustness`, open loop: how many plans reach their goal, at rest in the end. Each is executed once",
        "with each change. Intervals are Wilson's of 95 %.",
        "",
        f"Plans: {plans}. No plan was found for: {', '.join(unsolved) or 'none'}.",
        "",
        *markdown.table(headings, lines),
        "",
        "## What went wrong first",
        "",
        *failures(rows),
        "",
        f"In {lucky} other executions a step missed its state, and the goal held all the same. The last column counts",
        "grasps up to the first step that missed its state, over all executions. The three noises of a problem are the",
        "same draws, larger or smaller, unless they had to be drawn again.",
    ]
    OUT.write_text("\n".join(text).rstrip() + "\n")


def failures(rows: Rows) -> Sequence[str]:
    """Count what went wrong first in executions that do not reach the goal, and missed grasps of all executions."""
    lines = []
    for name, wide in (("all four levels", False), (f"boxes of {WIDE}", True)):
        for change in CHANGES:
            some = [row for row in rows if row["change"] == change and (row["set"] == WIDE) == wide]
            missed = sum(classify(row) == KINDS[0] for row in some)
            counts = Counter(classify(row) for row in some if not row["reached"])
            if missed or counts:
                tried = sum(row["grasps"] for row in some)
                lines.append([name, change, *(counts[kind] for kind in KINDS), f"{missed} of {tried}"])
    headings = ["plans", "change", *KINDS, "grasps missed"]
    return markdown.table(headings, lines, left=2) if lines else ["Nothing."]


def classify(row: dict[str, Any]) -> str:
    """Return the kind of the first step that missed its state, or "" when none did."""
    if not row["missed"]:
        return ""
    missing = (row["how"] or "").partition("instead: ")[0]
    if "upright(" in missing or "tipped(" in missing:
        return "a box tipped over"
    if "in-hand(" in missing:
        return "a grasp missed"
    return "boxes not at rest" if "not at rest" in (row["how"] or "") else "another state"


def main() -> None:
    """Execute the plans, count and write the results."""
    write_table(run(tyro.cli(Options, description=__doc__)))
    print(OUT.read_text())


if __name__ == "__main__":
    main()
