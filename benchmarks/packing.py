"""What policy, P and Q buy when k is drawn once a step: `python benchmarks/packing.py`, about three hours on 2 cores.

Solves the paper's three levels in the paper's regime, in which k is drawn once a step and not anew when it has no
motion, with several methods, one after the other level by level, 60 s a problem. A second call continues where the
first one was interrupted. Writes the records and a table to benchmarks/packing/.

python benchmarks/packing.py --levels easy medium --methods "policy, P"
"""

import json
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd
import tyro

from ictamp_drake.runs import markdown
from ictamp_drake.runs.provenance import provenance
from ictamp_drake.scenes.levels import PAPER_LEVELS

ROOT = Path(__file__).parents[1]
OUT = ROOT / "benchmarks" / "packing"
STEP_STAGES = ["sampling", "motion", "physics", "abstraction"]
ONE_DRAW = ("--skills.draws", "1", "--samplers.policy.candidates", "1")
METHODS: dict[str, tuple[str, ...]] = {
    "policy, P": (*ONE_DRAW, "--sampler", "policy", "--estimator", "p-score"),
    "policy, Q": (*ONE_DRAW, "--sampler", "policy", "--estimator", "q-value"),
    "policy, constant": (*ONE_DRAW, "--sampler", "policy", "--estimator", "constant"),
    "uniform, P": (*ONE_DRAW, "--sampler", "uniform", "--estimator", "p-score"),
}
"""Options of each method."""


@dataclass(frozen=True)
class Options:
    """What is run.

    Attributes:
        methods: all by default.
        levels: of the problems, the paper's by default.
    """

    methods: tuple[str, ...] = tuple(METHODS)
    levels: tuple[str, ...] = tuple(PAPER_LEVELS)


def run(method: str, level: str) -> list[dict[str, Any]]:
    """The records of all problems of a level, in their order."""
    folder = ROOT / "runs" / f"benchmark-{method.replace(', ', '-')}-{level}"
    program = [sys.executable, "-m", "ictamp_drake.experiments.packing", "--level", level, "--artefacts", "none"]
    subprocess.run([*program, "--out", str(folder), *METHODS[method]], check=True)
    records = [json.loads(line) for line in (folder / "results.jsonl").read_text().splitlines()]
    return [{"method": method, **record} for record in sorted(records, key=lambda record: record["problem"])]


def table(records: pd.DataFrame) -> pd.DataFrame:
    """The figures of each level and method; unsolved problems count with the time and the steps that they took."""
    stages = pd.json_normalize(records["seconds_by_stage"])
    records["step_s"] = stages.reindex(columns=STEP_STAGES).sum(axis=1) / records["low_level_steps"]
    records["steps_per_skill"] = records["low_level_steps"] / records["plan_length"]
    records["overhead"] = records["planning_time_s"] / records["replay_time_s"]
    groups = records.groupby(["level", "method"], sort=False)
    medians = ["planning_time_s", "high_level_plans", "low_level_steps", "steps_per_skill", "step_s", "overhead"]
    found = pd.concat([groups["solved"].agg(["sum", "size"]), groups[medians].median()], axis=1)
    titles = ["solved and verified", "problems", "time [s]", "plans", "low-level steps", "steps / skill"]
    titles += ["time of a step [s]", "planning / replay time"]
    return found.rename(columns=dict(zip(["sum", "size", *medians], titles, strict=True)))


def main() -> None:
    """Run, judge, write."""
    options = tyro.cli(Options, description=__doc__)
    origin = provenance()
    rows = [row for level in options.levels for method in options.methods for row in run(method, level)]
    OUT.mkdir(parents=True, exist_ok=True)
    (OUT / "results.jsonl").write_text("".join(json.dumps(row) + "\n" for row in rows))
    figures = table(pd.DataFrame(rows)).round(2).reset_index()
    lines = markdown.table(figures.columns, figures.to_numpy())
    about = f"Commit {origin['commit']}, drake {origin['versions']['drake']}, {origin['host']['cores']} cores."
    heading = "# What policy, P and Q buy\n\nMedians over a level's problems, by `python benchmarks/packing.py`."
    (OUT / "table.md").write_text("\n".join([heading, "", about, "", *lines]) + "\n")
    print((OUT / "table.md").read_text())


if __name__ == "__main__":
    main()
