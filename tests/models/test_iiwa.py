"""The iiwa agrees with the published numbers; the gripper closes."""

import math
import os

import numpy as np
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st
from pydrake.math import RigidTransform, RollPitchYaw, RotationMatrix
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph, MultibodyPlant
from pydrake.multibody.tree import MultibodyForces
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder

from ictamp_drake.core.types import FloatArray
from ictamp_drake.models.package import PACKAGE_FILE, add_package
from ictamp_drake.models.shapes import box_sdf
from tools.iiwa import wsg
from tools.iiwa.self_collision import ignored_pairs, robot_probe

SPEC = yaml.safe_load((PACKAGE_FILE.parent / "robots" / "iiwa14_wsg50.yaml").read_text())
FLANGE = "iiwa_link_7"
# KUKA's brochure "Sensitive robotics: LBR iiwa", LBR iiwa 14 R820: range to both sides [deg], speed [deg/s], torque
# [Nm].
PUBLISHED_LIMITS = (
    (170, 85, 320),
    (120, 85, 320),
    (170, 100, 176),
    (120, 75, 176),
    (170, 130, 110),
    (120, 135, 40),
    (175, 135, 40),
)
WEIGHT = 29.9
# Distances from the floor to the shoulder, then to elbow, wrist and flange [m].
SHOULDER, UPPER_ARM, FOREARM, HAND = 0.36, 0.42, 0.4, 0.126
JOINTS = [f"iiwa_joint_{number}" for number in range(1, 8)]


def add_robot(plant: MultibodyPlant) -> None:
    """Add arm and gripper as the robot file says."""
    parser = Parser(plant)
    add_package(parser)
    parser.AddModelsFromUrl(SPEC["model"])
    parser.AddModelsFromUrl(SPEC["gripper"]["model"])
    mount = SPEC["gripper"]["mount"]
    X_FH = RigidTransform(RollPitchYaw(np.deg2rad(mount["rotation"])), mount["position"])
    plant.WeldFrames(plant.world_frame(), plant.GetFrameByName(SPEC["base"]))
    plant.WeldFrames(plant.GetFrameByName(SPEC["flange"]), plant.GetFrameByName(mount["frame"]), X_FH)


@pytest.fixture(scope="module")
def plant() -> MultibodyPlant:
    plant = MultibodyPlant(0.0)
    add_robot(plant)
    plant.Finalize()
    return plant


@pytest.fixture(scope="module")
def drake_plant() -> MultibodyPlant:
    """Drake's own model of the arm. The test is skipped unless the variable DRAKE_MODELS names the folder with it."""
    folder = os.environ.get("DRAKE_MODELS")
    if folder is None:
        pytest.skip("DRAKE_MODELS is not set")
    plant = MultibodyPlant(0.0)
    parser = Parser(plant)
    parser.package_map().Remove("drake_models")
    parser.package_map().Add("drake_models", folder)
    parser.AddModelsFromUrl("package://drake_models/iiwa_description/urdf/iiwa14_primitive_collision.urdf")
    plant.WeldFrames(plant.world_frame(), plant.GetFrameByName("base"))
    plant.Finalize()
    return plant


def pose_of(plant: MultibodyPlant, q: FloatArray, frame: str) -> RigidTransform:
    """Pose of a frame in the base's frame."""
    context = plant.CreateDefaultContext()
    for name, angle in zip(JOINTS, q, strict=True):
        plant.GetJointByName(name).set_angle(context, angle)
    return plant.GetFrameByName(frame).CalcPoseInWorld(context)


def published_flange(q: FloatArray) -> RigidTransform:
    """Pose of the flange by the published lengths: shoulder, elbow and wrist are each two crossing axes."""
    about_z, about_y = RotationMatrix.MakeZRotation, RotationMatrix.MakeYRotation
    X = RigidTransform([0.0, 0.0, SHOULDER])
    for roll, pitch, length in ((q[0], q[1], UPPER_ARM), (q[2], -q[3], FOREARM), (q[4], q[5], HAND)):
        X = X @ RigidTransform(about_z(roll) @ about_y(pitch), [0, 0, 0]) @ RigidTransform([0.0, 0.0, length])
    return X @ RigidTransform(about_z(q[6]), [0, 0, 0])


def test_limits_are_the_published_table(plant: MultibodyPlant) -> None:
    reach, speed, torque = np.array(PUBLISHED_LIMITS).T
    np.testing.assert_allclose(plant.GetPositionUpperLimits()[:7], np.deg2rad(reach))
    np.testing.assert_allclose(plant.GetPositionLowerLimits()[:7], -np.deg2rad(reach))
    np.testing.assert_allclose(plant.GetVelocityUpperLimits()[:7], np.deg2rad(speed))
    np.testing.assert_allclose(plant.GetEffortUpperLimits()[:7], torque)


def test_limits_of_the_gripper_are_those_of_its_catalog(plant: MultibodyPlant) -> None:
    np.testing.assert_allclose(plant.GetPositionLowerLimits()[7:], 0.0)
    np.testing.assert_allclose(plant.GetPositionUpperLimits()[7:], 0.055)
    np.testing.assert_allclose(plant.GetVelocityUpperLimits()[7:], 0.42)
    np.testing.assert_allclose(plant.GetEffortUpperLimits()[7:], 80.0)


def test_every_joint_has_an_actuator(plant: MultibodyPlant) -> None:
    names = [plant.get_joint_actuator(index).joint().name() for index in plant.GetJointActuatorIndices()]
    assert names == [*JOINTS, *wsg.JOINTS]


def test_the_arm_weighs_as_much_as_published(plant: MultibodyPlant) -> None:
    instance = plant.GetModelInstanceByName("iiwa14")
    assert plant.CalcTotalMass(plant.CreateDefaultContext(), [instance]) == pytest.approx(WEIGHT)


@pytest.mark.parametrize(
    ("degrees", "position"),
    [
        ((0, 0, 0, 0, 0, 0, 0), (0.0, 0.0, 1.306)),
        ((0, 90, 0, 0, 0, 0, 0), (0.946, 0.0, 0.36)),
        ((90, 90, 0, 0, 0, 0, 0), (0.0, 0.946, 0.36)),
        ((0, 0, 0, -90, 0, 90, 0), (0.4, 0.0, 0.654)),
        ((0, 0, 90, 90, 0, 0, 0), (0.0, -0.526, 0.78)),
        ((0, 0, 0, 0, 90, 90, 30), (0.0, 0.126, 1.18)),
    ],
)
def test_the_flange_is_where_the_published_lengths_put_it(
    plant: MultibodyPlant, degrees: tuple[float, ...], position: tuple[float, ...]
) -> None:
    np.testing.assert_allclose(pose_of(plant, np.deg2rad(degrees), FLANGE).translation(), position, atol=1e-9)


postures = st.lists(st.floats(-2.0, 2.0), min_size=7, max_size=7).map(np.array)


@given(q=postures)
def test_forward_kinematics_is_that_of_the_published_lengths(plant: MultibodyPlant, q: FloatArray) -> None:
    assert pose_of(plant, q, FLANGE).IsNearlyEqualTo(published_flange(q), 1e-9)


@given(q=postures)
def test_forward_kinematics_is_that_of_drakes_model(
    plant: MultibodyPlant, drake_plant: MultibodyPlant, q: FloatArray
) -> None:
    ours = pose_of(plant, q, FLANGE)
    theirs = pose_of(drake_plant, q, FLANGE) @ RigidTransform([0.0, 0.0, 0.045])
    assert ours.IsNearlyEqualTo(theirs, 1e-6)


def test_home_points_down_in_front_of_the_base(plant: MultibodyPlant) -> None:
    X_WG = pose_of(plant, np.array(SPEC["home"]), "grasp")
    np.testing.assert_allclose(X_WG.rotation().matrix(), np.diag([1.0, -1.0, -1.0]), atol=1e-9)
    assert X_WG.translation()[0] > 0.4


def test_home_is_far_from_all_limits(plant: MultibodyPlant) -> None:
    assert np.all(np.abs(SPEC["home"]) < plant.GetPositionUpperLimits()[:7] - math.radians(25))


def test_accelerations_need_less_than_the_torques(plant: MultibodyPlant) -> None:
    rng, context = np.random.default_rng(0), plant.CreateDefaultContext()
    upper, speed = plant.GetPositionUpperLimits(), plant.GetVelocityUpperLimits()
    for _ in range(200):
        plant.SetPositions(context, np.r_[rng.uniform(-upper[:7], upper[:7]), 0.0, 0.0])
        plant.SetVelocities(context, np.r_[rng.uniform(-speed[:7], speed[:7]), 0.0, 0.0])
        forces = MultibodyForces(plant)
        plant.CalcForceElementsContribution(context, forces)
        acceleration = np.array(SPEC["acceleration"]) * rng.choice([-1, 1], 7)
        torques = plant.CalcInverseDynamics(context, np.r_[acceleration, 0.0, 0.0], forces)
        assert np.all(np.abs(torques[:7]) < plant.GetEffortUpperLimits()[:7])


def test_pads_face_each_other_across_g(plant: MultibodyPlant) -> None:
    context = plant.CreateDefaultContext()
    plant.GetJointByName(wsg.JOINTS[0]).set_translation(context, 0.03)
    plant.GetJointByName(wsg.JOINTS[1]).set_translation(context, 0.03)
    G, pads = plant.GetFrameByName("grasp"), SPEC["gripper"]["pads"]
    for pad, side in ((pads["first"], 1.0), (pads["second"], -1.0)):
        X_GP = plant.GetFrameByName(pad["frame"]).CalcPose(context, G) @ RigidTransform(pad["position"])
        np.testing.assert_allclose(X_GP.translation(), [0.0, 0.03 * side, 0.0], atol=1e-9)
        np.testing.assert_allclose(X_GP.rotation().col(1), [0.0, side, 0.0], atol=1e-9)


def test_the_arm_at_home_touches_nothing() -> None:
    probe = robot_probe(ignored_pairs())
    for finger in (0.0, 0.03, 0.055):
        assert not probe.touching_pairs(np.r_[SPEC["home"], finger, finger])


def test_an_arm_folded_into_its_base_touches_it() -> None:
    folded = np.deg2rad([0, 115, 0, -118, 0, 60, 45])
    assert robot_probe(ignored_pairs()).touching_pairs(np.r_[folded, 0.0, 0.0])


def test_the_robot_file_lists_the_pairs_of_arm_and_gripper_that_never_touch() -> None:
    across = {pair for pair in ignored_pairs() if pair[0].startswith("iiwa") and pair[1].startswith("wsg")}
    assert {(first, second) for first, second in SPEC["touching"]} == across


def close(box: float | None) -> FloatArray:
    """Positions of the fingers after they were pressed together with 40 N, around a free box of this width or none."""
    builder = DiagramBuilder()
    plant, _ = AddMultibodyPlantSceneGraph(builder, 0.002)
    add_robot(plant)
    if box:
        Parser(plant).AddModelsFromString(box_sdf("box", (0.05, box, 0.06), 0.1, 1.0, (1.0, 0.0, 0.0)), "sdf")
    plant.mutable_gravity_field().set_gravity_vector([0.0, 0.0, 0.0])
    plant.Finalize()
    simulator = Simulator(builder.Build())
    context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    for name, angle in zip(JOINTS, SPEC["home"], strict=True):
        plant.GetJointByName(name).set_angle(context, angle)
        plant.GetJointByName(name).Lock(context)
    for name in wsg.JOINTS:
        plant.GetJointByName(name).set_translation(context, 0.05)
    if box:
        X_WG = plant.GetFrameByName("grasp").CalcPoseInWorld(context)
        plant.SetFreeBodyPose(context, plant.GetBodyByName("box"), X_WG)
    plant.get_actuation_input_port().FixValue(context, np.r_[np.zeros(7), -40.0, -40.0])
    simulator.AdvanceTo(0.3)
    return np.array([plant.GetJointByName(name).get_translation(context) for name in wsg.JOINTS])


def test_the_hand_closes() -> None:
    np.testing.assert_allclose(close(None), 0.0, atol=5e-4)


def test_the_hand_closes_on_a_box_and_stops_at_its_surface() -> None:
    np.testing.assert_allclose(close(0.06), 0.03, atol=5e-4)
