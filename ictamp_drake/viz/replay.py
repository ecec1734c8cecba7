"""replay.html: a recorded simulation as a page with play, pause and a slider. It needs neither network nor server."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from pydrake.geometry import MeshcatAnimation

from ictamp_drake.core.files import write_whole
from ictamp_drake.core.types import Attempt
from ictamp_drake.scenes.spec import SceneSpec
from ictamp_drake.viz.page import Caption, add_captions
from ictamp_drake.viz.stage import Stage, start_meshcat
from ictamp_drake.viz.tracks import tracks
from ictamp_drake.world.outcome import Frame
from ictamp_drake.world.poses import to_transform

TICKS = 1000
"""Resolution of times in the page [1/s]."""


def plan_captions(attempts: Sequence[Attempt[Any]], starts: Sequence[float]) -> list[Caption]:
    """Return the captions of a plan: number and action of each skill, and the label of the segment.

    Args:
        attempts: Runs of the plan's skills.
        starts: Time in the recording at which each skill begins [s].
    """
    result = []
    for number, (attempt, start) in enumerate(zip(attempts, starts, strict=True), 1):
        time = start
        for segment in attempt.motion:
            text = f"{number}/{len(attempts)} {attempt.action} – {segment.label}"
            result.append(Caption(time, time + segment.duration, text))
            time += segment.duration
    return result


def replay_html(
    spec: SceneSpec, frames: Sequence[Frame], captions: Sequence[Caption], path: Path, *, stage: Stage | None = None
) -> None:
    """Write the page; it appears whole or not at all.

    Args:
        spec: Scene to show.
        frames: Frames of the recording in order of time; the recording starts at the page's time 0.
        captions: Texts to show, in the recording's time.
        path: File of the page.
        stage: Stage of the scene, which keeps the animation; by default a new one.
    """
    stage = stage or Stage(spec, start_meshcat())
    stage.show(frames[0].c)
    stage.meshcat.SetAnimation(_animation(stage, frames))
    write_whole(path, add_captions(stage.meshcat.StaticHtml(), captions))


def _animation(stage: Stage, frames: Sequence[Frame]) -> MeshcatAnimation:
    animation = MeshcatAnimation(frames_per_second=TICKS)
    animation.set_loop_mode(MeshcatAnimation.LoopMode.kLoopOnce)
    for path, track in tracks(stage, frames).items():
        for time, pose in zip(track.times, track.poses, strict=True):
            animation.SetTransform(round(TICKS * time), path, to_transform(pose))
    return animation
