"""Plan in a scene of one's own: `python -m ictamp_drake.plan SCENE.yaml`."""

import sys
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated

import tyro

from ictamp_drake.runs.options import Conduct, Method
from ictamp_drake.runs.program import Work, main
from ictamp_drake.runs.worker import Job, Prepared, Problem


@dataclass(frozen=True)
class Plan:
    """Plan in the scene of a file until its goal is reached, execute and record the plan.

    Attributes:
        scene: YAML file of the scene.
        conduct: how the run is carried out.
        method: how the problem is solved.
    """

    scene: tyro.conf.Positional[Path]
    conduct: Annotated[Conduct, tyro.conf.arg(name="")] = Conduct()
    method: Annotated[Method, tyro.conf.arg(name="")] = Method()


def work(options: Plan) -> Work:
    """The one problem.

    Raises:
        IctampError: what is wrong with the scene; nothing has been written then.
    """
    prepared = Prepared.read(options.scene, options.method)
    name = options.scene.stem
    about = {"program": "plan", "scene": asdict(prepared.task.spec), "options": options.method.decisive}
    job = Job(Problem(name, options.scene.absolute()), options.method, prepared=prepared)
    return Work(name, about, [job], options.conduct)


if __name__ == "__main__":
    sys.exit(main("ictamp_drake.plan", Plan, work))
