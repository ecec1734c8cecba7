"""The initial configuration c_0 of a scene, or an error that explains why the scene cannot start."""

from collections.abc import Sequence

import numpy as np

from ictamp_drake.core.checks import check_range
from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.types import Atom, Configuration, State
from ictamp_drake.robots.grip import check_weight
from ictamp_drake.scenes.spec import check_widths
from ictamp_drake.world.abstraction import SceneAbstraction
from ictamp_drake.world.config import PredicateConfig
from ictamp_drake.world.resting import explain_loose, show_length
from ictamp_drake.world.simulate import Physics
from ictamp_drake.world.world import Touch, World

MAX_OVERLAP = 0.001
"""Largest overlap of two bodies at the start [m]. Physics pushes them apart."""


def start_configuration(world: World, abstraction: SceneAbstraction, physics: Physics) -> tuple[Configuration, State]:
    """c_0, the scene as specified after it has come to rest, and H(c_0).

    Args:
        world, abstraction, physics: World, H and simulator of the scene.

    Raises:
        IctampError: A joint is beyond its limits, bodies overlap, nothing carries a box, the hand does not hold the
            box of `start.held` or cannot hold it, or the scene is not at rest.
    """
    _check_joints(world)
    check_widths(world.spec)
    c, held = world.initial_configuration(), world.spec.start.held
    check_overlaps(world, c, "boxes")
    state = abstraction(c)
    _check_carried(world, c, state, abstraction.config)
    if held:
        check_weight(world.spec.boxes[held].mass, world.spec.boxes[held].friction, world.robot.gripper, f"boxes.{held}")
    if held and Atom("in-hand", (held,)) not in state:
        problem = "expected a box between the fingers that rests on nothing, got {value}"
        raise IctampError(Code.NOT_HELD, problem, field="start.held", value=held)
    outcome = physics.run(c, ())
    reached = abstraction(outcome.c)
    moved = sorted({atom.args[0] for atom in reached ^ state if atom.args})
    if moved or not outcome.settled:
        waited = f"the boxes do not come to rest within {physics.config.settle_time:g} s"
        what = f"gravity moves {_list_moves(c, outcome.c, moved)}" if moved else waited
        field = f"boxes.{moved[0]}" if len(moved) == 1 else "boxes"
        raise IctampError(Code.NOT_AT_REST, f"expected a scene at rest, but {what}", field=field, value=moved)
    if held and outcome.c.held != held:
        problem = "the fingers do not hold {value} when gravity acts"
        raise IctampError(Code.NOT_HELD, problem, field="start.held", value=held)
    return outcome.c, reached


def _check_joints(world: World) -> None:
    joints, robot = world.spec.start.joints, world.robot
    if joints and len(joints) != len(robot.joints):
        problem = f"expected {len(robot.joints)} numbers, got {{value}}"
        raise IctampError(Code.WRONG_LENGTH, problem, field="start.joints", value=joints)
    for number, (position, lower, upper) in enumerate(zip(joints, robot.lower, robot.upper, strict=False)):
        check_range(f"start.joints[{number}]", position, lower, upper, " rad")


def find_overlaps(world: World, c: Configuration) -> list[Touch]:
    """Return the pairs of bodies in c that overlap more than physics can push apart."""
    supports = set(world.spec.supports)  # which may stand in each other
    touches = world.touches(c, 0.0)
    return [each for each in touches if each.distance < -MAX_OVERLAP and not {each.a, each.b} <= supports]


def check_overlaps(world: World, c: Configuration, field: str) -> None:
    """Raise IctampError, for a field, when bodies in c overlap more than physics can push apart."""
    for touch in find_overlaps(world, c):
        depth, most = show_length(-touch.distance), show_length(MAX_OVERLAP)
        problem = f"{touch.a} and {touch.b} overlap by {depth}, expected at most {most}"
        bodies = sorted((touch.a, touch.b))
        raise IctampError(Code.OVERLAP, problem, field=field, value=bodies, advice="move one of them")


def _check_carried(world: World, c: Configuration, state: State, config: PredicateConfig) -> None:
    carried = {atom.args[0] for atom in state if atom.predicate in {"on", "lying"}}
    for name in sorted(set(world.spec.boxes) - carried - {world.spec.start.held}):
        position = list(world.spec.boxes[name].position)
        raise IctampError(
            Code.NOT_CARRIED,
            explain_loose(world, c, name, config),
            field=f"boxes.{name}.position",
            value=position,
            choices=sorted({*world.spec.supports, *world.spec.boxes} - {name}),
        )


def _list_moves(before: Configuration, after: Configuration, boxes: Sequence[str]) -> str:
    """List those of the boxes whose centers have moved, and how far."""
    moves = {box: show_length(float(np.linalg.norm(after.poses[box][4:] - before.poses[box][4:]))) for box in boxes}
    return ", ".join(f"{box} by {distance}" for box, distance in moves.items() if distance != show_length(0.0))
