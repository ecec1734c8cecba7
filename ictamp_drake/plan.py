"""Plan in a scene of one's own: `python -m ictamp_drake.plan SCENE.yaml`."""

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from ictamp_drake.runs.conduct import Conduct
from ictamp_drake.runs.program import Work, main
from ictamp_drake.runs.worker import Job, Problem
from ictamp_drake.scenes.spec import to_dict
from ictamp_drake.tamp.method import SCENE_METHOD, Method
from ictamp_drake.tamp.task import load


@dataclass(frozen=True)
class PlanOptions:
    """Plan in the scene of a file until its goal is reached, execute and record the plan.

    High-level plans come from best-first search by default, and W is chosen with it; with --generator breadth-first,
    --planners.completion-tree.W 30 is the value to take.

    Attributes:
        scene: YAML file of the scene.
        conduct: how the run is carried out.
        method: how the problem is solved.
    """

    scene: tyro.conf.Positional[Path]
    conduct: Annotated[Conduct, tyro.conf.arg(name="")] = Conduct()
    method: Annotated[Method, tyro.conf.arg(name="")] = SCENE_METHOD


def work(options: PlanOptions) -> Work:
    """The one problem.

    Raises:
        IctampError: what is wrong with the scene; nothing has been written then.
    """
    task = load(options.scene, options.method)
    name = options.scene.stem
    about = {"program": "plan", "scene": to_dict(task.spec), "options": options.method.decisive}
    job = Job(Problem(name, task.spec), options.method, task=task)
    return Work(name, about, [job], options.conduct)


if __name__ == "__main__":
    sys.exit(main("ictamp_drake.plan", PlanOptions, work))
