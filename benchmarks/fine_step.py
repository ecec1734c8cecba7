"""Execution of plans with a finer physics step: `python benchmarks/fine_step.py --run runs/default`.

Executes each plan.yaml of a run that kept them (--artefacts plan) again, with a step of 1 ms and the whole scene awake.
On each of 2 cores this takes ten seconds for a short plan and 25 for a plan of a hard problem. Writes a table by level
and strategy, and the plans that no longer reach the goal, to benchmarks/fine_step.md.
"""

import shlex
import sys
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path

import pandas as pd
import tyro

from ictamp_drake.reports import markdown
from ictamp_drake.runs.folder import RESULTS
from ictamp_drake.runs.records import read_records
from ictamp_drake.tamp.plan import read_plan
from ictamp_drake.world.config import PhysicsConfig

OUT = Path(__file__).with_suffix(".md")
TIME_STEP = 0.001
"""Time step of the physics [s]."""


@dataclass(frozen=True)
class Options:
    """Execute the plans of a run again.

    Attributes:
        run: Folder of the run.
        strategies: Strategies whose plans are executed; by default all.
    """

    run: Path
    strategies: tuple[str, ...] = ()


def holds(plan: Path) -> bool:
    """Whether the plan still reaches the goal with the fine step."""
    return read_plan(plan).replay(PhysicsConfig(time_step=TIME_STEP, sleep=False)).reached


def main() -> None:
    """Execute the plans, count and write the results."""
    options = tyro.cli(Options, description=__doc__)
    run, wanted = options.run, options.strategies
    records = [record for record in read_records(run / RESULTS).values() if record.solved]
    records = [record for record in records if record.strategy in wanted or not wanted]
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
        held = list(pool.map(holds, [run / record.name / "plan.yaml" for record in records]))
    rows = [(record.level, record.strategy, holding) for record, holding in zip(records, held, strict=True)]
    plans = pd.DataFrame(rows, columns=["level", "strategy", "held"])
    counts = plans.groupby(["level", "strategy"], sort=False)["held"].agg(["sum", "size"]).reset_index()
    lost = [record.name for record, holding in zip(records, held, strict=True) if not holding]
    head = f"# Plans executed with a physics step of 1 ms\n\nBy `{shlex.join(['python', *sys.argv])}`.\n"
    table = markdown.table(["level", "strategy", "hold", "of"], counts.to_numpy(), left=2)
    lines = [head, *table, "", f"Do not hold: {', '.join(lost) or 'none'}."]
    OUT.write_text("\n".join(lines) + "\n")
    print(OUT.read_text())


if __name__ == "__main__":
    main()
