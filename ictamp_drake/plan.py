"""Plan in your own scene: `python -m ictamp_drake.plan SCENE.yaml`."""

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

import ictamp_drake as ict
from ictamp_drake.core.reading import in_file
from ictamp_drake.runs.conduct import Conduct
from ictamp_drake.runs.jobs import Job, Problem
from ictamp_drake.runs.program import Work, main
from ictamp_drake.scenes.spec import to_dict
from ictamp_drake.tamp.method import SCENE_METHOD, Method


@dataclass(frozen=True)
class PlanOptions:
    """Plan in the scene of a file until its goal is reached, then execute and record the plan.

    By default best-first search generates the high-level plans, and adaptive allocation chooses what is computed next.
    The paper's rule is --planner completion-tree; its W suits best-first search, and with --generator breadth-first use
    --planners.completion-tree.W 30.

    Attributes:
        scene: YAML file of the scene.
        robot: Robot that replaces that of the scene: a name of one that ships, or a robot file.
        conduct: Options of the run.
        method: Method that solves the problem.
    """

    scene: tyro.conf.Positional[Path]
    robot: str | None = None
    conduct: Annotated[Conduct, tyro.conf.arg(name="")] = Conduct()
    method: Annotated[Method, tyro.conf.arg(name="")] = SCENE_METHOD


def work(options: PlanOptions) -> Work:
    """Return the problem of the scene as the work of a run.

    Raises:
        IctampError: The scene or the robot is invalid. Nothing has been written at that point.
    """
    task = ict.load(options.scene, options.method, robot=options.robot)
    about = {"program": "plan", "scene": to_dict(task.spec), "options": options.method.decisive}
    with in_file(options.scene):
        problem = Problem(options.scene.stem, task.spec)
    return Work(problem.name, about, [Job(problem, options.method, task=task)], options.conduct, options.robot)


if __name__ == "__main__":
    sys.exit(main("ictamp_drake.plan", PlanOptions, work))
