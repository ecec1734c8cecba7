"""Boxes that need no simulation: they are at rest, and nothing that moves touches them."""

from collections.abc import Collection, Iterable, Mapping

import numpy as np

from ictamp_drake.core.types import FloatArray
from ictamp_drake.world.plant import SimulatedScene
from ictamp_drake.world.world import ROBOT, Touch

NEAR = 1e-3
"""Largest distance at which two boxes count as touching [m]. Neither sleeps while the other is awake."""


class Sleepers:
    """Sleeping boxes of a simulated scene.

    Their joints are locked, so they are as firm as a wall. Contact with awake bodies remains and can be detected.

    Attributes:
        asleep: Names of the sleeping boxes.
    """

    def __init__(self, scene: SimulatedScene) -> None:
        plant = scene.plant
        instances = {name: body.model_instance() for name, body in scene.bodies.boxes.items()}
        self._context = scene.context
        self._joints = {name: plant.get_joint(plant.GetJointIndices(at)[0]) for name, at in instances.items()}
        self._velocities = {name: scene.velocities(at) for name, at in instances.items()}
        self.asleep: frozenset[str] = frozenset()

    def wake(self) -> None:
        """Wake all boxes."""
        self.let_sleep(frozenset())

    def let_sleep(self, names: frozenset[str]) -> None:
        """Put these boxes to sleep with zero velocity, and wake all others."""
        for name in sorted(self.asleep - names):
            self._joints[name].Unlock(self._context)
        for name in sorted(names - self.asleep):
            self._joints[name].Lock(self._context)
        self.asleep = names

    def find_moving(self, x: FloatArray, speed: float, turn: float) -> frozenset[str]:
        """Return the boxes that move faster than `speed` [m/s] or turn faster than `turn` [rad/s] in a plant state."""
        twists = ((name, x[places]) for name, places in self._velocities.items())
        return frozenset(n for n, v in twists if np.linalg.norm(v[3:]) > speed or np.linalg.norm(v[:3]) > turn)

    def find_accelerating(self, before: FloatArray, now: FloatArray, speed: float, turn: float) -> frozenset[str]:
        """Return the boxes that exceed `speed` [m/s] or `turn` [rad/s] now and are faster than before."""
        places = self._velocities
        faster = (n for n, at in places.items() if np.linalg.norm(now[at]) > np.linalg.norm(before[at]))
        return self.find_moving(now, speed, turn) & frozenset(faster)

    def find_connected(self, touches: Iterable[Touch], names: Collection[str]) -> frozenset[str]:
        """Return the named boxes, those that the arm touches, and all boxes connected to them by contact.

        This includes every box that rests or leans on one of them or carries it.

        Args:
            touches: All pairs within `NEAR` of each other.
            names: Names of bodies. Those that are not boxes are ignored.
        """
        neighbours: dict[str, set[str]] = {name: set() for name in self._joints}
        for touch in touches:
            for one, other in ((touch.a, touch.b), (touch.b, touch.a)):
                if one in neighbours:
                    neighbours[one].add(other)
        return _find_connected(neighbours, [name for name in neighbours if name in names or ROBOT & neighbours[name]])

    def is_disturbed(self, touches: Iterable[Touch], *, arm_alone: bool) -> bool:
        """Whether something awake touches a sleeping box. With `arm_alone`, any touch of the arm counts."""
        movable = self._joints.keys() | ROBOT
        for touch in touches:
            pair = {touch.a, touch.b}
            noticed = (arm_alone and pair & ROBOT) or (pair & self.asleep and pair & movable - self.asleep)
            if noticed and touch.distance <= 0:
                return True
        return False


def _find_connected(neighbours: Mapping[str, set[str]], start: Collection[str]) -> frozenset[str]:
    reached: set[str] = set()
    waiting = list(start)
    while waiting:
        name = waiting.pop()
        if name not in reached:
            reached.add(name)
            waiting += neighbours[name] & neighbours.keys()
    return frozenset(reached)
