"""Comparison of strategies on the same problems under equal conditions: the rows of the paper's Table 1 and more.

`python -m ictamp_drake.experiments.runner --regime paper --strategies p-score adaptive --levels hard --seeds 0 1`

The runner solves each problem with every strategy and seed before the next problem, so the results so far are always a
fair comparison. After an interruption, the same command with --out FOLDER continues. It may add strategies, levels,
scenes and seeds.
"""

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro
from rich.console import Console
from rich.progress import track

import ictamp_drake as ict
from ictamp_drake.core.checks import check_choice, check_count, check_different, check_range
from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.reading import in_file
from ictamp_drake.experiments.strategies import REGIMES, STRATEGIES, methods
from ictamp_drake.runs.conduct import Conduct
from ictamp_drake.runs.jobs import Job, Problem
from ictamp_drake.runs.program import Work, about_robot, main
from ictamp_drake.scenes.levels import LEVELS, PAPER_LEVELS, load_problem, problem_files
from ictamp_drake.scenes.spec import to_dict
from ictamp_drake.tamp.method import Method, describe_choices


@dataclass(frozen=True)
class Runner:
    """Compare strategies on the packing problems or on your own scenes.

    Attributes:
        regime: Common options of all strategies, and the strategies that run by default.
        strategies: Names of strategies, or NAME="OPTIONS" with options of the packing program.
        levels: Levels of the problems. By default those of the paper, or none if `scenes` is given.
        problems: Number of a problem or slice of each level's problems, e.g. 3, 0:5 or 10:.
        robot: Robot that replaces that of every scene: a name of one that ships, or a robot file. In the levels some
            stand elsewhere, see `scenes.levels.ARM_OFFSETS`.
        scenes: YAML files of your own scenes. All are checked before the first is solved.
        skip_bad_scenes: Leave out the scenes that are not valid, and say which. By default nothing is solved then.
        seeds: Random seeds of the search.
        conduct: Options of the run.
    """

    regime: Annotated[str, describe_choices(tuple(REGIMES))] = "paper"
    strategies: Annotated[tuple[str, ...], describe_choices(tuple(STRATEGIES))] = ()
    levels: Annotated[tuple[str, ...], describe_choices(LEVELS)] = ()
    problems: str = ":"
    robot: str | None = None
    scenes: tuple[Path, ...] = ()
    skip_bad_scenes: bool = False
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
        IctampError: A level, problem, robot or strategy does not exist, scenes or their goals are invalid, or two
            scenes have the same name. The notes of the error name the other invalid scenes.
    """
    by_strategy = methods(options.regime, options.strategies, options.seeds)
    levels = _of_levels(options)
    scenes = _scenes(options, next(iter(by_strategy.values()))[0])
    jobs = [
        Job(problem, method, strategy)
        for problem in [*levels, *scenes]
        for strategy, seeded in by_strategy.items()
        for method in seeded
    ]
    strategies = {name: _drop_seed(seeded[0].decisive) for name, seeded in by_strategy.items()}
    about = {"program": "runner", "regime": options.regime, **about_robot(options.robot), "strategies": strategies}
    about["scenes"] = {problem.name: to_dict(problem.spec) for problem in scenes}
    return Work(f"runner-{options.regime}", about, jobs, options.conduct, options.robot)


def _of_levels(options: Runner) -> list[Problem]:
    levels = options.levels or (() if options.scenes else PAPER_LEVELS)
    return [
        Problem(name, load_problem(path, options.robot), level)
        for level in levels
        for name, path in _names(level, options.problems).items()
    ]


def _names(level: str, selection: str) -> dict[str, Path]:
    return {f"{level}-{path.stem}": path for path in problem_files(level, selection)}


def _scenes(options: Runner, method: Method) -> list[Problem]:
    """Load the user's own scenes. Each must be ready for planning, with a name that no problem of a level has."""
    files = {name: path for level in LEVELS for name, path in _names(level, ":").items()}
    scenes: list[Problem] = []
    bad: list[IctampError] = []
    console = Console(stderr=True)
    told = console.is_terminal and bool(options.scenes)
    for path in track(options.scenes, "Checking the scenes", console=console, transient=True, disable=not told):
        try:
            scenes.append(_scene(path, files, method, options.robot))
        except IctampError as error:
            bad.append(error)
    if bad and (not options.skip_bad_scenes or not scenes):
        for other in bad[1:]:
            bad[0].add_note(str(other))
        if not options.skip_bad_scenes and len(options.scenes) > 1:
            count = f"{len(bad)} of {len(options.scenes)} scenes"
            bad[0].add_note(f"{count} are not valid; --skip-bad-scenes leaves them out")
        raise bad[0]
    for refused in bad:
        print(f"left out: {refused}", file=sys.stderr)
    return scenes


def _scene(path: Path, files: dict[str, Path], method: Method, robot: str | None) -> Problem:
    """Load a scene, and add its name to `files`, which has the names that are taken."""
    if path.stem in files:
        problem = f"the name of {{value}} is taken by {files[path.stem]}"
        raise IctampError(Code.REPEATED, problem, field="scenes", value=str(path), advice="rename one of them")
    with in_file(path):
        found = Problem(path.stem, ict.load(path, method, robot=robot).spec)
    files[path.stem] = path
    return found


def _drop_seed(options: dict[str, object]) -> dict[str, object]:
    return {name: value for name, value in options.items() if name != "seed"}


if __name__ == "__main__":
    sys.exit(main("ictamp_drake.experiments.runner", Runner, work))
