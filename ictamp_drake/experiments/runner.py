"""Comparison of strategies on the same problems under equal conditions: the rows of the paper's Table 1 and more.

`python -m ictamp_drake.experiments.runner --regime paper --strategies p-score adaptive --levels hard --seeds 0 1`

The runner solves each problem with every strategy and seed before the next problem, so the results so far are always a
fair comparison. After an interruption, the same command with --out FOLDER continues. It may add strategies, levels,
scenes and seeds.
"""

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

import ictamp_drake as ict
from ictamp_drake.core.checks import check_choice, check_count, check_different, check_range
from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.experiments.strategies import REGIMES, STRATEGIES, methods
from ictamp_drake.runs.conduct import Conduct
from ictamp_drake.runs.jobs import Job, Problem
from ictamp_drake.runs.program import Work, main
from ictamp_drake.scenes.levels import LEVELS, PAPER_LEVELS, problem_files
from ictamp_drake.scenes.spec import load_scene, to_dict
from ictamp_drake.tamp.method import Method, describe_choices


@dataclass(frozen=True)
class Runner:
    """Compare strategies on the packing problems or on your own scenes.

    Attributes:
        regime: Common options of all strategies, and the strategies that run by default.
        strategies: Names of strategies, or NAME="OPTIONS" with options of the packing program.
        levels: Levels of the problems. By default those of the paper, or none if `scenes` is given.
        problems: Number of a problem or slice of each level's problems, e.g. 3, 0:5 or 10:.
        scenes: YAML files of your own scenes.
        seeds: Random seeds of the search.
        conduct: Options of the run.
    """

    regime: Annotated[str, describe_choices(tuple(REGIMES))] = "paper"
    strategies: Annotated[tuple[str, ...], describe_choices(tuple(STRATEGIES))] = ()
    levels: Annotated[tuple[str, ...], describe_choices(LEVELS)] = ()
    problems: str = ":"
    scenes: tuple[Path, ...] = ()
    seeds: tuple[int, ...] = (0,)
    conduct: Annotated[Conduct, tyro.conf.arg(name="")] = Conduct(artefacts="none")

    def __post_init__(self) -> None:
        check_choice("regime", self.regime, REGIMES)
        check_count("seeds", self.seeds, 1, 1000)
        for seed in self.seeds:
            check_range("seeds", seed, 0, 2**63 - 1)
        check_different("seeds", self.seeds)
        check_different("levels", self.levels)


def work(options: Runner) -> Work:
    """Return every problem with every strategy and seed as the work of a run.

    Raises:
        IctampError: A level, problem or strategy does not exist, a scene or its goal is invalid, or two scenes have the
            same name.
    """
    by_strategy = methods(options.regime, options.strategies, options.seeds)
    scenes = _scenes(options.scenes, next(iter(by_strategy.values()))[0])
    jobs = [
        Job(problem, method, strategy)
        for problem in [*_of_levels(options), *scenes]
        for strategy, seeded in by_strategy.items()
        for method in seeded
    ]
    strategies = {name: _drop_seed(seeded[0].decisive) for name, seeded in by_strategy.items()}
    about = {"program": "runner", "regime": options.regime, "strategies": strategies}
    about["scenes"] = {problem.name: to_dict(problem.spec) for problem in scenes}
    return Work(f"runner-{options.regime}", about, jobs, options.conduct)


def _of_levels(options: Runner) -> list[Problem]:
    levels = options.levels or (() if options.scenes else PAPER_LEVELS)
    return [
        Problem(name, load_scene(path), level)
        for level in levels
        for name, path in _names(level, options.problems).items()
    ]


def _names(level: str, selection: str) -> dict[str, Path]:
    return {f"{level}-{path.stem}": path for path in problem_files(level, selection)}


def _scenes(paths: Sequence[Path], method: Method) -> list[Problem]:
    """Load the user's own scenes. Each must be ready for planning, with a name that no problem of a level has."""
    files = {name: path for level in LEVELS for name, path in _names(level, ":").items()}
    scenes: list[Problem] = []
    for path in paths:
        if path.stem in files:
            problem = f"the name of {{value}} is taken by {files[path.stem]}"
            raise IctampError(Code.REPEATED, problem, field="scenes", value=str(path), advice="rename one of them")
        files[path.stem] = path
        scenes.append(Problem(path.stem, ict.load(path, method).spec))
    return scenes


def _drop_seed(options: dict[str, object]) -> dict[str, object]:
    return {name: value for name, value in options.items() if name != "seed"}


if __name__ == "__main__":
    sys.exit(main("ictamp_drake.experiments.runner", Runner, work))
