"""A plan as a system that plays it in the user's own Drake diagram."""

from bisect import bisect_right
from itertools import accumulate

import numpy as np
from pydrake.common.value import Value
from pydrake.systems.framework import BasicVector, Context, LeafSystem

from ictamp_drake.robots.robot import find_robot
from ictamp_drake.tamp.expected import expected_states
from ictamp_drake.tamp.plan import Plan
from ictamp_drake.world.commands import arm_trajectory, gripper_schedule
from ictamp_drake.world.world import World


class PlanSystem(LeafSystem):
    """A source without inputs and state, whose outputs depend on the time of the context alone.

    Output ports:
        desired_state: Positions of the arm's joints [rad], then their velocities [rad/s], shape (2 joints,). The arm
            stands still after the end of the plan.
        gripper_command: Distance between the finger pads to move to [m] and grip force of each finger beyond it [N],
            shape (2,). A command is in force until the next; the hand moves each finger at its speed.
        expected_atoms: Atoms of H that should hold since the end of the last step that is over, a frozenset of `Atom`.
    """

    def __init__(self, plan: Plan) -> None:
        """Work out the outputs of a plan.

        Raises:
            IctampError: An action of the plan is not applicable after those before it.
        """
        LeafSystem.__init__(self)
        segments = [segment for attempt in plan.attempts for segment in attempt.motion]
        speed, joints = find_robot(plan.spec.robot).gripper.speed, len(plan.c.q)
        self._end = plan.duration
        self._start = plan.c.commanded
        self._trajectory = arm_trajectory(segments) if segments else None
        self._starts, self._commands = zip(*gripper_schedule(plan.c.gripper, segments, speed), strict=True)
        self._ends = list(accumulate(attempt.duration for attempt in plan.attempts))
        self._states = expected_states(World(plan.spec), plan.c, plan.actions)
        time = {self.time_ticket()}
        self.DeclareVectorOutputPort("desired_state", 2 * joints, self._set_desired_state, time)
        self.DeclareVectorOutputPort("gripper_command", 2, self._set_gripper_command, time)
        self.DeclareAbstractOutputPort("expected_atoms", lambda: Value(self._states[0]), self._set_expected_atoms, time)

    def _set_desired_state(self, context: Context, output: BasicVector) -> None:
        time = context.get_time()
        q, v = self._start, np.zeros(len(self._start))
        if self._trajectory is not None:
            within = min(max(time, 0.0), self._trajectory.end_time())
            q = self._trajectory.value(within)[:, 0]
            if time == within:
                v = self._trajectory.EvalDerivative(within, 1)[:, 0]
        output.SetFromVector(np.concatenate([q, v]))

    def _set_gripper_command(self, context: Context, output: BasicVector) -> None:
        command = self._commands[max(0, bisect_right(self._starts, context.get_time() + _INSTANT) - 1)]
        output.SetFromVector([command.width, command.force])

    def _set_expected_atoms(self, context: Context, output: Value) -> None:
        output.set_value(self._states[bisect_right(self._ends, context.get_time() + _INSTANT)])


_INSTANT = 1e-9
"""Time difference below which two times are equal up to rounding [s]."""
