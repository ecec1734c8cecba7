"""Accuracy of P and Q against the counted success rate, in scenes not used for training (paper, Figure 3).

`python -m ictamp_drake.experiments.estimator_accuracy --ground-truth data/ground_truth`
"""

import shlex
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.progress import track

from ictamp_drake.core.checks import check_choice, check_count, check_different, check_range
from ictamp_drake.core.files import make_folder, write_whole
from ictamp_drake.estimators.context import EstimatorConfig
from ictamp_drake.learning.cases import read_cases
from ictamp_drake.learning.checkpoint import SHIPPED, SKILLS, Kind, load
from ictamp_drake.learning.dataset import fingerprint
from ictamp_drake.reports.accuracy import Accuracy, compare_estimators
from ictamp_drake.reports.accuracy_figures import draw_all
from ictamp_drake.reports.accuracy_table import as_csv, format_accuracies, markdown
from ictamp_drake.reports.contenders import BaseRates, contenders
from ictamp_drake.reports.predictions import ask_contenders, group_by_scene
from ictamp_drake.runs.command import COMPLETE, command
from ictamp_drake.runs.folder import RUNS
from ictamp_drake.runs.provenance import provenance

NAME = "ictamp_drake.experiments.estimator_accuracy"


@dataclass(frozen=True)
class EstimatorAccuracy:
    """Compare estimates of success with the counted success rate.

    The ground truth consists of many attempts per c with the stochastic policy, in scenes that the networks were not
    trained in: `python -m ictamp_drake.experiments.collect --walk.draws 40 --walk.sources.policy 1
    --walk.sources.optimization 0 --walk.sources.perturbed 0 --walk.sources.uniform 0`.

    Attributes:
        ground_truth: Folder of recorded attempts.
        out: Folder for the table, the cases and the figures. By default a new one in runs/.
        checkpoints: Folder of the trained networks. By default that of the package.
        skills: Skills to evaluate.
        least: Number of attempts counted per case, which is one action from one c. Cases with fewer are left out.
        sampler: Source of k: only attempts with a k from this sampler count. By default all attempts count.
        plans: Whether to also evaluate STAP's product of Q along the plan, which needs trained dynamics.
        base_rate: Share of successes among the attempts that P was trained on.
    """

    ground_truth: Path
    out: Path | None = None
    checkpoints: Path | None = None
    skills: tuple[str, ...] = SKILLS
    least: int = 40
    sampler: str | None = None
    plans: bool = True
    base_rate: BaseRates = BaseRates()

    def __post_init__(self) -> None:
        check_range("least", self.least, 2, 1e6)
        for skill in self.skills:
            check_choice("skills", skill, SKILLS)
        check_count("skills", self.skills, 1, len(SKILLS))
        check_different("skills", self.skills)


def judge(options: EstimatorAccuracy, console: Console, typed: str) -> int:
    """Query all estimators for all cases, write and print the results, and return the exit code.

    Raises:
        IctampError: Attempts or checkpoints are missing or unsuitable.
    """
    checkpoints = options.checkpoints or SHIPPED
    configs = contenders(checkpoints, options.base_rate.complete(checkpoints), options.plans)
    accuracies = [_accuracy(options, skill, configs, console) for skill in options.skills]
    folder = options.out or RUNS / f"estimator_accuracy-{datetime.now():%Y%m%d-%H%M%S}"
    make_folder(folder)
    write_whole(folder / "cases.csv", as_csv(accuracies))
    pictures = draw_all(accuracies, folder)
    write_whole(folder / "table.md", markdown(accuracies, _describe_source(options, checkpoints, typed), pictures))
    console.print(format_accuracies(accuracies))
    console.print(f"\nTable, cases and pictures: {folder}", soft_wrap=True)
    return COMPLETE


def _accuracy(
    options: EstimatorAccuracy, skill: str, configs: Mapping[str, EstimatorConfig], console: Console
) -> Accuracy:
    cases = read_cases(options.ground_truth, skill, options.least, options.sampler)
    asked = track(group_by_scene(cases), f"{skill}, scenes", console=console, transient=True)
    found = [prediction for group in asked for prediction in ask_contenders(group, configs)]
    if len(found) < len(cases):
        left = len(cases) - len(found)
        console.print(f"{skill}: {left} of {len(cases)} cases are left out, since their action does not apply in H(c)")
    estimates = np.array([prediction.estimates for prediction in found]).T
    return compare_estimators(skill, [each.case for each in found], dict(zip(configs, estimates, strict=True)))


def _describe_source(options: EstimatorAccuracy, checkpoints: Path, typed: str) -> dict[str, Any]:
    """Return the provenance of the results: command, data, checkpoints and versions."""
    about: dict[str, Any] = {"command": typed, "ground truth": fingerprint(options.ground_truth)}
    for skill in options.skills:
        kinds: tuple[Kind, ...] = ("policy", "estimator", "dynamics")
        for kind in kinds if options.plans else kinds[:2]:
            trained = load(checkpoints, kind, skill).provenance
            about[f"{kind} of {skill}"] = f"{trained.get('commit')}, data {trained.get('data')}"
    made = provenance()
    versions = ", ".join(f"{name} {version}" for name, version in made["versions"].items())
    return {**about, "commit": made["commit"], "versions": versions}


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the program and return its exit code."""
    given = sys.argv[1:] if arguments is None else list(arguments)
    typed = shlex.join(["python", "-m", NAME, *given])
    return command(NAME, EstimatorAccuracy, lambda o, console: judge(o, console, typed), "Interrupted.", given)


if __name__ == "__main__":
    sys.exit(main())
