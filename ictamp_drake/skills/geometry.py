"""Conversions between k and the pose of the hand that grasps or places an object with it."""

import numpy as np
from pydrake.math import RigidTransform, RollPitchYaw, RotationMatrix

from ictamp_drake.core.types import Action, Configuration, FloatArray, Parameter
from ictamp_drake.robots.gripper import Gripper
from ictamp_drake.world.matrices import grasps, level
from ictamp_drake.world.poses import to_transform
from ictamp_drake.world.world import World

R_DOWN = RotationMatrix.MakeXRotation(np.pi)
"""Orientation of a hand that points down: G's x along the reference, y (the fingers' direction) against it, z down."""


def grasp_pose(world: World, c: Configuration, box: str, k: Parameter) -> RigidTransform:
    """X_WG of the grasp k = (x, y, z, yaw) of the pads in the box's upright frame U, once they have closed."""
    pads = pads_in_hand(world.robot.gripper, grip_width(world, c, box, k[3]))
    return world.upright_frame(c, box).X_WU @ grasp_in_box(k) @ pads.inverse()


def pads_in_hand(gripper: Gripper, width: float) -> RigidTransform:
    """X_GP of the frame P between the pads: as G, but in their middle, which travels along z as a linkage closes."""
    return RigidTransform([0.0, 0.0, gripper.rise(width)])


def grasp_in_box(k: Parameter) -> RigidTransform:
    """X_UG of the grasp k = (x, y, z, yaw) in the box's upright frame U."""
    return level_pose(k) @ RigidTransform(R_DOWN, np.zeros(3))


def grasp_parameter(world: World, c: Configuration, box: str, X_WG: RigidTransform) -> Parameter:
    """k of a hand pose, the inverse of `grasp_pose` for hands that point down."""
    X_UG = world.upright_frame(c, box).X_WU.inverse() @ X_WG
    yaw = yaw_of(X_UG.rotation() @ R_DOWN.inverse())
    X_UP = X_UG @ pads_in_hand(world.robot.gripper, grip_width(world, c, box, yaw))
    return np.append(X_UP.translation(), yaw)


def squared_grasp(k: Parameter) -> RigidTransform:
    """X_GU after the fingers have closed with k: they center the box between them and turn it square to them."""
    R_UG = RotationMatrix.MakeZRotation(round(k[3] / (np.pi / 2)) * np.pi / 2) @ R_DOWN
    p_GU = grasp_in_box(k).inverse().translation()
    return RigidTransform(R_UG.inverse(), [p_GU[0], 0.0, p_GU[2]])


def held_bottom(world: World, c: Configuration, box: str, X_WG: RigidTransform) -> RigidTransform:
    """X_GB of the held box's bottom frame B: centered in the bottom face, parallel to the box's upright frame U."""
    lying = world.upright_frame(c, box)
    return X_WG.inverse() @ lying.X_WU @ RigidTransform([0.0, 0.0, -lying.size[2] / 2])


def placement_pose(
    world: World, c: Configuration, receptacle: str, X_GB: RigidTransform, k: Parameter
) -> RigidTransform:
    """X_WG at which the held box's bottom frame B is at k = (x, y, z, yaw) in the receptacle's frame T."""
    return world.X_WT(c, receptacle) @ level_pose(k) @ X_GB.inverse()


def level_pose(k: Parameter) -> RigidTransform:
    """X_TB of the held box's bottom frame B placed with k = (x, y, z, yaw) in the receptacle's frame T."""
    return RigidTransform(level(k[None])[0])


def placement_parameter(
    world: World, c: Configuration, receptacle: str, X_GB: RigidTransform, X_WG: RigidTransform
) -> Parameter:
    """k of a hand pose, the inverse of `placement_pose` for boxes held level."""
    X_TB = world.X_WT(c, receptacle).inverse() @ X_WG @ X_GB
    return np.append(X_TB.translation(), yaw_of(X_TB.rotation()))


def hand_poses(world: World, c: Configuration, action: Action, k: FloatArray, X_WG: RigidTransform) -> FloatArray:
    """`grasp_pose` or `placement_pose` of many parameters, (n, 4) -> (n, 4, 4), with the hand of c at X_WG."""
    box, place = action.args
    if action.name == "pick":
        grasped: FloatArray = world.upright_frame(c, box).X_WU.GetAsMatrix4() @ grasps(k)
        gripper = world.robot.gripper
        if gripper.rises.any():
            rises = np.array([gripper.rise(grip_width(world, c, box, yaw)) for yaw in k[:, 3]])
            grasped[:, :3, 3] -= grasped[:, :3, 2] * rises[:, None]
        return grasped
    X_GB = held_bottom(world, c, box, X_WG)
    return world.X_WT(c, place).GetAsMatrix4() @ level(k) @ X_GB.inverse().GetAsMatrix4()


def yaw_of(R: RotationMatrix) -> float:
    """Angle about z [rad]."""
    return float(RollPitchYaw(R).yaw_angle())


def grip_width(world: World, c: Configuration, box: str, yaw: float) -> float:
    """Length of the box's side along the fingers' direction [m]; for a skewed grasp, of the side nearest to it."""
    size = world.upright_frame(c, box).size
    return float(size[1] if abs(np.cos(yaw)) >= abs(np.sin(yaw)) else size[0])


def needed_opening(world: World, c: Configuration, box: str, X_WG: RigidTransform) -> float:
    """Distance of the fingers at which both just miss the box [m]; the hand at X_WG may be skewed and off-center."""
    X_GO = X_WG.inverse() @ to_transform(c.poses[box])
    half = float(np.abs(X_GO.rotation().matrix()[1]) @ world.sizes[box]) / 2
    return 2 * (half + abs(float(X_GO.translation()[1])))


def raise_pose(X_WG: RigidTransform, rise: float) -> RigidTransform:
    """X_WG moved up by `rise` [m]."""
    return RigidTransform(X_WG.rotation(), X_WG.translation() + [0.0, 0.0, rise])
