"""What a run leaves of one problem, besides its record."""

import json
from pathlib import Path
from typing import Any, Literal

from ictamp_drake.core.types import Configuration
from ictamp_drake.runs.files import write_whole
from ictamp_drake.runs.plan_file import Plan, write_plan
from ictamp_drake.runs.recording import recorded_steps
from ictamp_drake.runs.replay import plan_frames, starts
from ictamp_drake.runs.solve import Solution
from ictamp_drake.scenes.spec import save_scene
from ictamp_drake.viz.growth import draw_growth
from ictamp_drake.viz.picture import scene_png
from ictamp_drake.viz.replay import plan_captions, replay_html
from ictamp_drake.viz.search_page import search_html
from ictamp_drake.viz.tree import draw_tree

Artefacts = Literal["all", "plan", "none"]


def write_artefacts(solution: Solution, folder: Path, which: Artefacts) -> None:
    """Write scene.yaml and, for a verified plan, plan.yaml; for "all" also tree and pictures; for "none" nothing."""
    if which == "none":
        return
    folder.mkdir(parents=True, exist_ok=True)
    task, result = solution.task, solution.result
    save_scene(task.spec, folder / "scene.yaml")
    if result.solved and result.plan is not None:
        write_plan(Plan(task.spec, task.c, result.plan), folder / "plan.yaml")
    if which == "all":
        _write_pictures(solution, folder)


def _write_pictures(solution: Solution, folder: Path) -> None:
    task, result = solution.task, solution.result
    tree = result.tree.to_dict(_configuration_to_dict)
    write_whole(folder / "tree.json", json.dumps(tree))
    draw_tree(tree, folder / "tree.svg", folder.name)
    draw_growth(tree, folder / "growth.svg")
    scene_png(task.spec, task.c, folder / "scene.png")
    if result.solved and result.plan:
        captions = plan_captions(result.plan, starts(result.plan))
        replay_html(task.spec, plan_frames(task.physics, result.plan), captions, folder / "replay.html")
    recordings = recorded_steps(task.physics, result.tree)
    search_html(task.spec, result.tree, recordings, folder / "search.html", folder.name)


def _configuration_to_dict(c: Configuration) -> dict[str, Any]:
    poses = {name: pose.tolist() for name, pose in c.poses.items()}
    return {"q": c.q.tolist(), "poses": poses, "held": c.held}
