"""Actions that every plan of a task needs and that cannot be done, found by a sweep before the search."""

from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from functools import cache

import numpy as np
from pydrake.math import RigidTransform

from ictamp_drake.core.failures import Failure
from ictamp_drake.core.types import Action, Configuration
from ictamp_drake.planning.result import ActionReport
from ictamp_drake.skills.config import PickConfig, PlaceConfig, SkillsConfig
from ictamp_drake.skills.grid import Face
from ictamp_drake.skills.sweep import Sweep
from ictamp_drake.symbolic.atoms import held_box, objects_beneath, supporters
from ictamp_drake.symbolic.goal import Alternative, Goal
from ictamp_drake.symbolic.guides import boxes_to_move
from ictamp_drake.tamp.task import Task
from ictamp_drake.world.world import World


def find_impossible(task: Task, skills: SkillsConfig) -> tuple[ActionReport, ...]:
    """Find the actions that every plan needs and for which no parameter on the grid is free, and report on each.

    A goal with alternatives is impossible only if each alternative has such an action. Only the package's own skills
    are swept.

    Args:
        task: Task to solve.
        skills: Constants of the skills.
    """
    if type(skills.pick) is not PickConfig or type(skills.place) is not PlaceConfig or task.goal.holds(task.s):
        return ()
    sweep = Sweep(task.world, skills.motion, skills.pick, skills.place)
    refuse_grasps = cache(lambda box: sweep.refuse_grasps(task.c, box))
    refuse_placements = cache(
        lambda box, base, lower: sweep.refuse_placements(task.c, box, _face(task.world, task.c, base, lower))
    )
    reports: dict[Action, ActionReport] = {}
    for alternative in task.goal.alternatives:
        found = list(_Needs(task, alternative, refuse_grasps, refuse_placements).find_impossible())
        if not found:
            return ()
        reports.update({report.action: report for report in found})
    for action, report in reports.items():
        report.unreached += sweep.unreached.get((action.name, action.args[0]), [])
    return tuple(reports.values())


class _Needs:
    """Picks from initial poses and placements at the goal that every plan to one alternative needs."""

    def __init__(
        self,
        task: Task,
        goal: Alternative,
        refuse_grasps: Callable[[str], Counter[str] | None],
        refuse_placements: Callable[[str, str, tuple[str, ...]], Counter[str] | None],
    ) -> None:
        self._task = task
        self._refuse_grasps = refuse_grasps
        self._refuse_placements = refuse_placements
        self._target = goal.targets
        self._supporter = supporters(task.s)
        self._to_move = boxes_to_move(task.domain, Goal((goal,)), task.s)

    def find_impossible(self) -> Iterator[ActionReport]:
        """Yield a report on each needed action that is impossible, picks first."""
        for box in sorted(self._to_move):
            if (refused := self._refuse_grasps(box)) is not None:
                yield _make_report(Action("pick", (box, self._supporter[box])), refused)
        placed = [box for box in self._target if box in self._to_move or box == held_box(self._task.s)]
        for box in sorted(placed, key=lambda box: (-len([*objects_beneath(box, self._target)]), box)):  # highest first
            refusals = [self._refuse_placements(box, base, lower) for base, lower in self._list_places(box)]
            known = [each for each in refusals if each is not None]
            if known and len(known) == len(refusals):
                yield _make_report(Action("place", (box, self._target[box])), sum(known, Counter[str]()))

    def _list_places(self, box: str) -> list[tuple[str, tuple[str, ...]]]:
        """List places for the box in the goal: a base and the boxes on it. It will be put on one of them.

        Empty if they are unknown.
        """
        world = self._task.world
        beneath = list(objects_beneath(box, self._target))
        lower = [name for name in beneath if name in world.sizes]
        fixed = next((name for name in lower if self._is_stuck(name)), None)
        if fixed is not None:
            lower = lower[: lower.index(fixed)]
            bases = [fixed]
        elif beneath[-1] in world.spec.places:
            bases = beneath[-1:]
        else:
            spare = world.sizes.keys() - {box, *lower}
            bases = [] if spare else list(world.spec.supports)
        return [(base, tuple(lower)) for base in bases]

    def _is_stuck(self, box: str) -> bool:
        """Whether the box can never leave its initial pose, because it cannot be grasped, or one above it cannot."""
        above = (name for name in self._supporter if box in (name, *objects_beneath(name, self._supporter)))
        return box in self._supporter and any(self._refuse_grasps(name) is not None for name in above)


def _face(world: World, c: Configuration, base: str, lower: tuple[str, ...]) -> Face:
    """Return the face for the center of a box on top of these boxes, which stand on the base."""
    sizes = [world.upright_frame(c, name).size for name in lower]
    height = sum(float(size[2]) for size in sizes)
    play = sum(float(np.linalg.norm(size[:2])) / 2 for size in sizes)
    return Face(world.X_WT(c, base) @ RigidTransform([0.0, 0.0, height]), world.top_size(c, base) / 2 + play)


def _make_report(action: Action, refused: Mapping[str, int]) -> ActionReport:
    """Return the report of an action from its refused parameters by obstacle; an empty name is out of reach."""
    obstacles = Counter({name: count for name, count in refused.items() if name})
    total, hit = sum(refused.values()), obstacles.total()
    failures = Counter({Failure.GOAL_IN_COLLISION: hit, Failure.NO_INVERSE_KINEMATICS: total - hit})
    return ActionReport(action, total, +failures, obstacles=obstacles)
