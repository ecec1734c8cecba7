"""A test in physics: whether a hand holds a small box at home."""

from collections.abc import Iterator

from scipy.spatial.transform import Rotation

from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.robots.robot import Robot
from ictamp_drake.robots.spec import find_file
from ictamp_drake.scenes.spec import BoxSpec, SceneSpec, StartSpec, SupportSpec
from ictamp_drake.tamp.task import prepare

_SIDE = 0.05
"""Side of the box [m], or less if the hand does not open that far."""
_MASS = 0.1
"""Mass of the box [kg]."""


def check_holding(robot: Robot) -> Iterator[IctampError]:
    """Yield a mistake if the hand does not hold a box at home while gravity acts."""
    X_BG = robot.forward(robot.home[None])[0]
    side = min(_SIDE, robot.gripper.max_side)
    rotation = Rotation.from_matrix(X_BG[:3, :3]).as_euler("xyz", degrees=True)
    p_BO = X_BG[:3, 3] + robot.gripper.rise(side) * X_BG[:3, 2]
    box = BoxSpec(size=(side,) * 3, position=tuple(p_BO), rotation=tuple(rotation), mass=_MASS)
    floor = SupportSpec(kind="table", position=(0.0, 0.0, X_BG[2, 3] - 2.0), size=(0.5, 0.5, 0.05))
    scene = SceneSpec(
        robot=robot.name,
        supports={"floor": floor},
        boxes={"sample": box},
        goal="(on sample floor)",
        start=StartSpec(held="sample"),
    )
    try:
        prepare(scene)
    except IctampError as error:
        file = find_file(robot.name)
        problem = f"the hand does not hold a box of {1000 * side:.0f} mm and {_MASS:g} kg at home: {error.problem}"
        advice = "try other values of gripper.stiffness, gripper.force and pads"
        yield IctampError(Code.NOT_HELD, problem, field="gripper", file=file, value=error.value, advice=advice)
