"""Plan in a scene of one's own: `python -m ictamp_drake.plan SCENE.yaml`."""

import sys
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated

import tyro

from ictamp_drake.planning.proportional import ProportionalConfig
from ictamp_drake.runs.options import Conduct, Method, Planners
from ictamp_drake.runs.program import Work, main
from ictamp_drake.runs.worker import Job, Prepared, Problem

METHOD = Method(generator="best-first", planners=Planners(completion_tree=ProportionalConfig(W=3.0)))
"""How a scene is planned in unless told otherwise; experiments keep the defaults of `Method`.

Best-first search finds a plan of n actions with little more than n expansions, breadth-first search with up to tens of
thousands. With W = 30 the rule would open plans all the time; with 3 it opens about as many as with breadth-first
search and 30 (`benchmarks/opening.py`).
"""


@dataclass(frozen=True)
class Plan:
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
    method: Annotated[Method, tyro.conf.arg(name="")] = METHOD


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
