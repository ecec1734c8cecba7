"""k from a mathematical program over the arm's joints: reachable, clear of the neighbors, centered and stable.

Forward kinematics make k a function of the joint positions q. The program's variables are therefore q alone, and all
constraints and costs on k become constraints and costs on the pose of G. Modes, aims and starts are random, so repeated
solutions are samples of k.
"""

from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.inverse_kinematics import InverseKinematics
from pydrake.solvers import SnoptSolver

from ictamp_drake.core.failures import Failure
from ictamp_drake.core.types import Action, Configuration, FloatArray, Parameter
from ictamp_drake.motion.inverse_kinematics import ArmKinematics
from ictamp_drake.skills.config import OptimizationConfig
from ictamp_drake.skills.geometry import R_DOWN, grasp_parameter, held_bottom, placement_parameter
from ictamp_drake.skills.neighbours import Neighbour, free_spot, is_covered, neighbours
from ictamp_drake.world.poses import to_transform
from ictamp_drake.world.world import World

UPRIGHT_ANGLE = 1e-3
"""Maximum tilt of a placed box [rad]."""
FLAT_RANGE = 0.002
"""Range of heights of G on a box too flat for the usual depth of a grasp [m]."""


class OptimizationSampler:
    """Draws k by solving randomly restarted programs with SNOPT."""

    def __init__(self, world: World, arm: ArmKinematics, config: OptimizationConfig) -> None:
        self._world = world
        self._arm = arm
        self._config = config
        self._gripper = world.robot.gripper
        self._solver = SnoptSolver()

    def draws(self, c: Configuration, action: Action, rng: np.random.Generator) -> Iterator[Parameter | Failure]:
        """Any number of k, then the failure once no program has a solution.

        GOAL_IN_COLLISION when a program without the neighbors has one, else NO_INVERSE_KINEMATICS.
        """
        around = self._neighbours(c, action)
        for config in self._list_configs(c, action):
            while (k := self._draw(c, action, rng, around, config)) is not None:
                yield k
        alone = self._draw(c, action, rng, [], self._config)
        yield Failure.NO_INVERSE_KINEMATICS if alone is None else Failure.GOAL_IN_COLLISION

    def _list_configs(self, c: Configuration, action: Action) -> tuple[OptimizationConfig, ...]:
        """List constants in the order in which they are tried. A covered box is gripped anywhere along its sides."""
        config, box = self._config, action.args[0]
        if action.name == "place":
            return (config,)
        if is_covered(self._world, c, box):
            along = float(self._world.upright_frame(c, box).size[:2].max()) / 2
            return (replace(config, grip_offset=(along, config.grip_offset[1])),)
        return config, config.tight

    def _neighbours(self, c: Configuration, action: Action) -> list[Neighbour]:
        """Things that reach as high as the fingers of a grasp, or as the place where the held box is put."""
        box, other = action.args
        if action.name == "place":
            return neighbours(self._world, c, {box, other}, self._world.X_WT(c, other).translation()[2])
        lying = self._world.upright_frame(c, box)
        lowest = lying.X_WT.translation()[2] - min(self._config.depth[1], lying.size[2] - self._config.ground)
        return neighbours(self._world, c, {box}, lowest - self._gripper.hand.tip)

    def _draw(
        self,
        c: Configuration,
        action: Action,
        rng: np.random.Generator,
        around: Sequence[Neighbour],
        config: OptimizationConfig,
    ) -> Parameter | None:
        box, other = action.args
        if action.name == "pick":
            X_WG = self._solve(lambda: self._grasp(c, box, around, rng, config), rng)
            return None if X_WG is None else grasp_parameter(self._world, c, box, X_WG)
        X_GB = held_bottom(self._world, c, box, self._arm.forward(c.q))
        X_WG = self._solve(lambda: self._placement(c, action, X_GB, around, rng), rng)
        return None if X_WG is None else placement_parameter(self._world, c, other, X_GB, X_WG)

    def _solve(self, pose: Callable[[], "_HandProgram | None"], rng: np.random.Generator) -> RigidTransform | None:
        """X_WG from the first random program that has a solution."""
        for _ in range(self._config.restarts):
            program = pose()
            q = None if program is None else program.solve(self._solver, rng)
            if q is not None:
                return self._arm.forward(q)
        return None

    def _grasp(
        self,
        c: Configuration,
        box: str,
        around: Sequence[Neighbour],
        rng: np.random.Generator,
        config: OptimizationConfig,
    ) -> "_HandProgram | None":
        """Program with the fingers along a face of the box and G near its middle, neither too high nor too deep."""
        lying = self._world.upright_frame(c, box)
        quarters = [m for m in range(4) if lying.size[1 - m % 2] <= (config.max_width or self._gripper.max_side)]
        if not quarters:
            return None
        half_height = lying.size[2] / 2
        ground = config.ground - half_height
        highest = max(half_height - config.depth[0], ground)
        lowest = max(half_height - config.depth[1], min(ground, highest - FLAT_RANGE))
        lower = np.array([-config.grip_offset[0], -config.grip_offset[1], lowest])
        upper = np.array([*config.grip_offset, highest])
        quarter = rng.choice(quarters)
        R_UM = RotationMatrix.MakeZRotation(quarter * np.pi / 2)
        program = _HandProgram(self._arm, config, lying.X_WU @ RigidTransform(R_UM, np.zeros(3)))
        aim = rng.uniform(lower, upper)
        program.keep_inside(lower, upper, aim, np.zeros(3))
        program.align(R_DOWN, RotationMatrix())
        height, width = float((program.X_WA @ aim)[2]), float(lying.size[1 - quarter % 2])
        radius = self._gripper.hand.pad_radius
        y = min(width / 2 + config.play, self._gripper.opening / 2) + radius
        pads = np.array([[0.0, y, 0.0], [0.0, -y, 0.0]])
        program.keep_clear(pads, radius + config.clearance / 2, around, height)
        if config.clearance == 0:
            program.demand_clear(pads, radius, around)
        return program

    def _placement(
        self,
        c: Configuration,
        action: Action,
        X_GB: RigidTransform,
        around: Sequence[Neighbour],
        rng: np.random.Generator,
    ) -> "_HandProgram | None":
        """Program that puts the box just above the top face: where a support has room, or in the middle of a box."""
        box, receptacle = action.args
        config, X_WT = self._config, self._world.X_WT(c, receptacle)
        radius = float(np.linalg.norm(self._world.upright_frame(c, box).size[:2])) / 2
        on_box = receptacle in self._world.spec.boxes
        edge = 0.0 if receptacle in self._world.spec.areas else radius
        room = np.maximum(self._world.top_size(c, receptacle) / 2 - edge, 0.0)
        bound = np.full(2, config.overhang) if on_box else room
        spot = rng.uniform(-bound, bound) if on_box else self._free_spot(X_WT, bound, around, radius, rng)
        if spot is None:
            return None
        program = _HandProgram(self._arm, config, X_WT)
        lower, upper = np.append(-bound, config.height[0]), np.append(bound, config.height[1])
        program.keep_inside(lower, upper, np.append(spot, np.mean(config.height)), X_GB.translation())
        if on_box:
            program.align(RotationMatrix.MakeZRotation(rng.integers(4) * np.pi / 2), X_GB.rotation())
        else:
            program.keep_level(X_GB.rotation())
        program.keep_clear([X_GB.translation()], radius + config.clearance / 2, around, X_WT.translation()[2])
        return program

    def _free_spot(
        self,
        X_WT: RigidTransform,
        bound: FloatArray,
        around: Sequence[Neighbour],
        radius: float,
        rng: np.random.Generator,
    ) -> FloatArray | None:
        """The roomiest of some random spots within the arm's reach, in T, shape (2,) [m], or None."""
        config = self._config
        spots = rng.uniform(-bound, bound, (4 * config.spots, 2))
        p_TB = (X_WT.inverse() @ to_transform(self._world.spec.arm.X_WB)).translation()
        distance = np.linalg.norm(spots - p_TB[:2], axis=1)
        near = spots[(distance > config.reach[0]) & (distance < config.reach[1])][: config.spots]
        return free_spot(near, X_WT, around, radius + config.clearance, config.room)


class _HandProgram:
    """Inverse kinematics of G. The aims, bounds and directions of k are given in a frame A."""

    def __init__(self, arm: ArmKinematics, config: OptimizationConfig, X_WA: RigidTransform) -> None:
        self.X_WA = X_WA
        self._arm = arm
        self._config = config
        self._comfort = arm.comfortable_posture(X_WA)
        self._world = arm.plant.world_frame()
        self._grasp = arm.grasp
        self._target = arm.plant.GetFrameByName("target")
        context = arm.plant.CreateDefaultContext()
        self._target.SetPoseInParentFrame(context, X_WA)
        self._clear: Callable[[FloatArray], bool] = lambda _: True
        self._context = context  # the program refers to it but does not keep it alive
        self._ik = InverseKinematics(arm.plant, context, with_joint_limits=False)
        self._ik.prog().AddBoundingBoxConstraint(arm.lower, arm.upper, self._ik.q())
        self._ik.prog().AddQuadraticErrorCost(config.comfort * np.eye(len(self._comfort)), self._comfort, self._ik.q())

    def keep_inside(self, lower: FloatArray, upper: FloatArray, p_AQ: FloatArray, p_GQ: FloatArray) -> None:
        """Keep a point of the hand between bounds in A and near the aim p_AQ, all of shape (3,) [m]."""
        self._ik.AddPositionConstraint(self._grasp, p_GQ, self._target, lower, upper)
        self._ik.AddPositionCost(self._target, p_AQ, self._grasp, p_GQ, self._config.centring * np.eye(3))

    def align(self, R_AQ: RotationMatrix, R_GQ: RotationMatrix) -> None:
        """Align directions of the hand with directions in A."""
        self._ik.AddOrientationConstraint(self._target, R_AQ, self._grasp, R_GQ, self._config.turn)

    def keep_level(self, R_GQ: RotationMatrix) -> None:
        """Align the z axis of Q, fixed in the hand, with that of A, and leave yaw free."""
        up = R_GQ.matrix()[:, 2]
        self._ik.AddAngleBetweenVectorsConstraint(self._grasp, up, self._target, [0, 0, 1], 0.0, UPRIGHT_ANGLE)

    def keep_clear(
        self, points: Iterable[FloatArray], radius: float, around: Iterable[Neighbour], height: float
    ) -> None:
        """Keep disks around points of the hand, at a height in W [m], out of the neighbors' largest inner circles."""
        for neighbour in around:
            distance = neighbour.radius + radius
            p_W = np.append(neighbour.X_WU.translation()[:2], height)
            for point in points:
                self._ik.AddPointToPointDistanceConstraint(self._grasp, point, self._world, p_W, distance, np.inf)

    def demand_clear(self, points: FloatArray, radius: float, around: Collection[Neighbour]) -> None:
        """Reject solutions unless disks around points of the hand, shape (m, 3), are outside all outlines."""

        def clear(q: FloatArray) -> bool:
            p_W = self._arm.forward(q).multiply(points.T).T
            return all(bool(np.all(neighbour.distance(p_W) >= radius)) for neighbour in around)

        self._clear = clear

    def solve(self, solver: SnoptSolver, rng: np.random.Generator) -> FloatArray | None:
        """Joint positions from a random start, shape (n,) [rad], or None when none are found."""
        spread = self._config.spread
        start = np.clip(
            self._comfort + rng.uniform(-spread, spread, len(self._comfort)), self._arm.lower, self._arm.upper
        )
        result = solver.Solve(self._ik.prog(), start)
        q = np.asarray(result.get_x_val())
        return q if result.is_success() and self._clear(q) else None
