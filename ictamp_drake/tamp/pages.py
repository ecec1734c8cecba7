"""Pictures and pages of one problem, made when its result is known. Only this module loads what draws them."""

import json
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

from ictamp_drake.core.files import write_whole
from ictamp_drake.core.types import Configuration
from ictamp_drake.tamp.plan import Plan
from ictamp_drake.tamp.replay import plan_frames, recorded_steps, starts
from ictamp_drake.tamp.solve import Solution
from ictamp_drake.viz.growth import draw_growth
from ictamp_drake.viz.picture import scene_png
from ictamp_drake.viz.replay import plan_captions, replay_html
from ictamp_drake.viz.search_page import search_html
from ictamp_drake.viz.stage import Stage, start_meshcat
from ictamp_drake.viz.tree import draw_tree
from ictamp_drake.world.config import PhysicsConfig
from ictamp_drake.world.outcome import Frame
from ictamp_drake.world.simulate import Physics
from ictamp_drake.world.world import World


def write_pages(solution: Solution, folder: Path) -> None:
    """Write the tree, its pictures, the picture of the scene and the pages; one that fails does not stop the others.

    Raises:
        RuntimeError: Some could not be made; one sentence names them.
    """
    failed: dict[str, Exception] = {}
    for name, write in _pages(solution, folder.name).items():
        try:
            write(folder / name)
        except Exception as error:
            failed[name] = error
    if failed:
        causes = "; ".join(f"{name} could not be made: {error!r}" for name, error in failed.items())
        raise RuntimeError(causes) from next(iter(failed.values()))


def _pages(solution: Solution, title: str) -> dict[str, Callable[[Path], None]]:
    """Return the function that writes each file, by the file's name."""
    task, result = solution.task, solution.result
    tree = result.tree.to_dict(_configuration_to_dict)
    reasons = solution.explain().reasons

    @cache
    def stage() -> Stage:
        return Stage(task.spec, start_meshcat())

    def write_search(path: Path) -> None:
        recordings = recorded_steps(task.physics, result.tree)
        search_html(task.spec, result.tree, recordings, path, title, stage=stage(), reasons=reasons)

    def write_animation(path: Path) -> None:
        if solution.plan is not None:
            write_replay(solution.plan, path, task.physics, stage())

    return {
        "tree.json": lambda path: write_whole(path, json.dumps(tree)),
        "tree.svg": lambda path: draw_tree(tree, path, title),
        "growth.svg": lambda path: draw_growth(tree, path),
        "scene.png": lambda path: scene_png(task.spec, task.c, path, stage(), reasons),
        "search.html": write_search,
        "replay.html": write_animation,  # last, since its animation stays on the stage
    }


def write_replay(plan: Plan, path: Path, physics: Physics | None = None, stage: Stage | None = None) -> None:
    """Write the page of a plan, which shows the start if the plan is empty.

    The plan is executed again unless all its skills were recorded.

    Args:
        plan: Plan to show.
        path: File of the page.
        physics: Simulator of the scene; by default a new one.
        stage: Stage to draw on, which keeps the animation; by default a new one.
    """
    physics = physics or PhysicsConfig().create(World(plan.spec))
    attempts = plan.attempts
    if any(attempt.recording is None for attempt in attempts):
        attempts = plan.replay(physics.config).recorded(attempts)
    frames = plan_frames(physics, attempts) or [Frame(0.0, plan.c)]
    replay_html(plan.spec, frames, plan_captions(attempts, starts(attempts)), path, stage=stage)


def _configuration_to_dict(c: Configuration) -> dict[str, Any]:
    poses = {name: pose.tolist() for name, pose in c.poses.items()}
    return {"q": [*c.q.tolist(), *c.fingers.tolist()], "poses": poses, "held": c.held}
