"""replay.html: a recorded simulation as a page with play, pause and slider that needs neither network nor server."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from pydrake.geometry import MeshcatAnimation
from pydrake.math import RigidTransform

from ictamp_drake.core.types import Attempt, FloatArray
from ictamp_drake.scenes.spec import SceneSpec
from ictamp_drake.viz.keyframes import keyframes, same_hemisphere
from ictamp_drake.viz.page import Caption, add_captions
from ictamp_drake.viz.stage import Stage, start_meshcat
from ictamp_drake.world.simulate import Frame

TICKS = 1000
"""Resolution of times in the page [1/s]."""

TOLERANCE = 5e-4
"""How far from the recording a shown pose may be: position [m], components of the unit quaternion."""


def plan_captions(attempts: Sequence[Attempt[Any]], starts: Sequence[float]) -> list[Caption]:
    """What to write while a plan runs: number and name of the skill, and what the arm is about.

    Args:
        attempts: the skills of the plan.
        starts: when each begins in the recording [s].
    """
    result = []
    for number, (attempt, start) in enumerate(zip(attempts, starts, strict=True), 1):
        time = start
        for segment in attempt.motion:
            text = f"{number}/{len(attempts)} {attempt.action} – {segment.label}"
            result.append(Caption(time, time + segment.duration, text))
            time += segment.duration
    return result


def replay_html(spec: SceneSpec, frames: Sequence[Frame], captions: Sequence[Caption], path: Path) -> None:
    """Write the page; it appears whole or not at all.

    Args:
        spec: the scene.
        frames: the recording, in the order of time; its start is the page's time 0.
        captions: texts to show, in the recording's time.
        path: of the page.
    """
    meshcat = start_meshcat()
    stage = Stage(spec, meshcat)
    stage.show(frames[0].c)
    meshcat.SetAnimation(_animation(stage, frames))
    page = add_captions(meshcat.StaticHtml(), captions)
    temporary = path.with_name(f".{path.name}.partial")
    temporary.write_text(page, encoding="utf-8")
    temporary.replace(path)


def _animation(stage: Stage, frames: Sequence[Frame]) -> MeshcatAnimation:
    animation = MeshcatAnimation(frames_per_second=TICKS)
    animation.set_loop_mode(MeshcatAnimation.LoopMode.kLoopOnce)
    times = np.array([frame.time for frame in frames])
    for path, poses in _tracks(stage, frames).items():
        for index in keyframes(times, _numbers(poses), TOLERANCE):
            animation.SetTransform(round(TICKS * times[index]), path, poses[index])
    return animation


def _tracks(stage: Stage, frames: Sequence[Frame]) -> dict[str, list[RigidTransform]]:
    shown = [stage.poses(frame.c) for frame in frames]
    return {path: [poses[path] for poses in shown] for path in shown[0]}


def _numbers(poses: Sequence[RigidTransform]) -> FloatArray:
    quaternions = np.array([X.rotation().ToQuaternion().wxyz() for X in poses])
    return np.hstack([same_hemisphere(quaternions), [X.translation() for X in poses]])
