"""k as input of networks."""

import math

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from ictamp_drake.core.types import Action, Configuration
from ictamp_drake.learning.parameters import (
    FEATURES,
    GLIMPSES,
    SEEN,
    blind_network_inputs,
    features,
    normalize_parameter,
    objects_seen_from,
    parameter,
    wrap_angle,
)
from ictamp_drake.motion.inverse_kinematics import ArmKinematics
from ictamp_drake.observation.state_matrix import ROWS, SCHEMA, Observer
from ictamp_drake.scenes.training import training_scene
from ictamp_drake.skills.geometry import grasp_pose, held_bottom, placement_pose
from ictamp_drake.world.poses import to_transform
from ictamp_drake.world.world import World
from tests.learning.synthetic import matrices
from tests.panda import PANDA
from tests.world.scenes import far_boxes, hold_box, scene

SPEC = training_scene(5)
BOX = min(SPEC.boxes)
SUPPORT = max(SPEC.supports)


def matrix_of(name: str, place: str) -> torch.Tensor:
    c = Configuration(np.zeros(7), np.zeros(2), {box: each.X_WO for box, each in SPEC.boxes.items()})
    return torch.from_numpy(Observer(SPEC).observe_all([(c, Action(name, (BOX, place)))]).matrix)


@given(st.sampled_from(["pick", "place"]), st.integers(0, 99))
def test_k_comes_back_from_its_normalized_form(skill: str, seed: int) -> None:
    matrix, _ = matrices(4, seed)
    k = torch.randn((4, 3, 4), generator=torch.Generator().manual_seed(seed)) * 0.1
    torch.testing.assert_close(parameter(skill, matrix, normalize_parameter(skill, matrix, k)), k, rtol=1e-4, atol=1e-5)
    torch.testing.assert_close(normalize_parameter(skill, matrix, k[:, 0]), normalize_parameter(skill, matrix, k)[:, 0])


def test_a_grasp_at_a_boxs_corner_is_at_one() -> None:
    matrix = matrix_of("pick", "table")
    sides = matrix[0, 0, SCHEMA.group("box")]
    corner = torch.cat([sides / 2, torch.zeros(1)])[None]
    torch.testing.assert_close(normalize_parameter("pick", matrix, corner), torch.tensor([[1.0, 1.0, 1.0, 0.0]]))


@pytest.mark.parametrize("place", [SUPPORT, max(SPEC.boxes)])
def test_a_placement_at_the_top_faces_corner_is_at_one(place: str) -> None:
    matrix = matrix_of("place", place)
    size = SPEC.supports[place].size if place in SPEC.supports else matrix[0, 2, SCHEMA.group("box")].numpy()
    u = normalize_parameter("place", matrix, torch.tensor([[size[0] / 2, -size[1] / 2, 0.022, 1.0]]))
    torch.testing.assert_close(u, torch.tensor([[1.0, -1.0, 1.0, 1.0]]))


@given(st.floats(-20, 20))
def test_wrapped_angles_are_the_same_angles(angle: float) -> None:
    turned = float(wrap_angle(torch.tensor(angle, dtype=torch.float64)))
    assert -math.pi <= turned < math.pi
    assert math.isclose(math.cos(turned), math.cos(angle), abs_tol=1e-9)
    assert math.isclose(math.sin(turned), math.sin(angle), abs_tol=1e-9)


def rotation(numbers: np.ndarray) -> np.ndarray:
    return np.stack([numbers[3:6], numbers[6:9], np.cross(numbers[3:6], numbers[6:9])], axis=-1)


def test_objects_are_seen_from_k_as_frames_say() -> None:
    matrix = matrix_of("pick", "table")
    k = torch.tensor([[0.01, -0.02, 0.03, 0.7]])
    cos, sin = math.cos(0.7), math.sin(0.7)
    R_KQ = np.array([[cos, -sin, 0], [sin, cos, 0], [0, 0, 1]])
    seen = objects_seen_from("pick", matrix, k)
    assert seen.shape == (1, ROWS, SEEN)
    target = matrix[0, :, SCHEMA.group("target")].numpy()
    for row in np.flatnonzero(matrix[0].abs().sum(dim=-1).numpy()):
        found, p_KO = seen[0, row].numpy(), target[row, :3]
        np.testing.assert_allclose(found[:3] * 0.2, R_KQ.T @ (p_KO - k[0, :3].numpy()), atol=1e-6)
        for axis in (slice(3, 6), slice(6, 9)):
            np.testing.assert_allclose(found[axis], R_KQ.T @ target[row, axis], atol=1e-6)
        sides = (matrix[0, row, SCHEMA.group("box")] + matrix[0, row, SCHEMA.group("support")]).numpy()
        p_OQ = rotation(target[row]).T @ (k[0, :3].numpy() - p_KO)
        np.testing.assert_allclose(np.sinh(2 * found[9:12]) * 0.01, np.abs(p_OQ) - sides / 2, atol=1e-4)


@pytest.mark.parametrize("skill", ["pick", "place"])
def test_the_base_sees_the_hand_where_the_motion_takes_it(skill: str) -> None:
    """The pose of G agrees with the skill's own geometry."""
    world = World(scene(far_boxes()))
    action = Action(skill, ("yellow_box", "table" if skill == "pick" else "rack"))
    c = world.initial_configuration() if skill == "pick" else hold_box(world, "yellow_box", drop=0.01)
    k = np.array([0.02, -0.01, 0.005, 0.7])
    if skill == "pick":
        X_WG = grasp_pose(world, c, "yellow_box", k)
    else:
        world.set_configuration(c)
        X_WG0 = ArmKinematics(PANDA, to_transform(world.spec.arm.X_WB)).forward(c.q)
        X_WG = placement_pose(world, c, "rack", held_bottom(world, c, "yellow_box", X_WG0), k)
    matrix = torch.from_numpy(Observer(world.spec).observe(c, action).matrix)[None]
    found = features(skill, matrix, torch.from_numpy(k.astype(np.float32))[None])[0, -6:].numpy()
    p, x = X_WG.translation(), X_WG.rotation().matrix()[:, 0]
    np.testing.assert_allclose(found[:3] * 0.7, p, atol=1e-5)
    assert found[3] * 0.7 == pytest.approx(np.hypot(*p[:2]), abs=1e-5)
    angle = math.atan2(x[1], x[0]) - math.atan2(p[1], p[0])
    np.testing.assert_allclose(found[4:], [math.cos(angle), math.sin(angle)], atol=1e-4)


def test_distances_to_the_faces_are_told() -> None:
    matrix = matrix_of("pick", "table")
    half = matrix[0, 0, SCHEMA.group("box")].numpy() / 2
    k = torch.tensor([[0.003, -0.004, 0.005, 0.0]])
    found = np.sinh(2 * features("pick", matrix, k)[0, 3:12].numpy())
    np.testing.assert_allclose(found[:3] * 0.001, k[0, :3], atol=1e-5)
    np.testing.assert_allclose(found[3:6] * 0.005, half - k[0, :3].numpy(), atol=1e-5)
    np.testing.assert_allclose(found[6:] * 0.005, half + k[0, :3].numpy(), atol=1e-5)


@given(st.sampled_from(["pick", "place"]), st.floats(-3, 3))
def test_a_full_turn_changes_nothing(skill: str, yaw: float) -> None:
    matrix, _ = matrices(2)
    k = torch.tensor([[0.01, 0.02, 0.03, yaw]] * 2)
    turned = k + torch.tensor([0.0, 0.0, 0.0, 2 * math.pi])
    assert features(skill, matrix, k).shape == (2, FEATURES)
    torch.testing.assert_close(features(skill, matrix, k), features(skill, matrix, turned), rtol=1e-3, atol=1e-4)
    torch.testing.assert_close(
        objects_seen_from(skill, matrix, k), objects_seen_from(skill, matrix, turned), rtol=1e-3, atol=1e-4
    )


@pytest.mark.parametrize("skill", ["pick", "place"])
def test_glimpses_are_views_from_the_middle_of_the_target(skill: str) -> None:
    matrix, _ = matrices(3)
    rows, extra = blind_network_inputs(skill, matrix)
    assert rows.shape == (3, ROWS, SCHEMA.width + GLIMPSES * SEEN)
    assert extra.shape == (3, GLIMPSES * FEATURES)
    torch.testing.assert_close(rows[..., : SCHEMA.width], matrix / torch.tensor(SCHEMA.scales, dtype=torch.float32))
    for number, yaw in enumerate((0.0, math.pi / 2)):
        k = torch.tensor([0.0, 0.0, 0.0, yaw]).expand(3, 4)
        seen = rows[..., SCHEMA.width :][..., number * SEEN :][..., :SEEN]
        torch.testing.assert_close(seen, objects_seen_from(skill, matrix, k), rtol=1e-3, atol=1e-4)
        mine = extra[:, number * FEATURES :][:, :FEATURES]
        torch.testing.assert_close(mine, features(skill, matrix, k), rtol=1e-3, atol=1e-4)
