"""Task and motion planning on Drake with an infinite completion tree and learned skills.

    import ictamp_drake as ict

    task = ict.load("scene.yaml")
    solution = ict.solve(task, time_limit=30)
    if solution.plan is None:
        print(solution.explain())
    else:
        solution.plan.save("plan.yaml")

These names are for users; `ictamp_drake.plugins` is for authors of samplers, estimators, rules and skills.
"""

from importlib import metadata
from typing import TYPE_CHECKING, Any

from ictamp_drake.core.lazy import import_lazily

if TYPE_CHECKING:
    from ictamp_drake.core.errors import IctampError
    from ictamp_drake.core.failures import Failure
    from ictamp_drake.scenes.regions import PoseSpec as Pose
    from ictamp_drake.scenes.regions import RegionSpec as Region
    from ictamp_drake.scenes.spec import ArmSpec as Arm
    from ictamp_drake.scenes.spec import BoxSpec as Box
    from ictamp_drake.scenes.spec import SceneSpec as Scene
    from ictamp_drake.scenes.spec import SupportSpec as Support
    from ictamp_drake.tamp.explanation import Explanation
    from ictamp_drake.tamp.method import Method
    from ictamp_drake.tamp.plan import Plan
    from ictamp_drake.tamp.solve import Solution, solve
    from ictamp_drake.tamp.task import Task, load
    from ictamp_drake.world.observed import Start

__all__ = [
    "Arm",
    "Box",
    "Explanation",
    "Failure",
    "IctampError",
    "Method",
    "Plan",
    "Pose",
    "Region",
    "Scene",
    "Solution",
    "Start",
    "Support",
    "Task",
    "__version__",
    "load",
    "solve",
]

_HOMES = {
    "Arm": "scenes.spec:ArmSpec",
    "Box": "scenes.spec:BoxSpec",
    "Explanation": "tamp.explanation:Explanation",
    "Failure": "core.failures:Failure",
    "IctampError": "core.errors:IctampError",
    "Method": "tamp.method:Method",
    "Plan": "tamp.plan:Plan",
    "Pose": "scenes.regions:PoseSpec",
    "Region": "scenes.regions:RegionSpec",
    "Scene": "scenes.spec:SceneSpec",
    "Solution": "tamp.solve:Solution",
    "Start": "world.observed:Start",
    "Support": "scenes.spec:SupportSpec",
    "Task": "tamp.task:Task",
    "load": "tamp.task:load",
    "solve": "tamp.solve:solve",
}
"""Where each public name is defined. It is imported when it is first used, since Drake and torch take a second."""


_import = import_lazily(__name__, globals(), _HOMES)


def __getattr__(name: str) -> Any:
    return metadata.version("ictamp_drake") if name == "__version__" else _import(name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
