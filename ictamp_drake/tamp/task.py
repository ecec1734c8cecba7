"""Turn a scene into a task, which holds everything that planning needs."""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter, process_time

from ictamp_drake.core.reading import in_file
from ictamp_drake.core.types import Configuration, State
from ictamp_drake.robots.grip import check_weight
from ictamp_drake.robots.robot import find_robot
from ictamp_drake.scenes.spec import SceneSpec, load_scene, replace_robot
from ictamp_drake.skills.config import PickConfig
from ictamp_drake.symbolic.domain import Domain
from ictamp_drake.symbolic.goal import Goal
from ictamp_drake.symbolic.goal_reading import check_goal
from ictamp_drake.symbolic.guides import boxes_to_move
from ictamp_drake.tamp.method import SCENE_METHOD, Method
from ictamp_drake.tamp.symbols import domain_of, goal_of
from ictamp_drake.world.abstraction import SceneAbstraction
from ictamp_drake.world.observed import Start, observed_scene
from ictamp_drake.world.simulate import Physics
from ictamp_drake.world.start import start_configuration
from ictamp_drake.world.world import World


@dataclass(frozen=True, eq=False)
class Task:
    """A scene with everything that planning needs. It can be solved any number of times.

    Attributes:
        spec: Scene of the task.
        world: Model of the scene in Drake.
        physics: Simulator of the scene.
        abstraction: Abstraction H.
        c: Initial configuration c_0, in which everything is at rest.
        s: Initial symbolic state H(c_0).
        goal: Goal that must hold at the end.
        domain: Ground actions of the scene.
        setup_time_s: Time for building the task [s]; it counts as planning time.
        setup_cpu_time_s: Processor time for building the task [s].
    """

    spec: SceneSpec
    world: World
    physics: Physics
    abstraction: SceneAbstraction
    c: Configuration
    s: State
    goal: Goal
    domain: Domain
    setup_time_s: float
    setup_cpu_time_s: float


def load(
    scene: Path | str | SceneSpec,
    method: Method = SCENE_METHOD,
    *,
    start: Start | None = None,
    robot: str | None = None,
) -> Task:
    """Read a scene, let it come to rest, and check that it can be planned in.

    Args:
        scene: YAML file, or a scene made in Python.
        method: Method whose physics and predicates are used; pass the same method to `solve`.
        start: Observed start of arm, hand and boxes, which replaces the start in the scene.
        robot: Robot that replaces that of the scene: a name of one that ships, or the path of a robot file.

    Raises:
        IctampError: The file, the scene, its robot, its start or its goal is not valid; one sentence says why.
    """
    if isinstance(scene, SceneSpec):
        spec, where = scene if robot is None else replace_robot(scene, robot), "the scene"
    else:
        spec, where = load_scene(scene, robot), str(scene)
    return prepare(spec if start is None else observed_scene(spec, start), method, where)


def prepare(spec: SceneSpec, method: Method = SCENE_METHOD, where: str = "the scene") -> Task:
    """Build everything needed to plan in a scene.

    Args:
        spec: Scene to plan in.
        method: Method whose physics and predicates are used.
        where: Name of the scene in errors, usually its file.

    Raises:
        IctampError: The scene or its goal is not valid, or the goal moves a box that the hand cannot hold; one sentence
            says why.
    """
    started, cpu_started = perf_counter(), process_time()
    with in_file(where):
        goal = goal_of(spec)
        world = World(spec)
        physics = method.physics.create(world)
        abstraction = SceneAbstraction(world, method.predicates)
        c, s = start_configuration(world, abstraction, physics)
        goal = check_goal(goal, s)
        domain = domain_of(spec, s)
        check_weights(spec, boxes_to_move(domain, goal, s), method)
    seconds, cpu_seconds = perf_counter() - started, process_time() - cpu_started
    return Task(spec, world, physics, abstraction, c, s, goal, domain, seconds, cpu_seconds)


def check_weights(spec: SceneSpec, boxes: Iterable[str], method: Method) -> None:
    """Raise IctampError when the hand cannot hold one of the boxes with the safety of the method's pick."""
    if isinstance(method.skills.pick, PickConfig):
        for name in sorted(boxes):
            box = spec.boxes[name]
            gripper = find_robot(spec.robot).gripper
            check_weight(box.mass, box.friction, gripper, f"boxes.{name}", method.skills.pick.safety)
