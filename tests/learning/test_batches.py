"""Attempts as tensors, and how they are split."""

import numpy as np
import pytest
import torch

from ictamp_drake.core.errors import Code
from ictamp_drake.learning.batches import batch, split
from ictamp_drake.learning.dataset import Attempts, load
from tests.learning.synthetic import write_attempts
from tests.refusals import refusal


@pytest.fixture(scope="module")
def attempts(tmp_path_factory: pytest.TempPathFactory) -> Attempts:
    folder = tmp_path_factory.mktemp("attempts")
    write_attempts(folder)
    return load(folder, "pick")


def numbers(part: Attempts, k: torch.Tensor) -> set[int]:
    """Numbers of the scenes of attempts with these k."""
    known = {row.tobytes(): int(scene) for row, scene in zip(part.k, part.scene, strict=True)}
    return {known[row.tobytes()] for row in k.numpy()}


def test_no_scene_is_in_two_parts_and_none_is_lost(attempts: Attempts) -> None:
    parts = [numbers(attempts, part.k) for part in split(attempts)]
    assert sum(len(part) for part in parts) == len(set.union(*parts)) == len(set(attempts.scene.tolist()))
    assert sum(len(part) for part in split(attempts)) == len(attempts)
    shares = [len(part) / len(set.union(*parts)) for part in parts]
    np.testing.assert_allclose(shares, [0.8, 0.1, 0.1], atol=0.05)


def test_a_scene_stays_in_its_part_when_others_are_added(attempts: Attempts) -> None:
    fewer = attempts.select(attempts.scene < 240)
    for before, after in zip(split(fewer), split(attempts), strict=True):
        assert numbers(attempts, before.k) <= numbers(attempts, after.k)


def test_the_successes_of_each_part_can_be_had_alone(attempts: Attempts) -> None:
    parts = split(attempts)
    for part, successes in zip(parts, parts.successes(), strict=True):
        assert len(successes) == part.success.sum()
        assert successes.success.all()
        assert set(map(tuple, successes.k.tolist())) <= set(map(tuple, part.k.tolist()))


def test_a_policy_learns_from_all_successes_and_once_from_what_never_succeeded(attempts: Attempts) -> None:
    situations = np.unique(attempts.matrix, axis=0, return_inverse=True)[1]
    order = np.argsort(situations, kind="stable")
    whole = batch(attempts.select(order))
    telling = whole.select_informative()
    assert telling.success.sum() == whole.success.sum()
    won = {row.numpy().tobytes() for row in whole.matrix[whole.success > 0]}
    lost = [row.numpy().tobytes() for row in telling.matrix[telling.success == 0]]
    assert len(lost) == len(set(lost)) > 0
    assert {row.numpy().tobytes() for row in whole.matrix} == won | set(lost)
    assert not won & set(lost)


def test_too_few_attempts_are_refused(attempts: Attempts) -> None:
    few = attempts.select(attempts.scene < 20)
    with refusal(Code.TOO_FEW_DATA, value=0):
        split(few)
    with refusal(Code.TOO_FEW_DATA, value=0):
        split(attempts.select(~attempts.success))


def test_members_of_an_ensemble_see_samples_of_their_own(attempts: Attempts) -> None:
    plain = batch(attempts)
    drawn = plain.with_bootstrap_weights(3, np.random.default_rng(0))
    assert drawn.weight.shape == (len(attempts), 3)
    torch.testing.assert_close(drawn.weight.mean(dim=0), torch.ones(3), atol=0.2, rtol=0)
    assert (drawn.weight == drawn.weight.round()).all()
    assert (drawn.weight[:, 0] != drawn.weight[:, 1]).any()
    assert torch.equal(drawn.k, plain.k)
    chosen = torch.tensor([4, 2])
    assert torch.equal(drawn.rows(chosen).weight, drawn.weight[chosen])
