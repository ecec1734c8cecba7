"""Equivalent descriptions of a situation equal those of the observer."""

from dataclasses import replace

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from ictamp_drake.core.types import Action, Configuration, FloatArray
from ictamp_drake.learning.batches import Batch
from ictamp_drake.learning.symmetry import mirror, turn_frames, vary_description
from ictamp_drake.observation.state_matrix import ROWS, Observer
from ictamp_drake.scenes.spec import BoxSpec, SceneSpec, SupportSpec, Vector
from ictamp_drake.scenes.training import training_scene
from tests.learning.synthetic import matrices

SPECS = [training_scene(number) for number in (0, 2, 5, 11, 12, 14)]
Q = np.array([0.4, -0.6, 0.2, -2.2, 0.1, 1.6, 0.5])
specs = st.sampled_from([spec for spec in SPECS if len(spec.boxes) > 1])
skills = st.sampled_from(["pick", "place"])


def action(spec: SceneSpec, skill: str) -> Action:
    boxes = sorted(spec.boxes)
    return Action(skill, (boxes[0], "table" if skill == "pick" else boxes[1]))


def observe(spec: SceneSpec, skill: str, q: FloatArray = Q) -> torch.Tensor:
    held = None if skill == "pick" else min(spec.boxes)
    c = Configuration(q, np.array([0.03, 0.03]), {name: box.X_WO for name, box in spec.boxes.items()}, held)
    return torch.from_numpy(Observer(spec).observe(c, action(spec, skill)).matrix)[None]


def batch_of(matrix: torch.Tensor, k: torch.Tensor | None = None) -> Batch:
    """Attempts with this matrix; the box ends at k."""
    k = torch.zeros(len(matrix), 4) if k is None else k
    return Batch(matrix, matrix.abs().sum(-1) > 0, k, torch.ones(len(k)), k, torch.ones(len(k), 1))


def swap_sides(size: tuple[float, ...]) -> Vector:
    return size[1], size[0], size[2]


def turn_box(box: BoxSpec) -> BoxSpec:
    """The same box with other names for its x and y axes; only for a box that stands upright."""
    roll, pitch, yaw = box.rotation
    return replace(box, size=swap_sides(box.size), rotation=(roll, pitch, yaw + 90.0))


def turn_support(support: SupportSpec) -> SupportSpec:
    return replace(support, size=swap_sides(support.size), yaw=support.yaw - 270.0)


@given(specs, skills)
def test_the_frames_of_all_objects_may_be_turned(spec: SceneSpec, skill: str) -> None:
    boxes = {name: turn_box(box) if box.rotation[:2] == (0, 0) else box for name, box in spec.boxes.items()}
    supports = {name: turn_support(support) for name, support in spec.supports.items()}
    tipped = [name for name, box in boxes.items() if box is spec.boxes[name]]
    if tipped:  # the observer decides the order of the rows
        return
    batch = batch_of(observe(spec, skill))
    other = turn_frames(skill, batch, torch.ones(1, ROWS, dtype=torch.long)).matrix
    expected = observe(replace(spec, boxes=boxes, supports=supports), skill)
    torch.testing.assert_close(other * batch.mask[..., None], expected, rtol=1e-4, atol=1e-4)


def yaw(angle: float) -> FloatArray:
    return np.asarray(Rotation.from_euler("z", angle).as_matrix())


@given(skills, st.integers(0, 3), st.integers(0, 3), st.integers(0, 99))
def test_k_stays_where_it_was_in_the_world(skill: str, of_moved: int, of_target: int, seed: int) -> None:
    """R_KU of the moved object: G for a pick, the held box for a placement, whose own frame turns too."""
    matrix, _ = matrices(1, seed)
    turns = torch.zeros(1, ROWS, dtype=torch.long)
    turns[0, 1], turns[0, 0 if skill == "pick" else 2] = of_moved, of_target
    k = torch.randn((1, 4), generator=torch.Generator().manual_seed(seed))
    batch = turn_frames(skill, batch_of(matrix, k), turns)
    other, moved = batch.k, batch.moved
    R_KK, R_UU = yaw(of_target * np.pi / 2), yaw(0.0 if skill == "pick" else of_moved * np.pi / 2)
    np.testing.assert_allclose(R_KK @ other[0, :3].numpy(), k[0, :3], atol=1e-5)
    np.testing.assert_allclose(R_KK @ yaw(float(other[0, 3])), yaw(float(k[0, 3])) @ R_UU, atol=1e-5)
    R_UU = yaw((of_target if skill == "pick" else of_moved) * np.pi / 2)
    np.testing.assert_allclose(R_KK @ moved[0, :3].numpy(), k[0, :3], atol=1e-5)
    np.testing.assert_allclose(R_KK @ yaw(float(moved[0, 3])), yaw(float(k[0, 3])) @ R_UU, atol=1e-5)


@given(specs, skills)
def test_the_mirror_image_is_what_a_mirrored_scene_shows(spec: SceneSpec, skill: str) -> None:
    def reflect(position: Vector) -> Vector:
        return position[0], -position[1], position[2]

    boxes = {
        name: replace(
            box, position=reflect(box.position), rotation=(-box.rotation[0], box.rotation[1], -box.rotation[2])
        )
        for name, box in spec.boxes.items()
    }
    supports = {
        name: replace(support, position=reflect(support.position), yaw=-support.yaw)
        for name, support in spec.supports.items()
    }
    q = Q * [-1, 1, -1, 1, -1, 1, -1] + [0, 0, 0, 0, 0, 0, np.pi / 2]
    image = mirror(batch_of(observe(spec, skill))).matrix
    expected = observe(replace(spec, boxes=boxes, supports=supports), skill, q)
    tipped = any(box.rotation[:2] != (0, 0) for box in spec.boxes.values())
    if not tipped:  # another axis points up then
        torch.testing.assert_close(image, expected, rtol=1e-4, atol=1e-4)


@given(st.integers(0, 99))
def test_four_turns_and_two_reflections_change_nothing(seed: int) -> None:
    matrix, _ = matrices(3, seed)
    k = torch.randn((3, 4), generator=torch.Generator().manual_seed(seed))
    turns = torch.randint(4, (3, ROWS), generator=torch.Generator().manual_seed(seed))
    for skill in ("pick", "place"):
        back = turn_frames(skill, turn_frames(skill, batch_of(matrix, k), turns), (4 - turns) % 4)
        torch.testing.assert_close(back.matrix, matrix, rtol=1e-4, atol=1e-5)
        torch.testing.assert_close(back.k, k, rtol=1e-4, atol=1e-5)
        torch.testing.assert_close(back.moved, k, rtol=1e-4, atol=1e-5)
    image = mirror(mirror(batch_of(matrix, k)))
    for found, original in (image.matrix, matrix), (image.k, k), (image.moved, k):
        torch.testing.assert_close(found, original)


@pytest.mark.parametrize("skill", ["pick", "place"])
def test_variety_comes_from_the_generator_alone(skill: str) -> None:
    matrix, _ = matrices(200)
    k = torch.rand(200, 4)
    batch = batch_of(matrix, k)
    first, again, other = (vary_description(skill, batch, torch.Generator().manual_seed(seed)) for seed in (1, 1, 2))
    assert torch.equal(first.matrix, again.matrix)
    assert torch.equal(first.k, again.k)
    assert not torch.equal(first.matrix, other.matrix)
    left = (first.k[:, :2] - k[:, :2]).abs().sum(-1) < 1e-6
    assert 0.03 < left.float().mean() < 0.25  # an eighth stays unchanged
