"""Constrained packing (paper, Experiments): rebuild a tower of two, three or four boxes on a rack, or build two towers.

`python -m ictamp_drake.experiments.packing --level easy --problems 0:5`
"""

import sys
from dataclasses import dataclass
from typing import Annotated

import tyro

from ictamp_drake.runs.conduct import Conduct
from ictamp_drake.runs.jobs import Job, Problem
from ictamp_drake.runs.program import Work, about_robot, main
from ictamp_drake.scenes.levels import LEVELS, load_problem, problem_files
from ictamp_drake.tamp.method import Method, describe_choices


@dataclass(frozen=True)
class Packing:
    """Plan, execute and record the constrained packing problems.

    Attributes:
        level: Level of difficulty: a tower of two (easy), three (medium) or four boxes (hard), two towers of all six
            boxes (extreme), or scenes of all kinds (varied).
        problems: Number of a problem or slice of the level's problems, e.g. 3, 0:5 or 10:.
        robot: Robot that replaces the Panda: a name of one that ships, or a robot file. Some stand elsewhere, see
            `scenes.levels.ARM_OFFSETS`.
        conduct: Options of the run.
        method: Method that solves the problems.
    """

    level: Annotated[str, describe_choices(LEVELS)] = "easy"
    problems: str = ":"
    robot: str | None = None
    conduct: Annotated[Conduct, tyro.conf.arg(name="")] = Conduct()
    method: Annotated[Method, tyro.conf.arg(name="")] = Method()


def work(options: Packing) -> Work:
    """Return the problems of a level as the work of a run.

    Raises:
        IctampError: The level, the problems or the robot do not exist.
    """
    level = options.level
    files = problem_files(level, options.problems)
    problems = (Problem(f"{level}-{path.stem}", load_problem(path, options.robot), level) for path in files)
    jobs = [Job(problem, options.method) for problem in problems]
    about = {"program": "packing", "level": level, **about_robot(options.robot), "options": options.method.decisive}
    return Work(f"packing-{level}", about, jobs, options.conduct, options.robot)


if __name__ == "__main__":
    sys.exit(main("ictamp_drake.experiments.packing", Packing, work))
