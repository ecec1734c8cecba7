"""Success rate and cost of one parameter k: `python benchmarks/skills.py`, half an hour on 2 cores.

Walks through held-out training scenes (with a seed of their own) and attempts every action on the way with k from each
source. A case counts as doable if an attempt of the optimization-based sampler succeeded. Writes a table and the
attempts to benchmarks/skills/. After an interruption, the same command continues.

python benchmarks/skills.py --reference runs/stap --scenes 0:60
"""

import shlex
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby
from operator import itemgetter
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import tyro
from scipy.stats import bootstrap

from ictamp_drake.core.protocols import Sampler
from ictamp_drake.core.types import Action, Configuration
from ictamp_drake.learning.dataset import action, configuration, open_table, scene
from ictamp_drake.motion.inverse_kinematics import ArmKinematics
from ictamp_drake.reports import markdown
from ictamp_drake.runs.provenance import provenance
from ictamp_drake.skills.config import OptimizationConfig, PolicyConfig, UniformConfig
from ictamp_drake.skills.context import SamplerContext
from ictamp_drake.world.poses import to_transform
from ictamp_drake.world.world import World

OUT = Path(__file__).parent / "skills"
SEED = 1
"""Seed of the scenes; the training scenes have seed 0."""
SOURCES = {
    "uniform": "uniform",
    "optimization": "optimization-based",
    "reference": "STAP's actor-critic, one draw",
    "policy": "policy, one draw",
    "best": "policy, best of 16 by Q",
    "product": "policy, best of 16 with a motion",
}
"""Titles of the sources of k, by their names in `collection.walk.Sources`."""
TIMED = 200
"""Number of cases in which the sources are timed."""
CASE = ["scene", "state", "action", "box", "place"]


@dataclass(frozen=True)
class Options:
    """Compare sources of k.

    Attributes:
        scenes: Slice of the held-out scenes.
        checkpoints: Folder of the trained policies; by default that of the package.
        reference: Folder of the reference's trained policies.
        out: Folder for the attempts and the table.
    """

    scenes: str = "0:60"
    checkpoints: Path | None = None
    reference: Path | None = None
    out: Path = OUT


def collect(options: Options) -> None:
    """Make two attempts at every action with k from each source."""
    present = [name for name in SOURCES if name != "reference" or options.reference]
    weights = [
        word for name in ("perturbed", *SOURCES) for word in (f"--walk.sources.{name}", str(int(name in present)))
    ]
    folders = {"checkpoints": options.checkpoints, "reference": options.reference}
    named = [word for name, folder in folders.items() if folder for word in (f"--walk.{name}", str(folder))]
    program = [sys.executable, "-m", "ictamp_drake.experiments.collect", "--seed", str(SEED)]
    walk = ["--walk.compare", "--walk.states", "10", "--walk.draws", "2", *weights, *named]
    subprocess.run([*program, "--scenes", options.scenes, "--out", options.out, *walk], check=True)


def rates(attempts: pd.DataFrame) -> Iterator[dict[str, str]]:
    """Yield a row per skill and source: share of successes in all and in doable cases, with 95 % intervals."""
    attempts["won"] = attempts["failure"].isna()
    by_optimization = attempts[attempts["sampler"] == "optimization"].groupby(CASE, observed=True)["won"].any()
    attempts = attempts.join(by_optimization.rename("doable"), on=CASE)
    for skill in ("pick", "place"):
        for name, title in SOURCES.items():
            rows = attempts[(attempts["action"] == skill) & (attempts["sampler"] == name)]
            if len(rows):
                doable = rows[rows["doable"]]
                yield {
                    "skill": skill,
                    "k from": title,
                    "cases": str(len(rows.groupby(CASE, observed=True))),
                    "success": share(rows),
                    "doable cases": str(len(doable.groupby(CASE, observed=True))),
                    "success there": "" if name == "optimization" else share(doable),
                }


def share(rows: pd.DataFrame) -> str:
    """Share of successes and its bootstrap interval over scenes."""
    scenes = rows.groupby("scene")["won"].agg(["sum", "size"]).to_numpy(dtype=float).T
    found = bootstrap(
        tuple(scenes), lambda won, size, axis: won.sum(axis) / size.sum(axis), paired=True, method="percentile", rng=0
    )
    low, high = found.confidence_interval
    return f"{rows['won'].mean():.1%} ({low:.1%} to {high:.1%})"


def milliseconds(options: Options, cases: Sequence[dict[str, Any]]) -> dict[tuple[str, str], float]:
    """Median computing time of the first k, by skill and source [ms]."""
    samples: dict[tuple[str, str], list[float]] = {}
    for text, rows in groupby(cases, key=itemgetter("spec")):
        sources, each = samplers(options, World(scene(text))), list(rows)
        for name, sampler in sources.items():
            for row in each:
                samples.setdefault((row["action"], name), []).append(
                    time_sampler(sampler, configuration(row), action(row))
                )
    return {key: float(np.median(values)) for key, values in samples.items()}


def time_sampler(sampler: Sampler[Configuration], c: Configuration, a: Action) -> float:
    """Processor time of the first k [ms]."""
    start = time.process_time()
    next(sampler.draws(c, a, np.random.default_rng(0)))
    return 1e3 * (time.process_time() - start)


def samplers(options: Options, world: World) -> dict[str, Sampler[Configuration]]:
    """Create the sources whose costs differ."""
    arm = ArmKinematics(world.robot, to_transform(world.spec.arm.X_WB))
    learned = {"policy": PolicyConfig(options.checkpoints, 1), "best": PolicyConfig(options.checkpoints, 16, 0.0)}
    if options.reference:
        learned["reference"] = PolicyConfig(options.reference, 1)
    configs = {"uniform": UniformConfig(), "optimization": OptimizationConfig(), **learned}
    return {name: config.create(SamplerContext(world, arm)) for name, config in configs.items()}


def main() -> None:
    """Collect attempts, count successes, time the sources and write the results."""
    options = tyro.cli(Options, description=__doc__)
    origin = provenance()
    collect(options)
    attempts = open_table(options.out).to_table(columns=[*CASE, "sampler", "failure"]).to_pandas()
    table = pd.DataFrame(rates(attempts))
    columns = [*CASE, "spec", "q", "poses", "held", "gripper"]
    rows = open_table(options.out).to_table(columns=columns).to_pylist()
    cost = milliseconds(options, list({tuple(row[name] for name in CASE): row for row in rows}.values())[:TIMED])
    named = {(skill, SOURCES[name]): f"{value:.2f}" for (skill, name), value in cost.items()}
    table["ms"] = [named.get(key, "") for key in zip(table["skill"], table["k from"], strict=True)]
    about = f"Commit {origin['commit']}, drake {origin['versions']['drake']}, scenes {options.scenes} of seed {SEED}."
    lines = markdown.table(table.columns, table.to_numpy())
    typed = shlex.join(["python", "benchmarks/skills.py", *sys.argv[1:]])
    text = "\n".join(["# One parameter k", "", f"By `{typed}`. {about}", "", *lines, ""])
    (options.out / "table.md").write_text(text)
    print(text)


if __name__ == "__main__":
    main()
