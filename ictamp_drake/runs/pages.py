"""Pictures and pages of one problem. They are made when its result is known, and with what only they need."""

import json
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

from ictamp_drake.core.types import Configuration
from ictamp_drake.runs.files import write_whole
from ictamp_drake.runs.recording import recorded_steps
from ictamp_drake.runs.replay import plan_frames, starts
from ictamp_drake.runs.solve import Solution
from ictamp_drake.viz.growth import draw_growth
from ictamp_drake.viz.picture import scene_png
from ictamp_drake.viz.replay import plan_captions, replay_html
from ictamp_drake.viz.search_page import search_html
from ictamp_drake.viz.stage import Stage, start_meshcat
from ictamp_drake.viz.tree import draw_tree


def write_pages(solution: Solution, folder: Path) -> None:
    """Write the tree, its pictures, that of the scene and the pages; each that can be made is.

    Raises:
        RuntimeError: one sentence that says which could not be made.
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
    """What writes each, by its name."""
    task, result = solution.task, solution.result
    tree = result.tree.to_dict(_configuration_to_dict)

    @cache
    def stage() -> Stage:
        return Stage(task.spec, start_meshcat())

    def write_search(path: Path) -> None:
        recordings = recorded_steps(task.physics, result.tree)
        search_html(task.spec, result.tree, recordings, path, title, stage=stage())

    def write_replay(path: Path) -> None:
        if result.solved and result.plan:
            captions = plan_captions(result.plan, starts(result.plan))
            replay_html(task.spec, plan_frames(task.physics, result.plan), captions, path, stage=stage())

    return {
        "tree.json": lambda path: write_whole(path, json.dumps(tree)),
        "tree.svg": lambda path: draw_tree(tree, path, title),
        "growth.svg": lambda path: draw_growth(tree, path),
        "scene.png": lambda path: scene_png(task.spec, task.c, path, stage()),
        "search.html": write_search,
        "replay.html": write_replay,  # the last one, since its animation stays on the stage
    }


def _configuration_to_dict(c: Configuration) -> dict[str, Any]:
    poses = {name: pose.tolist() for name, pose in c.poses.items()}
    return {"q": c.q.tolist(), "poses": poses, "held": c.held}
