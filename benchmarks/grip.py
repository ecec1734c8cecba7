"""How far boxes slide between the fingers, by mass and friction: `python benchmarks/grip.py`.

Three boxes on a table are picked up with each mass and friction, held for 10 s, and carried to the rack, with the
options for scenes of one's own. Then one of them is held and carried with fixed forces, and with finer time steps.
Writes the tables to benchmarks/grip.md. Takes about three minutes on one core.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path

import numpy as np
from pydrake.math import RigidTransform

from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.types import Action, Attempt, Configuration
from ictamp_drake.models.constants import MAX_GRIP_FORCE
from ictamp_drake.models.kinematics import forward
from ictamp_drake.reports import markdown
from ictamp_drake.scenes.levels import SUPPORTS
from ictamp_drake.scenes.spec import BoxSpec, SceneSpec
from ictamp_drake.tamp.method import SCENE_METHOD, Method
from ictamp_drake.tamp.task import Task, load
from ictamp_drake.world.commands import stand_still
from ictamp_drake.world.poses import to_transform

OUT = Path(__file__).with_suffix(".md")
MASSES = (0.05, 0.2, 0.5, 1.0, 1.8, 3.0)
FRICTIONS = (0.05, 0.2, 0.35, 0.6, 1.0, 2.0)
SIZES = ((0.05, 0.05, 0.05), (0.055, 0.065, 0.13), (0.05, 0.12, 0.06))
TALL = SIZES[1]
BOX = "brick"
HOLD = 10.0
"""Time for which a box is held [s]."""
METHOD = SCENE_METHOD.with_options(sampler="optimization")


@dataclass(frozen=True)
class Slide:
    """How a box has moved in the hand.

    Attributes:
        pads: Way of its point that was between the pads [mm].
        center: Way of its center [mm].
        turn: Angle [deg].
    """

    pads: float
    center: float
    turn: float

    @classmethod
    def between(cls, before: Configuration, after: Configuration) -> "Slide":
        """Compare two configurations."""
        X_GO, Y_GO = pose_in_hand(before), pose_in_hand(after)
        center = Y_GO.translation() - X_GO.translation()
        turn = np.degrees((X_GO.rotation().inverse() @ Y_GO.rotation()).ToAngleAxis().angle())
        pads = Y_GO @ X_GO.inverse().translation()
        return cls(1e3 * float(np.linalg.norm(pads)), 1e3 * float(np.linalg.norm(center)), float(turn))

    @classmethod
    def worst(cls, slides: Sequence["Slide"]) -> "Slide":
        """Combine the largest of each measure."""
        return cls(*(max(getattr(each, name) for each in slides) for name in ("pads", "center", "turn")))

    def cells(self) -> tuple[str, ...]:
        """Cells of a table."""
        return f"{self.pads:.1f}", f"{self.center:.1f}", f"{self.turn:.1f}"


@dataclass(frozen=True)
class Measured:
    """What happened to one box.

    Attributes:
        force: Grip force of each finger [N].
        held: Slide in 10 s of holding.
        carried: Largest slide in the transfer.
        duration: Duration of the transfer [s].
        dropped: Whether the fingers lost the box.
    """

    force: float
    held: Slide
    carried: Slide
    duration: float
    dropped: bool


def pose_in_hand(c: Configuration) -> RigidTransform:
    """X_GO of the box, with the arm at the origin."""
    return RigidTransform(forward(c.q[None, :7])[0]).inverse() @ to_transform(c.poses[BOX])


def make_scene(mass: float, friction: float, size: tuple[float, float, float] = TALL) -> SceneSpec:
    """One box on the table that belongs on the rack."""
    box = BoxSpec(size, (0.48, 0.27, size[2] / 2), (0.0, 0.0, 20.0), mass, friction)
    return SceneSpec(supports=SUPPORTS, boxes={BOX: box}, goal=f"(on {BOX} rack)")


def measure(task: Task, method: Method = METHOD, seed: int = 0) -> Measured:
    """Pick the box up, hold it, and carry it.

    Raises:
        RuntimeError: It is not picked up, or there is no motion for its transfer.
    """
    skills = method.skills.create(task.world, task.abstraction, task.physics, method.sampler_config)

    def attempt(c: Configuration, *action: str) -> Attempt[Configuration]:
        a = Action(action[0], action[1:])
        promised = task.domain.successor(task.abstraction(c), a)
        done = skills.attempt(c, a, promised, np.random.default_rng(seed))
        if done.successor is None or (action[0] == "pick" and done.successor.held != BOX):
            raise RuntimeError(f"{a}: {done.failure}, {done.detail}")
        return done

    c = attempt(task.c, "pick", BOX, "table").successor
    assert c is not None
    wait = stand_still("hold", HOLD, c.commanded, c.gripper, frozenset({BOX}))
    later = task.physics.run(c, (wait,)).c
    place = attempt(c, "place", BOX, "rack")
    duration = place.motion[0].duration
    moved = task.physics.run(c, place.motion[:1])
    assert moved.recording is not None
    slides = [Slide.between(c, frame.c) for frame in task.physics.frames(moved.recording)]
    dropped = later.held != BOX or moved.c.held != BOX
    return Measured(c.gripper.force, Slide.between(c, later), Slide.worst(slides), duration, dropped)


def find_grid() -> Iterator[list[str]]:
    """Yield a row for each mass and friction, with the worst of all boxes."""
    for mass, friction in product(MASSES, FRICTIONS):
        try:
            found = [measure(load(make_scene(mass, friction, size), METHOD)) for size in SIZES]
        except IctampError as error:
            if error.code != Code.TOO_HEAVY:
                raise
            yield [f"{mass:g}", f"{friction:g}", "refused", *7 * ["-"]]
            continue
        yield list_cells([f"{mass:g}", f"{friction:g}"], found)


def find_forces() -> Iterator[list[str]]:
    """Yield a row for each fixed force, without and with slower transfers."""
    for force, reserve in product((30.0, 45.0, MAX_GRIP_FORCE), (None, METHOD.skills.motion.carrying.reserve)):
        method = METHOD.with_options(skills=with_force(METHOD, force, reserve))
        found = measure(load(make_scene(1.8, 0.35), method), method)
        yield list_cells(["full" if reserve is None else "slowed down"], [found])


def with_force(method: Method, force: float, reserve: float | None) -> object:
    """Constants of skills that grip with one force, and slow transfers down only with a reserve."""
    skills = method.skills
    carrying = replace(skills.motion.carrying, reserve=reserve or 1.0, slide=0.0012 if reserve else 1.0)
    return replace(skills, pick=replace(skills.pick, force=force, safety=0.0), motion=replace(skills.motion, carrying=carrying))


def find_steps() -> Iterator[list[str]]:
    """Yield a row for each time step, always with the motion of the longest one."""
    for step in (0.004, 0.002, 0.001):
        method = METHOD.with_options(physics=replace(METHOD.physics, time_step=step))
        yield list_cells([f"{1e3 * step:g}"], [measure(load(make_scene(1.8, 0.35), method), method)])


def list_cells(first: list[str], found: Sequence[Measured]) -> list[str]:
    """Cells of a row."""
    forces = sorted({f"{each.force:.0f}" for each in found}, key=float)
    held, carried = (Slide.worst([getattr(each, name) for each in found]) for name in ("held", "carried"))
    if any(each.dropped for each in found):
        return [*first, " to ".join({forces[0]: 0, forces[-1]: 0}), *6 * ["dropped"], "-"]
    time = max(each.duration for each in found)
    return [*first, " to ".join({forces[0]: 0, forces[-1]: 0}), *held.cells(), *carried.cells(), f"{time:.1f}"]


if __name__ == "__main__":
    for row in find_grid():
        print(row, flush=True)
