"""Files that a run leaves of one problem, besides its record: first those that cannot be remade, then the pages."""

from pathlib import Path
from typing import Literal

from ictamp_drake.planning.events import Event, PlanFound
from ictamp_drake.scenes.spec import save_scene
from ictamp_drake.tamp.method import Method
from ictamp_drake.tamp.plan import Plan, write_plan
from ictamp_drake.tamp.plan_origin import Origin
from ictamp_drake.tamp.solve import Solution
from ictamp_drake.tamp.task import Task

Artefacts = Literal["all", "plan", "none"]


def write_artefacts(solution: Solution, folder: Path, which: Artefacts) -> None:
    """Write scene.yaml and, for a verified plan, plan.yaml; for "all" also the pages; for "none" nothing."""
    if which == "none":
        return
    folder.mkdir(parents=True, exist_ok=True)
    write_result(solution, folder)
    if which == "all":
        write_pages(solution, folder)


def write_result(solution: Solution, folder: Path) -> None:
    """Write scene.yaml and, for a verified plan, plan.yaml."""
    save_scene(solution.task.spec, folder / "scene.yaml")
    if solution.plan is not None:
        write_plan(solution.plan, folder / "plan.yaml", solution.task.abstraction)


def keep_plan(task: Task, method: Method, folder: Path, event: Event) -> None:
    """Write plan.yaml, in place of an earlier one, when the event is that a plan was found and the search goes on."""
    if isinstance(event, PlanFound):
        folder.mkdir(parents=True, exist_ok=True)
        write_plan(Plan(task.spec, task.c, event.path, Origin.of(method)), folder / "plan.yaml", task.abstraction)


def write_pages(solution: Solution, folder: Path) -> None:
    """Write the tree, its pictures and the pages, see `pages.write_pages`."""
    from ictamp_drake.tamp import pages  # noqa: PLC0415  (drawing modules take long to load)

    pages.write_pages(solution, folder)
