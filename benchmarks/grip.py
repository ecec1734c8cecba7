"""How far boxes slide between the fingers, by mass and friction: `python benchmarks/grip.py`.

Three boxes on a table are picked up with each mass and friction, held for 10 s, and carried to the rack, with the
options for scenes of one's own. Then with one mass and friction at fixed forces, and with finer time steps.
Writes the tables to benchmarks/grip.md. Takes about five minutes on one core.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path

import numpy as np
from pydrake.math import RigidTransform

from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.types import Action, Attempt, Configuration, Skeleton
from ictamp_drake.motion.config import CarryingConfig
from ictamp_drake.reports import markdown
from ictamp_drake.robots.panda import forward
from ictamp_drake.robots.robot import find_robot
from ictamp_drake.scenes.levels import SUPPORTS
from ictamp_drake.scenes.spec import BoxSpec, SceneSpec
from ictamp_drake.skills.config import PickConfig
from ictamp_drake.tamp.method import SCENE_METHOD, Method
from ictamp_drake.tamp.task import Task, load
from ictamp_drake.world.commands import stand_still
from ictamp_drake.world.config import PhysicsConfig
from ictamp_drake.world.poses import to_transform

OUT = Path(__file__).with_suffix(".md")
MASSES = (0.05, 0.2, 0.5, 1.0, 1.8, 3.0)
FRICTIONS = (0.05, 0.2, 0.35, 0.6, 1.0, 2.0)
BOXES = (
    BoxSpec((0.05, 0.05, 0.05), (0.3, 0.36, 0.025), (0.0, 0.0, 0.0)),
    BoxSpec((0.055, 0.065, 0.13), (0.5, 0.3, 0.065), (0.0, 0.0, 10.0)),
    BoxSpec((0.05, 0.12, 0.06), (0.03, 0.38, 0.03), (0.0, 0.0, 60.0)),
)
HEAVY = (1.8, 0.35)
"""Mass [kg] and friction of the box that is held with fixed forces and fine time steps."""
SLIDING = 1e-3
"""Reserve with which nothing is slowed down."""
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
    def between(cls, before: Configuration, after: Configuration, box: str = BOX) -> "Slide":
        """Compare two configurations, with the arm at the origin."""
        X_GO, Y_GO = pose_in_hand(before, box), pose_in_hand(after, box)
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


def pose_in_hand(c: Configuration, box: str) -> RigidTransform:
    """X_GO of a box, with the arm at the origin."""
    return RigidTransform(forward(c.q[None])[0]).inverse() @ to_transform(c.poses[box])


def make_scene(box: BoxSpec, mass: float, friction: float) -> SceneSpec:
    """One box on the table that belongs on the rack."""
    boxes = {BOX: replace(box, mass=mass, friction=friction)}
    return SceneSpec(supports=SUPPORTS, boxes=boxes, goal=f"(on {BOX} rack)")


def measure_all(mass: float, friction: float, method: Method = METHOD) -> list[Measured]:
    """Measure all boxes with one mass and friction, each with two grasps and transfers."""
    tasks = [load(make_scene(box, mass, friction), method) for box in BOXES]
    return [measure(task, method, seed) for task in tasks for seed in range(2)]


def measure(task: Task, method: Method = METHOD, seed: int = 0) -> Measured:
    """Pick the box up, hold it, and carry it.

    Raises:
        RuntimeError: It is not picked up, or there is no motion for its transfer.
    """
    skills = method.skills.create(task.world, task.abstraction, task.physics, method.sampler_config)

    def attempt(c: Configuration, *action: str) -> Attempt[Configuration]:
        a, s = Action(action[0], action[1:]), task.abstraction(c)
        plan = Skeleton((s, task.domain.successor(s, a)), (a,))
        done = skills.attempt(c, plan, np.random.default_rng(seed))
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
        first = [f"{mass:g}", f"{friction:g}"]
        try:
            yield [*first, *list_cells(measure_all(mass, friction))]
        except IctampError as error:
            if error.code != Code.TOO_HEAVY:
                raise
            yield [*first, "refused", *7 * ["-"]]


def find_forces() -> Iterator[list[str]]:
    """Yield a row for each fixed force, at full speed and slowed down."""
    slow = METHOD.skills.motion.carrying
    for name, carrying in {"full": CarryingConfig(reserve=SLIDING, slide=1.0), "slowed down": slow}.items():
        for force in (30.0, 40.0, 50.0, find_robot().gripper.force):
            skills = replace(METHOD.skills, motion=replace(METHOD.skills.motion, carrying=carrying))
            method = METHOD.with_options(skills=replace(skills, pick=PickConfig(force=force, safety=0.0)))
            yield [name, *list_cells(measure_all(*HEAVY, method))]


def find_steps() -> Iterator[list[str]]:
    """Yield a row for each time step of physics."""
    for step in (0.004, 0.002, 0.001):
        method = METHOD.with_options(physics=PhysicsConfig(time_step=step))
        yield [f"{1e3 * step:g}", *list_cells(measure_all(*HEAVY, method))]


def list_cells(found: Sequence[Measured]) -> list[str]:
    """Cells of a row: forces, the worst slides, and the longest transfer."""
    forces = dict.fromkeys(f"{force:.0f}" for force in sorted(each.force for each in found))
    force = " to ".join([*forces][:: max(1, len(forces) - 1)])
    if any(each.dropped for each in found):
        return [force, *6 * ["-"], "dropped"]
    held, carried = (Slide.worst([getattr(each, name) for each in found]) for name in ("held", "carried"))
    return [force, *held.cells(), *carried.cells(), f"{max(each.duration for each in found):.1f}"]


def main() -> None:
    """Measure and write the tables."""
    slides = [f"{when}: {what}" for when in ("10 s", "transfer") for what in ("slide [mm]", "center [mm]", "turn [°]")]
    columns = ["force [N]", *slides, "transfer [s]"]
    heavy = "{:g} kg with friction {:g}".format(*HEAVY)
    text = [
        "# How far boxes slide between the fingers",
        "",
        "By `python benchmarks/grip.py`: three boxes, each at its own place on the table, are picked up, held for",
        "10 s, and carried to the rack, all twice; the worst counts. Slide is the way of the point that was between",
        "the pads, center that of the center of the box, which is farther when the box turns. In the transfer, the",
        "largest at any time counts.",
        "",
        "## Mass and friction",
        "",
        "A box is refused when the hand cannot hold it with twice the friction that its weight takes.",
        "",
        *markdown.table(["mass [kg]", "friction", *columns], list(find_grid()), left=0),
        "",
        f"## Fixed forces: {heavy}",
        "",
        *markdown.table(["speed", *columns], list(find_forces())),
        "",
        f"## Time steps: {heavy}",
        "",
        *markdown.table(["step [ms]", *columns], list(find_steps()), left=0),
    ]
    OUT.write_text("\n".join(text) + "\n")
    print(OUT.read_text())


if __name__ == "__main__":
    main()
