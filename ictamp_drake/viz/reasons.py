"""Reasons why there is no plan, as pages and pictures show them."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from ictamp_drake.viz.layout import REFUSED

MOVED, OBSTACLE, WHERE = REFUSED, "#e07b00", "#2f6fd0"
"""Colors of an object that could not be moved, of what stood in its way, and of where it stands or was to go."""

SHOWN = 4
"""Refused actions, and obstacles of each, that are named in words and marked in pictures."""


@dataclass(frozen=True, kw_only=True)
class RefusedAction:
    """An action that never succeeded.

    Attributes:
        action: The action, e.g. "pick(red_box, rack)".
        args: Arguments of the action, beginning with the object that it moves.
        refused: Number and causes of the refusals, e.g. "30 of 30 grasps refused: grasp or placement in collision".
        obstacles: Number of times that each object was in the way, the most frequent first.
        advice: Advice on what would help.
    """

    action: str
    args: tuple[str, ...]
    refused: str
    obstacles: Mapping[str, int] = field(default_factory=dict)
    advice: str = ""

    @property
    def colors(self) -> dict[str, str]:
        """The color that marks each thing; the place of the object only where nothing else explains the refusals."""
        moved, *where = self.args
        obstacles = list(self.obstacles)[:SHOWN]
        others = dict.fromkeys(obstacles, OBSTACLE) if obstacles else dict.fromkeys(where, WHERE)
        return {**others, moved: MOVED}


@dataclass(frozen=True)
class Reasons:
    """Reasons why a search found no plan.

    Attributes:
        ended: Reason why the search ended, as a clause; empty when it found a plan.
        refusals: Actions that never succeeded, the most often tried first.
        remarks: Further remarks, one clause each.
    """

    ended: str = ""
    refusals: tuple[RefusedAction, ...] = ()
    remarks: tuple[str, ...] = ()

    @property
    def colors(self) -> dict[str, str]:
        """The color that marks each thing in one picture; what could not be moved counts before what was in the way."""
        colors = [item for refusal in self.refusals[:SHOWN] for item in refusal.colors.items()]
        return {name: color for role in (WHERE, OBSTACLE, MOVED) for name, color in colors if color == role}


NO_REASONS = Reasons()
"""Those of a search that found a plan."""
