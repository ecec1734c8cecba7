"""Motion of boxes: nominal kinematics, and the learned residual."""

import math
from pathlib import Path

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from pydrake.math import RigidTransform, RotationMatrix

from ictamp_drake.core.types import Action
from ictamp_drake.learning.dynamics import Dynamics, error, nominal
from ictamp_drake.learning.evaluation import evaluate_dynamics
from ictamp_drake.learning.models import load_dynamics
from ictamp_drake.learning.objectives import PoseRegression
from ictamp_drake.observation.state_matrix import Observation, Observer
from ictamp_drake.skills.config import PickConfig
from ictamp_drake.skills.geometry import held_bottom, placement_pose, raise_pose
from ictamp_drake.world.poses import to_pose, to_transform
from ictamp_drake.world.world import World
from tests.learning.synthetic import ONE, displace, matrices, write_untrained
from tests.world.scenes import far_boxes, hold_box, scene

WORLD = World(scene(far_boxes()))
OBSERVER = Observer(WORLD.spec)


def test_a_picked_box_rises_with_the_hand() -> None:
    c, action = WORLD.initial_configuration(), Action("pick", ("red_box", "table"))
    risen = to_pose(raise_pose(to_transform(c.poses["red_box"]), PickConfig().lift))
    matrix = torch.from_numpy(OBSERVER.observe_all([(c, action)]).matrix)
    found = nominal("pick", matrix, torch.tensor([[0.01, 0.02, 0.01, 0.4]]))
    np.testing.assert_allclose(found, OBSERVER.measure_moved_box([(c, action)], risen[None]), atol=1e-6)


@given(st.floats(-0.2, 0.2), st.floats(-0.2, 0.2), st.floats(-3.1, 3.1), st.sampled_from(["rack", "cyan_box"]))
def test_a_placed_box_stands_where_the_skill_takes_it(x: float, y: float, yaw: float, place: str) -> None:
    c, action = hold_box(WORLD, "red_box"), Action("place", ("red_box", place))
    X_WG0 = RigidTransform(RotationMatrix.MakeXRotation(np.pi), to_transform(c.poses["red_box"]).translation())
    X_WG = placement_pose(WORLD, c, place, held_bottom(WORLD, c, "red_box", X_WG0), np.array([x, y, 0.0, yaw]))
    X_WO = X_WG @ X_WG0.inverse() @ to_transform(c.poses["red_box"])
    matrix = torch.from_numpy(OBSERVER.observe_all([(c, action)]).matrix)
    found = nominal("place", matrix, torch.tensor([[x, y, 0.01, yaw]]))  # whatever the height of its release
    np.testing.assert_allclose(found, OBSERVER.measure_moved_box([(c, action)], to_pose(X_WO)[None]), atol=1e-5)


@given(st.floats(-3.0, 3.0), st.floats(-9.0, 9.0))
def test_yaws_are_compared_on_the_circle(yaw: float, more: float) -> None:
    one, other = (torch.tensor([[0.1, 0.2, 0.3, angle]], dtype=torch.float64) for angle in (yaw + more, yaw))
    wrong = error(one, other)[0]
    assert wrong[:3].abs().max() < 1e-9
    assert math.isclose(math.cos(wrong[3]), math.cos(more), abs_tol=1e-9)
    assert abs(wrong[3]) <= math.pi


@pytest.mark.parametrize("skill", ["pick", "place"])
def test_the_network_shifts_the_box_in_the_frame_of_k(skill: str) -> None:
    dynamics = Dynamics(skill, ONE).requires_grad_(False)
    for weights in dynamics.parameters():
        weights.zero_()
    matrix, mask = matrices(8)
    k = torch.randn((8, 4), generator=torch.Generator().manual_seed(1))
    torch.testing.assert_close(dynamics(matrix, mask, k), nominal(skill, matrix, k))
    dynamics.network.head_2.bias.copy_(torch.tensor([0.0, 2.0, 3.0, -1.0]))  # type: ignore[operator]
    shift = dynamics(matrix, mask, k) - nominal(skill, matrix, k)
    expected = torch.stack([-0.02 * k[:, 3].sin(), 0.02 * k[:, 3].cos()], dim=-1)
    torch.testing.assert_close(shift[:, :2], expected, atol=1e-6, rtol=0)
    torch.testing.assert_close(shift[:, 2:], torch.tensor([[0.03, -0.1]]).expand(8, 2), atol=1e-6, rtol=0)


@pytest.mark.parametrize("skill", ["pick", "place"])
def test_a_known_residual_is_recovered(skill: str) -> None:
    """Trained in some situations, evaluated in others."""
    torch.manual_seed(0)
    dynamics, training = Dynamics(skill, ONE), displace(skill, 2000, seed=0)
    objective, optimizer = PoseRegression(dynamics), torch.optim.Adam(dynamics.parameters(), 1e-2)
    noise = torch.Generator().manual_seed(0)
    for rate in np.linspace(1e-2, 1e-4, 300):
        optimizer.param_groups[0]["lr"] = rate
        optimizer.zero_grad()
        objective.loss(training.rows(torch.randint(2000, (256,), generator=noise)), noise).backward()
        optimizer.step()
    figures = evaluate_dynamics(dynamics, displace(skill, 500, seed=1))
    assert figures["count"] == 500
    assert figures["position_mean"] < figures["nominal_position_mean"] / 4
    assert figures["yaw_mean"] < figures["nominal_yaw_mean"] / 4


def test_a_model_from_its_checkpoint_says_the_same(tmp_path: Path) -> None:
    model = load_dynamics(write_untrained(tmp_path), "place")
    matrix, mask = matrices(5)
    k = torch.randn((5, 4), generator=torch.Generator().manual_seed(1))
    found = model.predict(Observation(matrix.numpy(), mask.numpy()), k.numpy().astype(np.float64))
    assert found.dtype == np.float64
    with torch.inference_mode():
        np.testing.assert_array_equal(found, model.dynamics(matrix, mask, k))
