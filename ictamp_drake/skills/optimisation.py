"""k from a mathematical program over the arm's joints: reachable, clear of the neighbours, centred and stable.

k is a function of the joint positions q by forward kinematics, so the program's variables are q alone and all its
constraints and costs on k are constraints and costs on the pose of G. Random modes, aims and starts make it a sampler.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.inverse_kinematics import InverseKinematics
from pydrake.solvers import SnoptSolver

from ictamp_drake.core.types import Action, Configuration, FloatArray, Parameter
from ictamp_drake.motion.inverse_kinematics import ArmKinematics
from ictamp_drake.skills.geometry import (
    R_DOWN,
    grasp_parameter,
    held_bottom,
    placement_parameter,
)
from ictamp_drake.skills.neighbours import Neighbour, free_spot, neighbours
from ictamp_drake.world.poses import to_transform
from ictamp_drake.world.world import World

FINGERS = ([0.0, 0.0, 0.0], [0.0, 0.052, 0.0], [0.0, -0.052, 0.0])
"""Middle of the hand's opening and of the open fingers in G [m]."""


@dataclass(frozen=True)
class OptimisationConfig:
    """How programs are posed.

    Attributes:
        restarts: programs tried for one k.
        max_width: widest side that is gripped [m].
        depth: least and greatest distance of G below the box's top [m].
        ground: least distance of G above the box's bottom [m].
        grip_offset: greatest distance of G from the box's middle along the fingers' direction and across it [m].
        turn: greatest deviation of yaw from the faces' directions [rad].
        height: least and greatest height of a placement above the top face [m].
        overhang: greatest distance of a box's centre from that of the box below [m].
        clearance: distance kept from the neighbours' outlines [m].
        aims: random spots compared for a placement on a support; the one with most room is aimed at.
        room: distance from which on more room is worth nothing [m].
        centring: cost of the distance from the aim [1/m^2].
        comfort: cost of the distance from the comfortable posture [1/rad^2].
        spread: of the random starts about the comfortable posture [rad].
    """

    restarts: int = 6
    max_width: float = 0.075
    depth: tuple[float, float] = (0.012, 0.034)
    ground: float = 0.014
    grip_offset: tuple[float, float] = (0.001, 0.008)
    turn: float = 0.02
    height: tuple[float, float] = (0.001, 0.002)
    overhang: float = 0.004
    clearance: float = 0.015
    aims: int = 12
    room: float = 0.08
    centring: float = 1000.0
    comfort: float = 0.1
    spread: float = 0.3

    def create(self, world: World, arm: ArmKinematics) -> "OptimisationSampler":
        """The sampler for one scene."""
        return OptimisationSampler(world, arm, self)


class OptimisationSampler:
    """Draws k by solving randomly restarted programs with SNOPT."""

    def __init__(self, world: World, arm: ArmKinematics, config: OptimisationConfig) -> None:
        self._world = world
        self._arm = arm
        self._config = config
        self._context = arm.plant.CreateDefaultContext()
        self._grasp = arm.plant.GetFrameByName("grasp")
        self._target = arm.plant.GetFrameByName("target")
        self._solver = SnoptSolver()

    def sample(self, c: Configuration, action: Action, rng: np.random.Generator) -> Parameter | None:
        """One k, or None when no program had a solution."""
        box, other = action.args
        programs = self._picks(c, box, rng) if action.name == "pick" else self._places(c, box, other, rng)
        for program, X_WA in programs:
            q = self._solve(program, X_WA, rng)
            if q is not None:
                return self._parameter(c, action, self._arm.forward(q))
        return None

    def _parameter(self, c: Configuration, action: Action, X_WG: RigidTransform) -> Parameter:
        if action.name == "pick":
            return grasp_parameter(self._world, c, action.args[0], X_WG)
        X_GB = held_bottom(self._world, c, action.args[0], self._arm.forward(c.q[:7]))
        return placement_parameter(self._world, c, action.args[1], X_GB, X_WG)

    def _picks(
        self, c: Configuration, box: str, rng: np.random.Generator
    ) -> Iterator[tuple[InverseKinematics, RigidTransform]]:
        """Grasps with the fingers along one of the box's faces, G near its middle and not too deep."""
        config = self._config
        lying = self._world.upright(c, box)
        half = lying.size / 2
        quarters = [m for m in range(4) if lying.size[1 - m % 2] <= config.max_width]
        low, high = max(half[2] - config.depth[1], config.ground - half[2]), half[2] - config.depth[0]
        for _ in range(config.restarts if quarters else 0):
            R_UM = RotationMatrix.MakeZRotation(rng.choice(quarters) * np.pi / 2)
            X_WM = lying.X_WU @ RigidTransform(R_UM, [0.0, 0.0, 0.0])
            program = self._program(X_WM)
            across, along = config.grip_offset[1], config.grip_offset[0]
            bound = np.array([across, along, 0.0])
            program.AddPositionConstraint(
                self._grasp, [0, 0, 0], self._target, [*-bound[:2], min(low, high)], [*bound[:2], max(low, high)]
            )
            program.AddOrientationConstraint(self._target, R_DOWN, self._grasp, RotationMatrix(), config.turn)
            aim = np.append(rng.uniform(-bound[:2], bound[:2]), rng.uniform(min(low, high), max(low, high)))
            self._add_aim(program, aim, [0.0, 0.0, 0.0])
            p_WG = X_WM @ aim
            self._add_clearance(program, FINGERS[1:], neighbours(self._world, c, {box}, p_WG[2] - 0.02), p_WG[2])
            yield program, X_WM

    def _places(
        self, c: Configuration, box: str, receptacle: str, rng: np.random.Generator
    ) -> Iterator[tuple[InverseKinematics, RigidTransform]]:
        """Placements just above the top face: inside a support's face where there is room, centred on a box."""
        config = self._config
        X_GB = held_bottom(self._world, c, box, self._arm.forward(c.q[:7]))
        X_WT = self._world.X_WT(c, receptacle)
        around = neighbours(self._world, c, {box, receptacle}, X_WT.translation()[2])
        radius = float(np.linalg.norm(self._world.upright(c, box).size[:2])) / 2
        on_box = receptacle in self._world.spec.boxes
        for _ in range(config.restarts):
            bound = np.full(2, config.overhang) if on_box else self._world.top_size(c, receptacle) / 2 - radius
            if on_box:
                aim = rng.uniform(-bound, bound)
            else:
                spot = free_spot(
                    self._reachable(X_WT, bound, rng), X_WT, around, radius + config.clearance, config.room
                )
                if spot is None:
                    continue
                aim = spot
            program = self._program(X_WT)
            program.AddPositionConstraint(
                self._grasp, X_GB.translation(), self._target, [*-bound, config.height[0]], [*bound, config.height[1]]
            )
            if on_box:
                R_TB = RotationMatrix.MakeZRotation(rng.integers(4) * np.pi / 2)
                program.AddOrientationConstraint(self._target, R_TB, self._grasp, X_GB.rotation(), config.turn)
            else:
                up = X_GB.rotation().matrix()[:, 2]
                program.AddAngleBetweenVectorsConstraint(self._grasp, up, self._target, [0, 0, 1], 0.0, 1e-3)
            self._add_aim(program, np.append(aim, np.mean(config.height)), X_GB.translation())
            height = (X_WT @ np.append(aim, 0.0))[2]
            self._add_clearance(program, [X_GB.translation()], around, height, radius)
            yield program, X_WT @ RigidTransform(np.append(aim, 0.0))

    def _reachable(self, X_WT: RigidTransform, bound: FloatArray, rng: np.random.Generator) -> FloatArray:
        """Random spots on a top face that the arm's length allows, in T, shape (m, 2)."""
        spots = rng.uniform(-bound, bound, (self._config.aims * 4, 2))
        X_TB = X_WT.inverse() @ to_transform(self._world.spec.arm.X_WB)
        distance = np.linalg.norm(spots - X_TB.translation()[:2], axis=1)
        return spots[(distance > 0.3) & (distance < 0.75)][: self._config.aims]

    def _program(self, X_WA: RigidTransform) -> InverseKinematics:
        self._target.SetPoseInParentFrame(self._context, X_WA)
        program = InverseKinematics(self._arm.plant, self._context, with_joint_limits=False)
        program.prog().AddBoundingBoxConstraint(self._arm.lower, self._arm.upper, program.q())
        return program

    def _add_aim(self, program: InverseKinematics, p_AQ: FloatArray, p_GQ: FloatArray | list[float]) -> None:
        weight = self._config.centring * np.eye(3)
        program.AddPositionCost(self._target, p_AQ, self._grasp, p_GQ, weight)

    def _add_clearance(
        self,
        program: InverseKinematics,
        points: list[list[float]] | tuple[list[float], ...] | list[FloatArray],
        around: list[Neighbour],
        height: float,
        radius: float = 0.011,
    ) -> None:
        """Keep points of the hand, discs of `radius` at `height`, away from the neighbours' outlines."""
        world = self._arm.plant.world_frame()
        for neighbour in around:
            distance = neighbour.radius + radius + self._config.clearance / 2
            p_W = np.append(neighbour.X_WU.translation()[:2], height)
            for point in points:
                program.AddPointToPointDistanceConstraint(self._grasp, point, world, p_W, distance, 10.0)

    def _solve(self, program: InverseKinematics, X_WA: RigidTransform, rng: np.random.Generator) -> FloatArray | None:
        comfort = self._arm.comfortable(X_WA)
        program.prog().AddQuadraticErrorCost(self._config.comfort * np.eye(7), comfort, program.q())
        spread = self._config.spread
        start = np.clip(comfort + rng.uniform(-spread, spread, 7), self._arm.lower, self._arm.upper)
        result = self._solver.Solve(program.prog(), start)
        return np.asarray(result.get_x_val()) if result.is_success() else None
