"""The figures of the constrained packing problems: `python benchmarks/packing.py`, about half an hour on 2 cores.

Runs all three levels with the default options into runs/benchmark-LEVEL (a second call continues where the first one
was interrupted), executes every plan found once more with a step of 1 ms, and writes the records and a table to
benchmarks/packing/.
"""

import dataclasses
import json
import subprocess
import sys
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import pandas as pd

from ictamp_drake.runs.plan_file import read_plan
from ictamp_drake.runs.provenance import provenance
from ictamp_drake.scenes.levels import LEVELS
from ictamp_drake.world.simulate import PhysicsConfig

ROOT = Path(__file__).parents[1]
OUT = ROOT / "benchmarks" / "packing"
FINE_STEP = 0.001
"""Time step at which plans are executed again [s]."""
HEADING = """\
# Constrained packing, default options

Medians over the problems of a level, by `python benchmarks/packing.py`.
"""
STEP_STAGES = ["sampling", "motion", "physics", "abstraction"]


def run_level(level: str) -> Path:
    """Plan all problems of a level; returns the run's folder."""
    folder = ROOT / "runs" / f"benchmark-{level}"
    program = [sys.executable, "-m", "ictamp_drake.experiments.packing"]
    subprocess.run([*program, "--level", level, "--artefacts", "plan", "--out", str(folder)], check=True)
    return folder


def holds_at_fine_step(plan: Path) -> bool:
    """Whether the plan, executed with the fine step, ends in the goal again."""
    return read_plan(plan).replay(dataclasses.replace(PhysicsConfig(), time_step=FINE_STEP)).reached


def table(records: pd.DataFrame) -> pd.DataFrame:
    """The figures of each level."""
    stages = pd.json_normalize(records["seconds_by_stage"])
    records["step_s"] = stages[STEP_STAGES].sum(axis=1) / records["low_level_steps"]
    records["steps_per_skill"] = records["low_level_steps"] / records["plan_length"]
    records["overhead"] = records["planning_time_s"] / records["replay_time_s"]
    levels = records.groupby("level", sort=False)
    medians = levels[["planning_time_s", "low_level_steps", "steps_per_skill", "step_s", "overhead"]].median()
    return pd.concat([levels["solved"].agg(["sum", "size"]), medians, levels["holds_at_1ms"].sum()], axis=1).rename(
        columns={
            "sum": "solved and verified",
            "size": "problems",
            "planning_time_s": "time [s]",
            "low_level_steps": "low-level steps",
            "steps_per_skill": "steps / skill",
            "step_s": "time of a step [s]",
            "overhead": "planning / replay time",
            "holds_at_1ms": "hold at 1 ms",
        }
    )


def main() -> None:
    """Run, judge, write."""
    OUT.mkdir(parents=True, exist_ok=True)
    rows = []
    for level in LEVELS:
        folder = run_level(level)
        records = [json.loads(line) for line in (folder / "results.jsonl").read_text().splitlines()]
        plans = {r["problem"]: folder / r["problem"] / "plan.yaml" for r in records if r["solved"]}
        with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
            fine = dict(zip(plans, pool.map(holds_at_fine_step, plans.values()), strict=True))
        rows += sorted((r | {"holds_at_1ms": fine.get(r["problem"])} for r in records), key=lambda r: r["problem"])
    (OUT / "results.jsonl").write_text("".join(json.dumps(row) + "\n" for row in rows))
    figures = table(pd.DataFrame(rows)).round(2).reset_index()
    lines = [" | ".join(map(str, line)) for line in [figures.columns, ["---"] * len(figures.columns), *figures.values]]
    origin = provenance()
    about = f"Commit {origin['commit']}, drake {origin['versions']['drake']}, {origin['host']['cores']} cores."
    (OUT / "table.md").write_text(f"{HEADING}\n{about}\n\n" + "".join(f"| {line} |\n" for line in lines))
    print((OUT / "table.md").read_text())


if __name__ == "__main__":
    main()
