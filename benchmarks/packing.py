"""The figures of the constrained packing problems: `python benchmarks/packing.py`, about an hour on 2 cores.

Solves the paper's three levels with several methods, one after the other level by level. Regime "default": several k a
step, of which the first that has a motion is executed, from the optimisation-based sampler and from the policy. Regime
"paper": one draw of k a step, which is not drawn anew when it has no motion, and what policy and P buy there. A second
call continues where the first one was interrupted. Plans of the default regime are executed once more with a step of
1 ms. Writes the records and a table to benchmarks/packing/REGIME/.

python benchmarks/packing.py --regime paper --levels easy medium
"""

import dataclasses
import json
import subprocess
import sys
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
from typing import Any, Literal

import pandas as pd
import tyro

from ictamp_drake.runs import markdown
from ictamp_drake.runs.plan_file import read_plan
from ictamp_drake.runs.provenance import provenance
from ictamp_drake.scenes.levels import PAPER_LEVELS
from ictamp_drake.world.simulate import PhysicsConfig

ROOT = Path(__file__).parents[1]
OUT = ROOT / "benchmarks" / "packing"
FINE_STEP = 0.001
"""Time step at which plans are executed again [s]."""
STEP_STAGES = ["sampling", "motion", "physics", "abstraction"]
ONE_DRAW = ("--skills.draws", "1", "--samplers.policy.candidates", "1")
METHODS: dict[str, dict[str, tuple[str, ...]]] = {
    "default": {
        "optimisation, constant": ("--sampler", "optimisation", "--estimator", "constant"),
        "policy, P": ("--sampler", "policy", "--estimator", "p-score"),
    },
    "paper": {
        "policy, P": (*ONE_DRAW, "--sampler", "policy", "--estimator", "p-score"),
        "policy, Q": (*ONE_DRAW, "--sampler", "policy", "--estimator", "q-value"),
        "policy, constant": (*ONE_DRAW, "--sampler", "policy", "--estimator", "constant"),
        "uniform, P": (*ONE_DRAW, "--sampler", "uniform", "--estimator", "p-score"),
    },
}
"""Options of each method, by regime."""


@dataclass(frozen=True)
class Options:
    """What is run.

    Attributes:
        regime: default or paper.
        methods: of the regime, all by default.
        levels: of the problems, the paper's by default.
    """

    regime: Literal["default", "paper"] = "default"
    methods: tuple[str, ...] = ()
    levels: tuple[str, ...] = tuple(PAPER_LEVELS)


def run(regime: str, method: str, level: str) -> list[dict[str, Any]]:
    """The records of all problems of a level, in their order."""
    name = f"benchmark-{regime}-{method.replace(', ', '-')}-{level}"
    folder = ROOT / "runs" / name
    program = [sys.executable, "-m", "ictamp_drake.experiments.packing", "--level", level, "--artefacts", "plan"]
    subprocess.run([*program, "--out", str(folder), *METHODS[regime][method]], check=True)
    records = [json.loads(line) for line in (folder / "results.jsonl").read_text().splitlines()]
    if regime == "default":
        plans = {record["problem"]: folder / record["problem"] / "plan.yaml" for record in records if record["solved"]}
        with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
            fine = dict(zip(plans, pool.map(holds_at_fine_step, plans.values()), strict=True))
        records = [record | {"holds_at_1ms": fine.get(record["problem"])} for record in records]
    return [{"method": method, **record} for record in sorted(records, key=lambda record: record["problem"])]


def holds_at_fine_step(plan: Path) -> bool:
    """Whether the plan, executed with the fine step, ends in the goal again."""
    return read_plan(plan).replay(dataclasses.replace(PhysicsConfig(), time_step=FINE_STEP)).reached


def table(records: pd.DataFrame) -> pd.DataFrame:
    """The figures of each level and method; unsolved problems count with the time and the steps that they took."""
    stages = pd.json_normalize(records["seconds_by_stage"])
    records["step_s"] = stages.reindex(columns=STEP_STAGES).sum(axis=1) / records["low_level_steps"]
    records["steps_per_skill"] = records["low_level_steps"] / records["plan_length"]
    records["overhead"] = records["planning_time_s"] / records["replay_time_s"]
    groups = records.groupby(["level", "method"], sort=False)
    medians = ["planning_time_s", "high_level_plans", "low_level_steps", "steps_per_skill", "step_s", "overhead"]
    found = pd.concat([groups["solved"].agg(["sum", "size"]), groups[medians].median()], axis=1)
    if "holds_at_1ms" in records:
        found["hold at 1 ms"] = groups["holds_at_1ms"].sum()
    titles = ["solved and verified", "problems", "time [s]", "plans", "low-level steps", "steps / skill"]
    titles += ["time of a step [s]", "planning / replay time"]
    return found.rename(columns=dict(zip(["sum", "size", *medians], titles, strict=True)))


def main() -> None:
    """Run, judge, write."""
    options = tyro.cli(Options, description=__doc__)
    methods = options.methods or tuple(METHODS[options.regime])
    origin = provenance()
    rows = [row for level in options.levels for method in methods for row in run(options.regime, method, level)]
    out = OUT / options.regime
    out.mkdir(parents=True, exist_ok=True)
    (out / "results.jsonl").write_text("".join(json.dumps(row) + "\n" for row in rows))
    figures = table(pd.DataFrame(rows)).round(2).reset_index()
    lines = markdown.table(figures.columns, figures.to_numpy())
    about = f"Commit {origin['commit']}, drake {origin['versions']['drake']}, {origin['host']['cores']} cores."
    heading = f"# Constrained packing, regime {options.regime}\n\nMedians over a level's problems, by "
    text = f"{heading}`python benchmarks/packing.py --regime {options.regime}`.\n\n{about}\n\n"
    (out / "table.md").write_text(text + "\n".join(lines) + "\n")
    print((out / "table.md").read_text())


if __name__ == "__main__":
    main()
