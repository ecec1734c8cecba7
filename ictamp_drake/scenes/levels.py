"""The levels of constrained packing, what their scenes consist of, and their committed problem files."""

import itertools
import re
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from importlib import resources
from pathlib import Path

from ictamp_drake.core.checks import check_choice
from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.models.things import BOXES, read_thing
from ictamp_drake.scenes.layout import Spot, Stack
from ictamp_drake.scenes.spec import SUPPORT_SIZES, BoxSpec, SupportSpec, Vector


@dataclass(frozen=True)
class Level:
    """A level of difficulty in the paper.

    Attributes:
        tower: the boxes to pack, from the bottom up.
        bystanders: the boxes outside the goal in every problem.
        extras: further ones, of which a problem that is not plain has at least one.
        count: how many problem files are committed.
    """

    tower: tuple[str, ...]
    bystanders: tuple[str, ...]
    extras: tuple[str, ...]
    count: int


PAPER_LEVELS = {
    "easy": Level(("cyan_box", "yellow_box"), ("red_box", "blue_box"), (), 55),
    "medium": Level(("cyan_box", "yellow_box", "red_box"), ("blue_box",), (), 37),
    "hard": Level(("cyan_box", "yellow_box", "red_box", "blue_box"), (), ("green_box", "purple_box"), 17),
}

COUNTS = {**{name: level.count for name, level in PAPER_LEVELS.items()}, "extreme": 30, "varied": 40}
"""How many problem files of each level are committed; the last two are ours, and made by generators of their own."""

LEVELS = tuple(COUNTS)

SIZES: dict[str, Vector] = {name: read_thing(name).size for name in BOXES}
"""Size of each box, by name [m]."""

SUPPORTS = {
    "table": SupportSpec(kind="table", position=(0.3, 0.0, 0.0)),
    "rack": SupportSpec(kind="rack", position=(0.44, -0.33, SUPPORT_SIZES["rack"][2]), yaw=90.0),
}
"""The table, and the rack that stands on it."""


def boxes_of(stack: Stack, spot: Spot, floor: float = 0.0) -> dict[str, BoxSpec]:
    """The boxes of a stack that stands at a spot on a top face of height `floor` [m]."""
    boxes = {}
    for name, offset, z, rotation, _ in stack:
        position = round(spot[0] + offset[0], 4), round(spot[1] + offset[1], 4), round(floor + z, 6)
        size, mass, friction, color = read_thing(name)
        boxes[name] = BoxSpec(size, position, rotation, mass, friction, color)
    return boxes


def goal_of(*towers: Sequence[str], tipped: Collection[str] = ()) -> str:
    """The PDDL formula that all towers stand, given from their supports up; tipped boxes lie in them."""
    steps = [step for tower in towers for step in itertools.pairwise(tower)]
    atoms = [f"({'lying' if above in tipped else 'on'} {above} {below})" for below, above in steps]
    return f"(and {' '.join(atoms)})"


def problem_files(level: str, selection: str = ":") -> list[Path]:
    """The committed problem files of a level, e.g. those of the selection 0:5.

    Raises:
        IctampError: when there is no such level or the selection is not understood or empty.
    """
    check_choice("level", level, LEVELS)
    folder = Path(str(resources.files("ictamp_drake.scenes"))) / "problems" / level
    return [folder / f"{number:03d}.yaml" for number in parse_selection(selection, COUNTS[level], of=f" of {level}")]


def parse_selection(selection: str, count: int, option: str = "problems", of: str = "") -> range:
    """Numbers below `count` from a number (3) or a slice (0:5, 10:, :).

    Args:
        selection: what was given.
        count: how many there are.
        option: that it was given for.
        of: what the numbers are of, e.g. " of hard".

    Raises:
        IctampError: when it is neither or selects nothing.
    """
    match = re.fullmatch(r"(\d*)(:?)(\d*)", selection.strip())
    if match is None or selection.strip() == "":
        problem = "expected a number or a slice, such as 3, 0:5 or 10:, got {value}"
        raise IctampError(Code.WRONG_TYPE, problem, field=option, value=selection)
    start, colon, stop = match.groups()
    chosen = range(count)[int(start or 0) : int(stop) if stop else None] if colon else range(int(start), int(start) + 1)
    if not chosen or chosen[-1] >= count:
        problem = f"expected some of the numbers 0 to {count - 1}{of}, got {{value}}"
        raise IctampError(Code.OUT_OF_RANGE, problem, field=option, value=selection)
    return chosen
