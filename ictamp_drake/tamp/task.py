"""From a scene to a task: all that planning in it needs."""

import math
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter, process_time

from ictamp_drake.core.reading import in_file
from ictamp_drake.core.types import Atom, Configuration, State
from ictamp_drake.scenes.spec import SceneSpec, load_scene
from ictamp_drake.symbolic.domain import Domain
from ictamp_drake.symbolic.goals import check_goal, parse_goal
from ictamp_drake.tamp.method import SCENE_METHOD, Method
from ictamp_drake.world.abstraction import SceneAbstraction
from ictamp_drake.world.observed import Start, observed_scene
from ictamp_drake.world.simulate import Physics
from ictamp_drake.world.start import start_configuration
from ictamp_drake.world.world import World


@dataclass(frozen=True, eq=False)
class Task:
    """A scene with everything that planning in it needs. It can be solved any number of times.

    Attributes:
        spec: The scene.
        world: The scene in Drake.
        physics: Its simulator.
        abstraction: H.
        c: c_0, the configuration in which everything has come to rest.
        s: H(c_0).
        goal: Atoms that must hold.
        domain: Ground actions of the scene.
        setup_time_s: Time that building all this took [s]; it counts as planning time.
        setup_cpu_time_s: The same in processor time [s].
    """

    spec: SceneSpec
    world: World
    physics: Physics
    abstraction: SceneAbstraction
    c: Configuration
    s: State
    goal: frozenset[Atom]
    domain: Domain
    setup_time_s: float
    setup_cpu_time_s: float


def load(scene: Path | str | SceneSpec, method: Method = SCENE_METHOD, *, start: Start | None = None) -> Task:
    """Read a scene, let it come to rest, and check that it can be planned in.

    Args:
        scene: YAML file, or a scene made in Python.
        method: How the scene is simulated and what its predicates mean; planning uses the same.
        start: What was observed of arm, hand and boxes, in the place of what the scene says.

    Raises:
        IctampError: One sentence that says what is wrong with the file, the scene, its start or its goal.
    """
    spec, where = (scene, "the scene") if isinstance(scene, SceneSpec) else (load_scene(scene), str(scene))
    return prepare(spec if start is None else observed_scene(spec, start), method, where)


def prepare(spec: SceneSpec, method: Method = SCENE_METHOD, where: str = "the scene") -> Task:
    """Build all that is needed to plan in a scene.

    Args:
        spec: The scene.
        method: How the scene is simulated and what its predicates mean.
        where: Name of the scene in errors, usually its file.

    Raises:
        IctampError: One sentence that says what is wrong with the scene or its goal.
    """
    started, cpu_started = perf_counter(), process_time()
    with in_file(where):
        goal = parse_goal(spec.goal, sorted(spec.boxes), sorted(spec.supports))
        world = World(spec)
        physics = method.physics.create(world)
        abstraction = SceneAbstraction(world, method.predicates)
        c, s = start_configuration(world, abstraction, physics)
        check_goal(goal, s)
    roomiest_first = sorted(spec.supports, key=lambda name: -math.prod(spec.supports[name].size[:2]))
    domain = Domain.create(sorted(spec.boxes), roomiest_first, s)
    seconds, cpu_seconds = perf_counter() - started, process_time() - cpu_started
    return Task(spec, world, physics, abstraction, c, s, goal, domain, seconds, cpu_seconds)
