"""Recordings, reduced to the moments needed to show them."""

import numpy as np

from ictamp_drake.viz.stage import Stage, start_meshcat
from ictamp_drake.viz.tracks import TOLERANCE, tracks
from ictamp_drake.world.poses import to_pose
from tests.viz.scene import DURATION, SPEC, START, recording


def test_what_is_between_the_keys_is_on_a_straight_line() -> None:
    stage, frames = Stage(SPEC, start_meshcat()), recording()
    found = tracks(stage, frames)
    times = np.array([frame.time for frame in frames])
    for path, track in found.items():
        assert len(track.times) < len(frames) / 5
        recorded = np.array([to_pose(stage.poses(frame.c)[path]) for frame in frames])
        shown = np.array([np.interp(times, track.times, column) for column in track.poses.T]).T
        signs = np.sign(np.sum(recorded[:, :4] * shown[:, :4], axis=1))[:, None]
        assert np.abs(recorded[:, 4:] - shown[:, 4:]).max() <= TOLERANCE
        assert np.abs(signs * recorded[:, :4] - shown[:, :4]).max() <= TOLERANCE


def test_a_body_that_stands_still_has_one_key() -> None:
    found = tracks(Stage(SPEC, start_meshcat()), recording())
    red, blue = found["/scene/red_box/red_box"], found["/scene/blue_box/blue_box"]
    np.testing.assert_allclose(red.poses, [START.poses["red_box"]], atol=1e-12)
    np.testing.assert_allclose(blue.times, [0.0, DURATION])
