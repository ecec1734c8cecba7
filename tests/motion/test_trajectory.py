from itertools import pairwise

import numpy as np
import pytest
from pydrake.math import RigidTransform

from ictamp_drake.core.types import GripperCommand
from ictamp_drake.motion.inverse_kinematics import ArmKinematics
from ictamp_drake.motion.trajectory import Trajectory, sample
from ictamp_drake.motion.trajectory_optimization import TrajectoryOptimizer
from tests.panda import HOME, PANDA

ARM = ArmKinematics(PANDA, RigidTransform())


@pytest.fixture(scope="module")
def trajectory() -> Trajectory:
    return TrajectoryOptimizer(PANDA).connect(HOME, HOME + [0.9, -0.3, 0.2, 0.5, -0.4, 0.3, 1.2])


def test_segment_carries_the_spline(trajectory: Trajectory) -> None:
    segment = trajectory.segment("approach", GripperCommand(0.08))
    assert segment.knots[0] == 0.0
    assert segment.duration == segment.knots[-1]
    assert len(segment.knots) == len(segment.control_points) + segment.order


def test_reversed_goes_the_same_way_back(trajectory: Trajectory) -> None:
    back = trajectory.reversed()
    times = np.linspace(0.0, trajectory.duration, 50)
    np.testing.assert_allclose(back.positions(times), trajectory.positions(trajectory.duration - times), atol=1e-12)
    np.testing.assert_array_equal(back.start, trajectory.end)


@pytest.mark.parametrize(("step", "turn"), [(0.01, 0.02), (0.01, 1.0), (1.0, 0.02)])
def test_samples_are_as_dense_as_asked(trajectory: Trajectory, step: float, turn: float) -> None:
    qs = sample(trajectory, ARM.forward_all, step, turn)
    np.testing.assert_allclose(qs[[0, -1]], [trajectory.start, trajectory.end], atol=1e-12)
    assert np.abs(np.diff(qs, axis=0)).max() <= turn
    X_WGs = [ARM.forward(q) for q in qs]
    ways = [a.inverse() @ b for a, b in pairwise(X_WGs)]
    assert max(np.linalg.norm(way.translation()) for way in ways) <= step
    assert max(way.rotation().ToAngleAxis().angle() for way in ways) <= turn
