"""The initial configuration c_0 of a scene, or an error that explains why the scene cannot start."""

from ictamp_drake.core.checks import check_range
from ictamp_drake.core.errors import IctampError
from ictamp_drake.core.types import Atom, Configuration, State
from ictamp_drake.models.constants import ARM_LIMITS
from ictamp_drake.world.abstraction import SceneAbstraction
from ictamp_drake.world.simulate import Physics
from ictamp_drake.world.world import World

MAX_OVERLAP = 0.001
"""Largest overlap of two bodies at the start [m]. Physics pushes them apart."""


def start_configuration(
    world: World, abstraction: SceneAbstraction, physics: Physics, where: str
) -> tuple[Configuration, State]:
    """Return c_0, the scene as specified after it has come to rest, and H(c_0).

    Args:
        world, abstraction, physics: World, H and simulator of the scene.
        where: Name of the scene in errors, usually its file.

    Raises:
        IctampError: A joint is beyond its limits, bodies overlap, nothing carries a box, the hand does not hold the
            box of `start.held`, or the scene is not at rest.
    """
    _check_joints(world, where)
    c, held = world.initial_configuration(), world.spec.start.held
    _check_overlaps(world, c, where)
    state = abstraction(c)
    _check_carried(world, state, where)
    if held and Atom("in-hand", (held,)) not in state:
        raise IctampError(f"{where}: start.held is {held}, but it is not between the fingers or rests on something.")
    outcome = physics.run(c, ())
    reached = abstraction(outcome.c)
    moved = sorted({atom.args[0] for atom in reached ^ state if atom.args})
    if moved or not outcome.settled:
        what = f"boxes {', '.join(moved)} fall or move" if moved else "the boxes do not come to rest"
        raise IctampError(f"{where}: {what} as soon as gravity acts, but a scene must start at rest.")
    if held and outcome.c.held != held:
        raise IctampError(f"{where}: start.held is {held}, but the fingers do not hold it when gravity acts.")
    return outcome.c, reached


def _check_joints(world: World, where: str) -> None:
    joints = world.spec.start.joints
    if joints and len(joints) != len(ARM_LIMITS):
        raise IctampError(f"{where}: start.joints is {list(joints)}, but must be {len(ARM_LIMITS)} numbers")
    for number, (position, limits) in enumerate(zip(joints, ARM_LIMITS, strict=False), 1):
        check_range(f"{where}: start.joints, number {number},", position, limits.lower, limits.upper, " rad")


def _check_overlaps(world: World, c: Configuration, where: str) -> None:
    supports = set(world.spec.supports)  # supports may overlap each other
    for touch in world.touches(c, 0.0):
        if touch.distance < -MAX_OVERLAP and not {touch.a, touch.b} <= supports:
            depth = f"{-1000 * touch.distance:.0f} mm"
            raise IctampError(f"{where}: {touch.a} and {touch.b} overlap by {depth}; move one of them.")


def _check_carried(world: World, state: State, where: str) -> None:
    carried = {atom.args[0] for atom in state if atom.predicate in {"on", "lying"}}
    for name in sorted(set(world.spec.boxes) - carried - {world.spec.start.held}):
        position = list(world.spec.boxes[name].position)
        raise IctampError(
            f"{where}: boxes.{name}.position is {position}, where nothing carries the box: it must lie flat on one of "
            f"{', '.join(sorted({*world.spec.supports, *world.spec.boxes} - {name}))}, its centre above that one's top."
        )
