"""A scene with a tower, a rack and two single boxes, and an independent check of its collisions."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from pydrake.math import RigidTransform, RotationMatrix

from ictamp_drake.core.types import Configuration, FloatArray
from ictamp_drake.motion.planner import MotionPlanner
from ictamp_drake.scenes.spec import BoxSpec, SceneSpec, SupportSpec
from ictamp_drake.world.poses import to_transform
from ictamp_drake.world.world import World

CYAN, YELLOW, RED, BLUE = (0.058, 0.058, 0.07), (0.057, 0.057, 0.066), (0.05, 0.05, 0.118), (0.05, 0.05, 0.106)


@pytest.fixture(scope="session")
def world() -> World:
    """Red on yellow on cyan at (0.5, 0.1), blue beyond it at (0.5, 0.3), the rack on the other side."""
    boxes = {
        "cyan_box": BoxSpec(size=CYAN, position=(0.5, 0.1, 0.035)),
        "yellow_box": BoxSpec(size=YELLOW, position=(0.5, 0.1, 0.103)),
        "red_box": BoxSpec(size=RED, position=(0.5, 0.1, 0.195)),
        "blue_box": BoxSpec(size=BLUE, position=(0.5, 0.3, 0.053)),
    }
    supports = {
        "table": SupportSpec(kind="table", position=(0.3, 0.0, 0.0)),
        "rack": SupportSpec(kind="rack", position=(0.44, -0.33, 0.16), yaw=90.0),
    }
    return World(SceneSpec(supports=supports, boxes=boxes, goal="(on blue_box rack)"))


@pytest.fixture(scope="session")
def c(world: World) -> Configuration:
    """All boxes at their initial poses, and an open, empty hand."""
    return world.initial_configuration()


@pytest.fixture
def planner(world: World) -> MotionPlanner:
    """A planner that has not been used yet."""
    return MotionPlanner(world)


@pytest.fixture(scope="session")
def down() -> Callable[..., RigidTransform]:
    """X_WG of a hand at a position, pointing down."""

    def pose(x: float, y: float, z: float, yaw: float = 0.0) -> RigidTransform:
        return RigidTransform(RotationMatrix.MakeZRotation(yaw) @ RotationMatrix.MakeXRotation(np.pi), [x, y, z])

    return pose


@pytest.fixture(scope="session")
def holding(world: World) -> Callable[..., Configuration]:
    """The initial configuration with the arm at q and a box between its fingers."""

    def configuration(q: FloatArray, name: str, X_WO: RigidTransform) -> Configuration:
        c = world.initial_configuration()
        width = world.sizes[name][1]
        pose = np.concatenate([X_WO.rotation().ToQuaternion().wxyz(), X_WO.translation()])
        return Configuration(q, np.full(2, width / 2), {**c.poses, name: pose}, name)

    return configuration


@pytest.fixture(scope="session")
def overlaps() -> Callable[[World, Configuration, FloatArray], dict[frozenset[str], float]]:
    """Depths [m] at which the arm or held box overlaps anything, by plain SceneGraph queries on a separate diagram."""

    def depths(world: World, c: Configuration, q: FloatArray) -> dict[frozenset[str], float]:
        plant, scene_graph = world.plant, world.diagram.scene_graph()
        root = world.diagram.CreateDefaultContext()
        context = plant.GetMyMutableContextFromRoot(root)
        plant.SetPositions(context, world.bodies.positions(c))
        hand = world.bodies.robot.hand
        X_HW = plant.EvalBodyPoseInWorld(context, hand).inverse()
        X_HO = None if c.held is None else X_HW @ to_transform(c.poses[c.held])
        plant.SetPositions(context, world.bodies.positions(replace(c, q=q)))
        for name, body in world.bodies.boxes.items():
            moved = None if name != c.held else plant.EvalBodyPoseInWorld(context, hand) @ X_HO
            plant.SetFloatingBaseBodyPoseInWorldFrame(context, body, moved or to_transform(c.poses[name]))
        query = scene_graph.get_query_output_port().Eval(scene_graph.GetMyContextFromRoot(root))
        standing = {*world.bodies.boxes, *world.bodies.supports} - {c.held}
        grasp = {c.held, "panda_hand", "panda_leftfinger", "panda_rightfinger"} if c.held else set()
        found = {}
        for pair in query.ComputePointPairPenetration():
            frames = (query.inspector().GetFrameId(geometry) for geometry in (pair.id_A, pair.id_B))
            names = frozenset(plant.GetBodyFromFrameId(frame).name() for frame in frames)
            if not names <= standing and not names <= grasp:
                found[names] = max(pair.depth, found.get(names, 0.0))
        return found

    return depths
