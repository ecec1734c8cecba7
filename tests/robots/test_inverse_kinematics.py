"""Contract of all kinds of inverse kinematics."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.protocols import InverseKinematics
from ictamp_drake.core.types import FloatArray
from ictamp_drake.robots import choice
from ictamp_drake.robots.analytic import AnalyticKinematics, lockable
from ictamp_drake.robots.chain import Chain, is_within
from ictamp_drake.robots.choice import Trial, create_inverse_kinematics, free_angles, try_poses
from ictamp_drake.robots.numeric import NumericKinematics
from ictamp_drake.robots.panda import PandaKinematics
from tests.robots.arms import CROOKED, PANDA, SIX

KINDS: dict[str, tuple[Chain, InverseKinematics]] = {
    "closed form": (PANDA, PandaKinematics()),
    "analytic, seven joints": (PANDA, AnalyticKinematics(PANDA, 6)),
    "analytic, six joints": (SIX, AnalyticKinematics(SIX, None)),
    "numeric": (CROOKED, NumericKinematics(CROOKED, 24)),
    "numeric, six joints": (SIX, NumericKinematics(SIX, 16)),
}
shares = st.lists(st.floats(0.0, 1.0), min_size=7, max_size=7).map(np.array)


def finite(limits: FloatArray) -> FloatArray:
    return np.clip(limits, -np.pi, np.pi)


@pytest.mark.parametrize("kind", KINDS)
@given(st.lists(shares, min_size=1, max_size=3), st.lists(st.floats(-3, 3), min_size=1, max_size=3).map(np.array))
@settings(max_examples=20, deadline=None)
def test_all_postures_are_within_limits_and_at_their_pose(
    kind: str, places: list[FloatArray], angles: FloatArray
) -> None:
    chain, kinematics = KINDS[kind]
    lower, upper = finite(chain.limits)
    X_BG = chain.forward(lower + np.array(places)[:, : len(lower)] * (upper - lower))
    q, pose = kinematics.postures(X_BG, angles, chain.limits)
    assert q.shape == (len(pose), len(lower))
    assert is_within(q, chain.limits).all()
    assert chain.is_at(q, X_BG[pose]).all()
    if kinematics.free is not None:
        assert np.abs(q[:, kinematics.free, None] - angles).min(axis=1, initial=np.inf).max(initial=0.0) < 1e-9
    again = kinematics.postures(X_BG, angles, chain.limits)
    np.testing.assert_array_equal(q, again[0])
    np.testing.assert_array_equal(pose, again[1])


@pytest.mark.parametrize("kind", KINDS)
def test_poses_solved_together_have_the_postures_of_each(kind: str) -> None:
    chain, kinematics = KINDS[kind]
    X_BG = chain.forward(np.random.default_rng(3).uniform(*finite(chain.limits), (70, len(chain.axes))))
    angles = free_angles(kinematics.free, chain.limits, 1.0)
    q, pose = kinematics.postures(X_BG, angles, chain.limits)
    for number in (0, 1, 69):
        alone, _ = kinematics.postures(X_BG[[number]], angles, chain.limits)
        one, other = (rows[np.lexsort(rows.round(6).T)] for rows in (q[pose == number], alone))
        np.testing.assert_allclose(one, other, atol=1e-5)


@pytest.mark.parametrize("kind", KINDS)
def test_nearly_every_reachable_pose_has_a_posture_and_none_out_of_reach(kind: str) -> None:
    chain, kinematics = KINDS[kind]
    assert try_poses(kinematics, chain, 100, 0.1).solved >= 0.95
    far = np.eye(4)[None]
    far[0, 0, 3] = 5.0
    assert not len(kinematics.postures(far, free_angles(kinematics.free, chain.limits, 0.1), chain.limits)[0])
    assert not len(kinematics.postures(far[:0], np.zeros(1), chain.limits)[0])


@given(shares)
@settings(deadline=None)
def test_analytic_finds_what_the_closed_form_finds(share: FloatArray) -> None:
    q = PANDA.limits[0] + share * (PANDA.limits[1] - PANDA.limits[0])
    X_BG, angles = PANDA.forward(q[None]), np.array([q[6], 0.3])
    (closed, _), (analytic, _) = (KINDS[kind][1].postures(X_BG, angles, PANDA.limits) for kind in list(KINDS)[:2])
    jacobians = PANDA.forward_with_jacobian(closed)[1][:, :, :6]
    regular = np.abs(np.linalg.det(jacobians)) > 1e-4 if len(closed) else np.zeros(0, bool)
    inside = is_within(closed, PANDA.limits + [[1e-4], [-1e-4]])
    for each in closed[regular & inside]:
        assert np.abs(analytic - each).max(axis=1).min(initial=np.inf) < 1e-4


@given(shares)
@settings(deadline=None)
def test_closed_form_finds_angles_of_the_sixth_joint_beyond_half_a_turn(share: FloatArray) -> None:
    limits = PANDA.limits.copy()
    limits[0, 5] = np.pi
    q = limits[0] + share * (limits[1] - limits[0])
    X_BG, angles = PANDA.forward(q[None]), q[6:]
    found, _ = PandaKinematics().postures(X_BG, angles, PANDA.limits)
    assert is_within(found, PANDA.limits).all()
    assert PANDA.is_at(found, np.repeat(X_BG, len(found), axis=0)).all()
    if min(abs(np.sin(q[1])), abs(np.cos(q[4]))) > 1e-3:  # else a turn of one joint can undo that of another
        inside = is_within(q, PANDA.limits + [[1e-4], [-1e-4]])
        assert not inside or np.abs(found - q).max(axis=1).min(initial=np.inf) < 1e-4


def test_auto_takes_the_first_kind_that_serves(monkeypatch: pytest.MonkeyPatch) -> None:
    assert isinstance(create_inverse_kinematics("auto", PANDA, 64), PandaKinematics)
    assert isinstance(create_inverse_kinematics("auto", SIX, 64), AnalyticKinematics)
    assert isinstance(create_inverse_kinematics("auto", CROOKED, 64), NumericKinematics)
    monkeypatch.setattr(choice, "try_poses", lambda *_: Trial(0.5, 8.0))
    assert isinstance(create_inverse_kinematics("auto", SIX, 64), NumericKinematics)
    assert isinstance(create_inverse_kinematics("analytic", SIX, 64), AnalyticKinematics)


def test_a_kind_that_does_not_serve_the_arm_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    assert lockable(CROOKED) == []
    for kind, chain in (("analytic", CROOKED), ("closed-form", SIX)):
        with pytest.raises(IctampError) as refused:
            create_inverse_kinematics(kind, chain, 64)
        assert refused.value.code is Code.CONFLICT
    monkeypatch.setattr(choice, "find_spec", lambda _: None)
    assert isinstance(create_inverse_kinematics("auto", SIX, 64), NumericKinematics)
    with pytest.raises(IctampError) as missing:
        create_inverse_kinematics("analytic", SIX, 64)
    assert missing.value.code is Code.NOT_INSTALLED
