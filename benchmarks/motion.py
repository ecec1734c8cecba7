"""Computing time of motion planning: `python benchmarks/motion.py`.

Picks the highest box of every packing problem and carries it to a place above the rack. Then repeats transfers just
above the table among tall boxes, where the first guess fails. Measures the processor time of one thread, which other
processes disturb less than wall-clock time.
"""

import time
from collections import defaultdict
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from itertools import pairwise
from typing import TypeVar

import numpy as np
from pydrake.math import RigidTransform, RotationMatrix
from rich.console import Console
from rich.table import Table

from ictamp_drake.core.types import Configuration, FloatArray
from ictamp_drake.motion.planner import MotionPlanner, PlannedMotion, Refusal
from ictamp_drake.scenes.levels import problem_files
from ictamp_drake.scenes.spec import BoxSpec, SceneSpec, load_scene
from ictamp_drake.world.world import World

T = TypeVar("T")
DOWN = RotationMatrix.MakeXRotation(np.pi)
LIFT = np.array([0.0, 0.0, 0.06])


class Clock:
    """Milliseconds by stage."""

    def __init__(self) -> None:
        self.samples: dict[str, list[float]] = defaultdict(list)

    def time(self, name: str | Callable[[T], str], call: Callable[[], T]) -> T:
        """Return the call's result, and keep its time under a name, which may depend on the result."""
        start = time.process_time()
        result = call()
        milliseconds = 1e3 * (time.process_time() - start)
        self.samples[name if isinstance(name, str) else name(result)].append(milliseconds)
        return result


def stage(result: PlannedMotion | Refusal) -> str:
    """Row of the table to which a transfer belongs."""
    return f"transfer: {result.stage}" if isinstance(result, PlannedMotion) else f"transfer: {result.failure}"


def grasp(c: Configuration, box: str, size: FloatArray, q: FloatArray) -> Configuration:
    """Return c with the box in the hand."""
    return Configuration(q, np.full(2, size[1] / 2), c.poses, box)


def pick_and_carry(world: World, clock: Clock, rng: np.random.Generator) -> None:
    """Plan and time the motions of a pick and of the transfer after it."""
    planner, c = MotionPlanner(world), world.initial_configuration()
    box = max(c.poses, key=lambda name: c.poses[name][6])
    size = world.upright_frame(c, box).size
    X_WG = world.upright_frame(c, box).X_WU @ RigidTransform(DOWN, [0.0, 0.0, max(0.0, size[2] / 2 - 0.03)])
    above = RigidTransform(X_WG.rotation(), X_WG.translation() + LIFT)
    start = time.process_time()
    clock.time("new configuration", lambda: planner.scene.is_free(c, c.q))
    q = clock.time("posture", lambda: planner.posture(c, X_WG, c.q))
    if isinstance(q, Refusal):
        return
    back = clock.time("straight", lambda: planner.plan_straight(c, q, above))
    if isinstance(back, Refusal):
        return
    clock.time(stage, lambda: planner.transfer(c, c.q, back.trajectory.end, rng))
    held = grasp(c, box, size, q)
    clock.time("new configuration, holding", lambda: planner.scene.is_free(held, q))
    lift = clock.time("straight, holding", lambda: planner.plan_straight(held, q, above))
    clock.samples["whole pick"].append(1e3 * (time.process_time() - start))
    X_WG2 = RigidTransform(X_WG.rotation(), np.array([*world.spec.supports["rack"].position[:2], 0.4]))
    q2 = clock.time("posture", lambda: planner.posture(held, X_WG2, q))
    if isinstance(lift, PlannedMotion) and not isinstance(q2, Refusal):
        clock.time(stage, lambda: planner.transfer(held, lift.trajectory.end, q2, rng))


def forest(spec: SceneSpec, rng: np.random.Generator) -> SceneSpec:
    """Replace the boxes of a scene by seven tall ones."""
    boxes: dict[str, BoxSpec] = {}
    while len(boxes) < 7:
        x, y, height = rng.uniform(0.35, 0.65), rng.uniform(-0.15, 0.4), rng.choice([0.12, 0.24, 0.36])
        if all(np.hypot(x - box.position[0], y - box.position[1]) > 0.13 for box in boxes.values()):
            boxes[f"box_{len(boxes)}"] = BoxSpec(size=(0.05, 0.05, height), position=(x, y, height / 2))
    return replace(spec, boxes=boxes, goal="(on box_0 rack)")


def cross_forest(world: World, clock: Clock, rng: np.random.Generator) -> None:
    """Plan and time transfers among tall boxes."""
    planner, c = MotionPlanner(world), world.initial_configuration()
    qs: list[FloatArray] = []
    while len(qs) < 7:
        place = RigidTransform(DOWN, rng.uniform([0.3, -0.15, 0.06], [0.7, 0.4, 0.25]))
        q = planner.posture(c, place, planner.kinematics.comfortable_posture(place))
        if not isinstance(q, Refusal):
            qs.append(q)
    for q0, q1 in pairwise(qs):
        clock.time(lambda result: f"forest, {stage(result)}", partial(planner.transfer, c, q0, q1, rng))


def main() -> None:
    """Print one row per stage."""
    clock, rng = Clock(), np.random.default_rng(0)
    files = [file for level in ("easy", "medium", "hard") for file in problem_files(level)]
    for file in files:
        pick_and_carry(World(load_scene(file)), clock, rng)
    for _ in range(10):
        cross_forest(World(forest(load_scene(files[0]), rng)), clock, rng)
    table = Table("stage", "calls", "median [ms]", "90 % [ms]", "max [ms]")
    for name, times in sorted(clock.samples.items()):
        quantiles = np.quantile(times, [0.5, 0.9, 1.0])
        table.add_row(name, str(len(times)), *(f"{value:.1f}" for value in quantiles))
    Console().print(table)


if __name__ == "__main__":
    main()
