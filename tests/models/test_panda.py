"""The Panda agrees with the published numbers; its hand in simulated physics."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydrake.geometry import SceneGraph
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import (
    AddMultibodyPlantSceneGraph,
    DiscreteContactApproximation,
    MultibodyPlant,
)
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder

from ictamp_drake.models.package import add_package
from ictamp_drake.models.panda import ARM_JOINTS, ARM_LIMITS, FINGER_JOINTS, INERTIALS
from ictamp_drake.models.shapes import box_sdf
from tests.panda import HOME, MAX_GRIP_FORCE, MAX_OPENING

# Franka's documentation, "Denavit-Hartenberg parameters" (Craig's convention): a [m], d [m], alpha [rad].
PUBLISHED_DH = (
    (0.0, 0.333, 0.0),
    (0.0, 0.0, -math.pi / 2),
    (0.0, 0.316, math.pi / 2),
    (0.0825, 0.0, math.pi / 2),
    (-0.0825, 0.384, -math.pi / 2),
    (0.0, 0.0, math.pi / 2),
    (0.088, 0.0, math.pi / 2),
)
FLANGE = 0.107
# "Limits": position from and to [rad], then velocity, acceleration, jerk [rad/s, ...], torque [Nm].
PUBLISHED_LIMITS = (
    (-2.8973, 2.8973, 2.175, 15.0, 7500.0, 87.0),
    (-1.7628, 1.7628, 2.175, 7.5, 3750.0, 87.0),
    (-2.8973, 2.8973, 2.175, 10.0, 5000.0, 87.0),
    (-3.0718, -0.0698, 2.175, 12.5, 6250.0, 87.0),
    (-2.8973, 2.8973, 2.61, 15.0, 7500.0, 12.0),
    (-0.0175, 3.7525, 2.61, 20.0, 10000.0, 12.0),
    (-2.8973, 2.8973, 2.61, 20.0, 10000.0, 12.0),
)
BOX_WIDTH = 0.05


def add_panda(builder: DiagramBuilder, time_step: float) -> tuple[MultibodyPlant, SceneGraph]:
    plant, scene_graph = AddMultibodyPlantSceneGraph(builder, time_step)
    parser = Parser(plant)
    add_package(parser)
    parser.AddModelsFromUrl("package://ictamp_drake/sdf/panda.sdf")
    plant.WeldFrames(plant.world_frame(), plant.GetFrameByName("panda_link0"))
    return plant, scene_graph


@pytest.fixture(scope="module")
def plant() -> MultibodyPlant:
    plant, _ = add_panda(DiagramBuilder(), 0.0)
    plant.Finalize()
    return plant


def craig(a: float, d: float, alpha: float, theta: float) -> np.ndarray:
    turned = RigidTransform(RotationMatrix.MakeXRotation(alpha), [0, 0, 0]) @ RigidTransform([a, 0, 0])
    return (turned @ RigidTransform(RotationMatrix.MakeZRotation(theta), [0, 0, d])).GetAsMatrix4()


def fraction(low: float = 0.0, high: float = 1.0) -> st.SearchStrategy[list[float]]:
    return st.lists(st.floats(low, high), min_size=7, max_size=7)


@given(fractions=fraction())
def test_forward_kinematics_is_the_published_table(plant: MultibodyPlant, fractions: list[float]) -> None:
    lower = np.array([limit.lower for limit in ARM_LIMITS])
    upper = np.array([limit.upper for limit in ARM_LIMITS])
    q = lower + np.array(fractions) * (upper - lower)
    context = plant.CreateDefaultContext()
    plant.SetPositions(context, np.r_[q, 0.0, 0.0])
    X = np.eye(4)
    for i, (a, d, alpha) in enumerate(PUBLISHED_DH):
        X = X @ craig(a, d, alpha, q[i])
        frame = plant.GetFrameByName(f"panda_link{i + 1}")
        np.testing.assert_allclose(frame.CalcPoseInWorld(context).GetAsMatrix4(), X, atol=1e-9)
    X = X @ craig(0.0, FLANGE, 0.0, 0.0)
    flange = plant.GetFrameByName("panda_link8")
    np.testing.assert_allclose(flange.CalcPoseInWorld(context).GetAsMatrix4(), X, atol=1e-9)


def test_grasp_frame_is_between_the_pads(plant: MultibodyPlant) -> None:
    context = plant.CreateDefaultContext()
    X = plant.GetFrameByName("grasp").CalcPose(context, plant.GetFrameByName("panda_link8"))
    expected = RigidTransform(RotationMatrix.MakeZRotation(-math.pi / 4), [0.0, 0.0, 0.1034])
    assert X.IsNearlyEqualTo(expected, 1e-9)
    plant.SetPositions(context, np.r_[HOME, 0.02, 0.02])
    G = plant.GetFrameByName("grasp")
    for name, side in (("panda_leftfinger", 1.0), ("panda_rightfinger", -1.0)):
        p_G = plant.GetFrameByName(name).CalcPose(context, G).translation()
        np.testing.assert_allclose(p_G[:2], [0.0, 0.02 * side], atol=1e-9)


def test_home_points_down_in_front_of_the_base(plant: MultibodyPlant) -> None:
    context = plant.CreateDefaultContext()
    plant.SetPositions(context, np.r_[HOME, 0.0, 0.0])
    X_WG = plant.GetFrameByName("grasp").CalcPoseInWorld(context)
    np.testing.assert_allclose(X_WG.rotation().col(2), [0.0, 0.0, -1.0], atol=1e-6)
    assert X_WG.translation()[0] > 0.25


def test_limits_are_the_published_table() -> None:
    np.testing.assert_array_equal(np.array(ARM_LIMITS), PUBLISHED_LIMITS)


def test_limits_in_the_plant_are_the_constants(plant: MultibodyPlant) -> None:
    limits = np.array(ARM_LIMITS)
    np.testing.assert_allclose(plant.GetPositionLowerLimits()[:7], limits[:, 0])
    np.testing.assert_allclose(plant.GetPositionUpperLimits()[:7], limits[:, 1])
    np.testing.assert_allclose(plant.GetVelocityUpperLimits()[:7], limits[:, 2])
    np.testing.assert_allclose(plant.GetAccelerationUpperLimits()[:7], limits[:, 3])
    np.testing.assert_allclose(plant.GetEffortUpperLimits()[:7], limits[:, 5])
    np.testing.assert_allclose(plant.GetPositionUpperLimits()[7:], MAX_OPENING / 2)
    np.testing.assert_allclose(plant.GetEffortUpperLimits()[7:], MAX_GRIP_FORCE)
    names = [plant.get_joint_actuator(i).joint().name() for i in plant.GetJointActuatorIndices()]
    assert tuple(names) == ARM_JOINTS + FINGER_JOINTS


def test_masses_in_the_plant_are_the_constants(plant: MultibodyPlant) -> None:
    context = plant.CreateDefaultContext()
    for name, inertial in INERTIALS.items():
        M = plant.GetBodyByName(name).CalcSpatialInertiaInBodyFrame(context)
        assert M.get_mass() == pytest.approx(inertial.mass)
        np.testing.assert_allclose(M.get_com(), inertial.p_LLcm, atol=1e-12)
        moments = M.Shift(M.get_com()).CalcRotationalInertia().CopyToFullMatrix3()
        np.testing.assert_allclose(np.diag(moments), inertial.inertia[:3], rtol=1e-6)
        np.testing.assert_allclose(moments[[0, 0, 1], [1, 2, 2]], inertial.inertia[3:], atol=1e-9)


APPROXIMATIONS = (DiscreteContactApproximation.kSap, DiscreteContactApproximation.kLagged)


class Hand:
    """A hand on a locked arm that points down, with a free box between the open fingers."""

    def __init__(self, approximation: DiscreteContactApproximation, opening: float, gravity: float = 0.0) -> None:
        builder = DiagramBuilder()
        plant, _ = add_panda(builder, 0.002)
        plant.set_discrete_contact_approximation(approximation)
        sdf = box_sdf("box", (BOX_WIDTH, BOX_WIDTH, 0.06), 0.1, 1.0, (1.0, 0.0, 0.0))
        Parser(plant).AddModelsFromString(sdf, "sdf")
        plant.mutable_gravity_field().set_gravity_vector([0.0, 0.0, -gravity])
        plant.Finalize()
        self.plant = plant
        self.simulator = Simulator(builder.Build())
        self.context = plant.GetMyMutableContextFromRoot(self.simulator.get_mutable_context())
        for joint, angle in zip(ARM_JOINTS, HOME, strict=True):
            plant.GetJointByName(joint).set_angle(self.context, angle)
            plant.GetJointByName(joint).Lock(self.context)
        for joint in FINGER_JOINTS:
            plant.GetJointByName(joint).set_translation(self.context, opening / 2)
        X_WG = plant.GetFrameByName("grasp").CalcPoseInWorld(self.context)
        plant.SetFreeBodyPose(self.context, plant.GetBodyByName("box"), X_WG)

    def push(self, force: float, seconds: float) -> np.ndarray:
        """Finger positions after a force [N] pushed both fingers outwards for some time."""
        self.plant.get_actuation_input_port().FixValue(self.context, np.r_[np.zeros(7), force, force])
        self.simulator.AdvanceTo(self.simulator.get_context().get_time() + seconds)
        panda = self.plant.GetModelInstanceByName("panda")
        return np.asarray(self.plant.GetPositions(self.context, panda)[7:])

    def box_height(self) -> float:
        return float(self.plant.GetBodyByName("box").EvalPoseInWorld(self.context).translation()[2])


@pytest.mark.parametrize("approximation", APPROXIMATIONS)
def test_hand_opens_to_its_full_width(approximation: DiscreteContactApproximation) -> None:
    fingers = Hand(approximation, opening=0.06).push(5.0, 0.2)
    np.testing.assert_allclose(2.0 * fingers, MAX_OPENING, atol=1e-4)


@pytest.mark.parametrize("approximation", APPROXIMATIONS)
def test_hand_closes_on_a_box_and_stops_at_its_surface(approximation: DiscreteContactApproximation) -> None:
    fingers = Hand(approximation, opening=0.07).push(-40.0, 0.3)
    assert abs(fingers[0] - fingers[1]) < 1e-4
    np.testing.assert_allclose(fingers, BOX_WIDTH / 2, atol=5e-4)


@pytest.mark.parametrize("approximation", APPROXIMATIONS)
def test_a_gripped_box_is_held_against_gravity(approximation: DiscreteContactApproximation) -> None:
    hand = Hand(approximation, opening=BOX_WIDTH, gravity=9.81)
    start = hand.box_height()
    hand.push(-30.0, 1.0)
    assert abs(hand.box_height() - start) < 1e-4
    hand.push(5.0, 0.2)
    assert hand.box_height() < start - 0.05


def test_fingers_move_together_when_only_one_is_driven() -> None:
    builder = DiagramBuilder()
    plant, _ = add_panda(builder, 0.002)
    plant.mutable_gravity_field().set_gravity_vector([0.0, 0.0, 0.0])
    plant.Finalize()
    simulator = Simulator(builder.Build())
    context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    plant.get_actuation_input_port().FixValue(context, np.r_[np.zeros(7), 1.0, 0.0])
    simulator.AdvanceTo(0.1)
    fingers = plant.GetPositions(context)[7:]
    assert fingers[0] > 0.005
    assert abs(fingers[0] - fingers[1]) < 1e-4
