"""Checks of how the joints and links of a robot are connected."""

from collections.abc import Iterator
from itertools import pairwise

from pydrake.multibody.tree import Joint, RevoluteJoint, RigidBody

from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.robots.bodies import RobotBodies, find_frame
from ictamp_drake.robots.model_files import read_mimics
from ictamp_drake.robots.robot import Robot


def check_joints(robot: Robot, bodies: RobotBodies) -> Iterator[IctampError]:
    """Yield the mistakes in how joints and links are connected, in a finalized plant."""
    wrong = list(_check_arm(robot, bodies))
    yield from wrong
    yield from _check_others(robot, bodies)
    if not wrong:
        yield from _check_hand(robot, bodies)
    yield from _check_masses(bodies)


def _check_arm(robot: Robot, bodies: RobotBodies) -> Iterator[IctampError]:
    flange = find_frame(bodies.plant, bodies.instances[0], robot.spec.flange, "flange").body()
    for number, joint in enumerate(bodies.arm_joints):
        field = f"joints[{number}]"
        if not isinstance(joint, RevoluteJoint):
            problem = "expected a joint that turns, got {value}, which slides"
            yield IctampError(Code.WRONG_TYPE, problem, field=field, value=joint.name())
        if flange not in _moved(bodies, joint):
            problem = "{value} does not move the flange"
            advice = "list the joints from the base to the flange only"
            yield IctampError(Code.CONFLICT, problem, field=field, value=joint.name(), advice=advice)
    for number, (one, other) in enumerate(pairwise(bodies.arm_joints)):
        if one.child_body() in _moved(bodies, other):
            problem = f"expected the order from the base to the flange, but {other.name()} comes before {{value}}"
            yield IctampError(Code.CONFLICT, problem, field=f"joints[{number}]", value=one.name())
    for joint in _joints(bodies):
        if joint not in bodies.arm_joints and flange in _moved(bodies, joint):
            problem = "the joint {value} between base and flange is missing"
            yield IctampError(Code.MISSING_FIELD, problem, field="joints", value=joint.name())


def _check_others(robot: Robot, bodies: RobotBodies) -> Iterator[IctampError]:
    """Yield joints that nothing moves, and links that are connected to nothing."""
    mimics = read_mimics(robot.gripper_model or robot.model)
    flange = find_frame(bodies.plant, bodies.instances[0], robot.spec.flange, "flange").body()
    names = {joint.name() for joint in bodies.finger_joints}
    for joint in _joints(bodies):
        if joint.num_positions() > 1:
            problem, advice = "{value} is connected to nothing", "connect it with a joint, in the model"
            name = joint.child_body().name()
            yield IctampError(Code.CONFLICT, problem, field="base", value=name, advice=advice)
        elif joint not in (*bodies.arm_joints, *bodies.driven) and flange not in _moved(bodies, joint):
            mimic = mimics.get(joint.name())
            if mimic is None or mimic.leader not in names:
                problem, advice = "nothing moves the joint {value}", "list it, or make it fixed or a mimic in the model"
                yield IctampError(Code.CONFLICT, problem, field="gripper.joints", value=joint.name(), advice=advice)


def _check_hand(robot: Robot, bodies: RobotBodies) -> Iterator[IctampError]:
    pads = robot.spec.gripper.pads
    for name, pad, finger in zip(("first", "second"), (pads.first, pads.second), bodies.fingers, strict=True):
        if finger not in bodies.moving:
            problem = "the joints of the gripper do not move {value}"
            yield IctampError(Code.CONFLICT, problem, field=f"gripper.pads.{name}", value=pad.frame)
    for field, name, body in (
        ("gripper.base", robot.spec.gripper.base, bodies.hand),
        ("gripper.grasp", robot.spec.gripper.grasp.frame, bodies.grasp.body()),
    ):
        if body in bodies.moving:
            problem = "expected a body that does not move with the fingers, got {value}"
            yield IctampError(Code.CONFLICT, problem, field=field, value=name)
        elif body not in bodies.turning:
            problem = "expected a body of the hand, got {value}, which the last joint does not move"
            yield IctampError(Code.CONFLICT, problem, field=field, value=name)


def _check_masses(bodies: RobotBodies) -> Iterator[IctampError]:
    """Yield joints that move nothing that has a mass: such a joint has no dynamics."""
    for joint in _joints(bodies):
        masses = [body.default_mass() for body in _moved(bodies, joint)]
        if not sum(masses) > 0:
            problem = "{value} has no mass, nor has anything that moves with it"
            field = "model" if joint.model_instance() == bodies.instances[0] else "gripper.model"
            advice = "give the link a mass and an inertia, in the model"
            yield IctampError(Code.OUT_OF_RANGE, problem, field=field, value=joint.child_body().name(), advice=advice)


def _joints(bodies: RobotBodies) -> list[Joint]:
    """Return all joints of the robot that move."""
    indices = [index for instance in bodies.instances for index in bodies.plant.GetJointIndices(instance)]
    return [joint for joint in map(bodies.plant.get_joint, indices) if joint.num_positions() > 0]


def _moved(bodies: RobotBodies, joint: Joint) -> list[RigidBody]:
    """Return the bodies that a joint moves."""
    return list(map(bodies.plant.get_body, bodies.plant.GetBodiesKinematicallyAffectedBy([joint.index()])))
