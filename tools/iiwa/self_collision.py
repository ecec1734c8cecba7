"""Pairs of links of arm and gripper without collision test: `python -m tools.iiwa.self_collision` samples them.

The gripper's mount is that of `iiwa14_wsg50.yaml`, which lists the pairs of arm and gripper. The models list theirs.
"""

import math
from pathlib import Path

from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.parsing import Parser

from tools import self_collision
from tools.iiwa import iiwa, wsg
from tools.sdf_parts import Pair
from tools.self_collision import Probe

FILE = Path(__file__).parent / "self_collision.yaml"
SAMPLES = 1_000_000
"""Number of postures: this arm rarely touches itself."""
FINGERS: Pair = (wsg.LINKS[1], wsg.LINKS[2])
MOUNT_ANGLE = math.radians(135)
"""Rotation of the gripper relative to the flange about z [rad]."""


def robot_probe(ignored: tuple[Pair, ...]) -> Probe:
    """The arm with its gripper, without collision tests of these pairs of links of one model."""

    def add(parser: Parser) -> None:
        parser.AddModelsFromString(iiwa.iiwa_sdf(within(iiwa.LINKS, ignored)), "sdf")
        parser.AddModelsFromString(wsg.wsg_sdf(within(wsg.LINKS, ignored)), "sdf")
        plant = parser.plant()
        X_FH = RigidTransform(RotationMatrix.MakeZRotation(MOUNT_ANGLE), [0.0, 0.0, wsg.ADAPTER[1]])
        plant.WeldFrames(plant.world_frame(), plant.GetFrameByName(iiwa.LINKS[0]))
        plant.WeldFrames(plant.GetFrameByName(iiwa.LINKS[-1]), plant.GetFrameByName(wsg.LINKS[0]), X_FH)

    return Probe(add)


def ignored_pairs() -> tuple[Pair, ...]:
    """Pairs that need no test, in alphabetical order."""
    return self_collision.read_ignored_pairs(FILE, FINGERS)


def within(links: tuple[str, ...], pairs: tuple[Pair, ...]) -> tuple[Pair, ...]:
    """The pairs of these links only."""
    return tuple(pair for pair in pairs if set(pair) <= set(links))


if __name__ == "__main__":
    self_collision.write_shares(robot_probe(()), (*iiwa.LINKS, *wsg.LINKS), FILE, SAMPLES)
