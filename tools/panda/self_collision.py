"""The Panda's pairs of links without collision test: `python -m tools.panda.self_collision` samples and writes them."""

from pathlib import Path

from pydrake.multibody.parsing import Parser

from ictamp_drake.models.panda import INERTIALS
from tools import self_collision
from tools.panda.panda import panda_sdf
from tools.sdf_parts import Pair
from tools.self_collision import Probe

FILE = Path(__file__).parent / "self_collision.yaml"
FINGERS: Pair = ("panda_leftfinger", "panda_rightfinger")


def panda_probe(ignored: tuple[Pair, ...]) -> Probe:
    """The Panda, without collision tests of these pairs."""

    def add(parser: Parser) -> None:
        parser.AddModelsFromString(panda_sdf(ignored), "sdf")
        plant = parser.plant()
        plant.WeldFrames(plant.world_frame(), plant.GetFrameByName("panda_link0"))

    return Probe(add)


def ignored_pairs() -> tuple[Pair, ...]:
    """Pairs that need no test, in alphabetical order."""
    return self_collision.read_ignored_pairs(FILE, FINGERS)


if __name__ == "__main__":
    self_collision.write_shares(panda_probe(()), INERTIALS, FILE)
