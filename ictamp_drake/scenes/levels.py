"""Levels of constrained packing: the contents of their scenes and their committed problem files."""

import itertools
import math
import re
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from importlib import resources
from pathlib import Path

from ictamp_drake.core.checks import check_choice
from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.models.things import BOXES, read_thing
from ictamp_drake.scenes.layout import Spot, Stack
from ictamp_drake.scenes.spec import (
    SUPPORT_SIZES,
    BoxSpec,
    SceneSpec,
    SupportSpec,
    Vector,
    load_scene,
    replace_robot,
)


@dataclass(frozen=True)
class Level:
    """A level of difficulty in the paper.

    Attributes:
        tower: Boxes to pack, from the bottom up.
        bystanders: Boxes outside the goal in every problem.
        extras: Further boxes, at least one of which is in every problem that is not plain.
        count: Number of committed problem files.
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
"""Number of committed problem files of each level. The last two levels are ours and have their own generators."""

LEVELS = tuple(COUNTS)

SIZES: dict[str, Vector] = {name: read_thing(name).size for name in BOXES}
"""Size of each box, by name [m]."""

SUPPORTS = {
    "table": SupportSpec(kind="table", position=(0.3, 0.0, 0.0)),
    "rack": SupportSpec(kind="rack", position=(0.44, -0.33, SUPPORT_SIZES["rack"][2]), yaw=90.0),
}
"""The table and the rack that stands on it."""


ARM_OFFSETS: dict[str, Vector] = {"iiwa14_wsg50": (0.0, 0.05, 0.4), "ur5e_2f85": (0.05, -0.05, 0.1)}
"""Position of each robot's base relative to the Panda's in the scenes of the levels [m].

Axes are those of the base. The offset brings table and rack well within reach; all else stays where it is. Other robots
stand where the Panda does.
"""


def boxes_of(stack: Stack, spot: Spot, floor: float = 0.0) -> dict[str, BoxSpec]:
    """Boxes of a stack at a spot on a top face of height `floor` [m]."""
    boxes = {}
    for name, offset, z, rotation, _ in stack:
        position = round(spot[0] + offset[0], 4), round(spot[1] + offset[1], 4), round(floor + z, 6)
        size, mass, friction, color = read_thing(name)
        boxes[name] = BoxSpec(size, position, rotation, mass, friction, color)
    return boxes


def goal_of(*towers: Sequence[str], tipped: Collection[str] = ()) -> str:
    """PDDL formula that all towers stand, each given from its support up. Tipped boxes lie in them."""
    steps = [step for tower in towers for step in itertools.pairwise(tower)]
    atoms = [f"({'lying' if above in tipped else 'on'} {above} {below})" for below, above in steps]
    return f"(and {' '.join(atoms)})"


def problem_files(level: str, selection: str = ":") -> list[Path]:
    """Committed problem files of a level, e.g. those of the selection 0:5.

    Raises:
        IctampError: The level does not exist, or the selection is malformed or empty.
    """
    check_choice("level", level, LEVELS)
    folder = Path(str(resources.files("ictamp_drake.scenes"))) / "problems" / level
    return [folder / f"{number:03d}.yaml" for number in parse_selection(selection, COUNTS[level], of=f" of {level}")]


def load_problem(path: Path, robot: str | None = None) -> SceneSpec:
    """Load a scene of a level, with another robot if one is given; see `place_robot`."""
    spec = load_scene(path, robot)
    return spec if robot is None else place_robot(spec, robot)


def place_robot(spec: SceneSpec, robot: str) -> SceneSpec:
    """Return a scene of a level with another robot, at its place in `ARM_OFFSETS`.

    Raises:
        IctampError: There is no such robot, or its file or models are not valid.
    """
    spec = replace_robot(spec, robot)
    if robot not in ARM_OFFSETS:
        return spec
    (x, y, z), (dx, dy, dz), yaw = spec.arm.position, ARM_OFFSETS[robot], math.radians(spec.arm.yaw)
    cos, sin = math.cos(yaw), math.sin(yaw)
    position = (x + cos * dx - sin * dy, y + sin * dx + cos * dy, z + dz)
    return replace(spec, arm=replace(spec.arm, position=position))


def parse_selection(selection: str, count: int, option: str = "problems", of: str = "") -> range:
    """Numbers below `count` from a number (3) or a slice (0:5, 10:, :).

    Args:
        selection: Text of the selection.
        count: Number of items to select from.
        option: Name of the option in messages.
        of: Source of the numbers in messages, e.g. " of hard".

    Raises:
        IctampError: The text is neither a number nor a slice, or selects no number below `count`.
    """
    match = re.fullmatch(r"([0-9]{0,18})(:?)([0-9]{0,18})", selection.strip())
    if match is None or selection.strip() == "":
        problem = "expected a number or a slice, such as 3, 0:5 or 10:, got {value}"
        raise IctampError(Code.WRONG_TYPE, problem, field=option, value=selection)
    start, colon, stop = match.groups()
    chosen = range(count)[int(start or 0) : int(stop) if stop else None] if colon else range(int(start), int(start) + 1)
    if not chosen or chosen[-1] >= count:
        problem = f"expected some of the numbers 0 to {count - 1}{of}, got {{value}}"
        raise IctampError(Code.OUT_OF_RANGE, problem, field=option, value=selection)
    return chosen
