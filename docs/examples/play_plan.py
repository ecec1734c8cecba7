"""Your own plan played in a diagram: `python docs/examples/play_plan.py`."""

from pathlib import Path

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import PdControllerGains, RevoluteJoint, SpatialInertia
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder
from pydrake.systems.primitives import LogVectorOutput

import ictamp_drake as ict


def my_robot() -> MultibodyPlant:
    """Seven flywheels, which stand for the joints of your robot. Their controllers follow a desired state."""
    plant = MultibodyPlant(time_step=0.002)
    for number in range(7):
        wheel = plant.AddRigidBody(f"wheel_{number}", SpatialInertia.SolidSphereWithMass(1.0, 0.1))
        frames = plant.world_frame(), wheel.body_frame()
        joint = plant.AddJoint(RevoluteJoint(f"joint_{number}", *frames, np.array([0.0, 0.0, 1.0])))
        actuator = plant.AddJointActuator(f"motor_{number}", joint)
        actuator.set_controller_gains(PdControllerGains(p=400.0, d=4.0))
    plant.Finalize()
    return plant


def main() -> None:
    task = ict.load(Path(__file__).with_name("own_scene.yaml"))
    plan = ict.solve(task, seed=1, time_limit=250).plan
    assert plan is not None

    builder = DiagramBuilder()
    player = builder.AddSystem(plan.system())
    robot = builder.AddSystem(my_robot())
    arm = robot.GetBodyByName("wheel_0").model_instance()
    builder.Connect(player.GetOutputPort("desired_state"), robot.get_desired_state_input_port(arm))
    hand = LogVectorOutput(player.GetOutputPort("gripper_command"), builder, 0.01)  # in place of your hand
    simulator = Simulator(builder.Build())
    context = simulator.get_mutable_context()
    robot.SetPositions(robot.GetMyMutableContextFromRoot(context), plan.c.commanded)

    end = 0.0
    expected = player.GetOutputPort("expected_atoms")
    for attempt in plan.attempts:
        end += attempt.duration
        simulator.AdvanceTo(end)
        atoms = expected.Eval(player.GetMyContextFromRoot(context))
        print(f"{end:5.1f} s  {attempt.action}:", *sorted(map(str, atoms)))
    assert task.goal.holds(atoms)

    q = robot.GetPositions(robot.GetMyContextFromRoot(context))
    assert np.abs(q - plan.trajectory().value(plan.duration)[:, 0]).max() < 0.01, "the robot followed the plan"
    forces = hand.FindLog(context).data()[1]
    assert forces.max() > 0 == forces[-1], "the hand gripped and let go"


if __name__ == "__main__":
    main()
