"""The configuration c_0 that a scene starts from, or a sentence about why the scene cannot start."""

from ictamp_drake.core.errors import IctampError
from ictamp_drake.core.types import Configuration, State
from ictamp_drake.world.abstraction import Abstraction
from ictamp_drake.world.simulate import Physics
from ictamp_drake.world.world import World

MAX_OVERLAP = 0.001
"""Bodies may be this deep in each other at the start [m]; physics pushes them apart."""


def start_configuration(world: World, abstraction: Abstraction, physics: Physics, where: str) -> Configuration:
    """c_0, the scene as specified after it has come to rest.

    Args:
        world, abstraction, physics: of the scene.
        where: named in errors, usually the scene's file.

    Raises:
        IctampError: bodies overlap, a box is carried by nothing, or the scene is not at rest.
    """
    c = world.initial_configuration()
    _check_overlaps(world, c, where)
    state = abstraction(c)
    _check_carried(world, state, where)
    outcome = physics.run(c, ())
    moved = sorted({atom.args[0] for atom in abstraction(outcome.c) ^ state if atom.args})
    if moved or not outcome.settled:
        what = f"boxes {', '.join(moved)} fall or move" if moved else "the boxes do not come to rest"
        raise IctampError(f"{where}: {what} as soon as gravity acts, but a scene must start at rest.")
    return outcome.c


def _check_overlaps(world: World, c: Configuration, where: str) -> None:
    supports = set(world.spec.supports)  # which may stand in each other
    for touch in world.touches(c, 0.0):
        if touch.distance < -MAX_OVERLAP and not {touch.a, touch.b} <= supports:
            depth = f"{-1000 * touch.distance:.0f} mm"
            raise IctampError(f"{where}: {touch.a} and {touch.b} overlap by {depth}; move one of them.")


def _check_carried(world: World, state: State, where: str) -> None:
    carried = {atom.args[0] for atom in state if atom.predicate in {"on", "lying"}}
    for name in sorted(set(world.spec.boxes) - carried):
        position = list(world.spec.boxes[name].position)
        raise IctampError(
            f"{where}: boxes.{name}.position is {position}, where nothing carries the box: it must lie flat on one of "
            f"{', '.join(sorted({*world.spec.supports, *world.spec.boxes} - {name}))}, its centre above that one's top."
        )
