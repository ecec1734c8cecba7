"""Predicates computed from poses and contacts: whether b carries a, and whether the hand grips a."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ictamp_drake.core.checks import check_fields
from ictamp_drake.core.types import Configuration
from ictamp_drake.world.world import FINGERS, Touch, World


@dataclass(frozen=True)
class PredicateConfig:
    """Tolerances of the predicates.

    Attributes:
        contact: Largest distance between touching surfaces [m]. A finger deeper than this in a box does not grip it.
        tilt: Largest tilt of a level box [rad].
        slope: Largest angle between the normal of a carrying contact and the vertical [rad].
    """

    contact: float = 0.0015
    tilt: float = 0.15
    slope: float = 0.3

    def __post_init__(self) -> None:
        check_fields(self, "predicates", contact=(1e-4, 0.02), tilt=(1e-3, 1), slope=(1e-3, 1.5))


@dataclass(frozen=True)
class Evaluation:
    """Value of a predicate with the quantities that decide it [m, rad]."""

    holds: bool
    quantities: Mapping[str, float]


class Scene:
    """A configuration with its contacts, evaluated once for all predicates."""

    def __init__(self, world: World, c: Configuration, config: PredicateConfig) -> None:
        self.world = world
        self.c = c
        self.config = config
        self.boxes = {name: world.upright_frame(c, name) for name in world.spec.boxes}
        touches = world.touches(c, config.contact)
        self._touches = {(t.a, t.b): t for t in touches}
        self._touches |= {(t.b, t.a): Touch(t.b, t.a, t.distance, -t.normal) for t in touches}
        self._carried: dict[tuple[str, str], Evaluation] = {}

    def evaluate_tilt(self, a: str) -> Evaluation:
        """Whether one of a's faces is level, with its tilt."""
        angle = float(np.arccos(np.clip(self.boxes[a].X_WU.rotation().matrix()[2, 2], -1.0, 1.0)))
        return Evaluation(angle <= self.config.tilt, {"tilt": angle})

    def evaluate_above(self, a: str, b: str) -> Evaluation:
        """Whether a touches b from above."""
        touch = self._touches.get((a, b))
        if touch is None:
            return Evaluation(False, {"distance": np.inf})
        slope = float(np.arccos(np.clip(touch.normal[2], -1.0, 1.0)))
        return Evaluation(slope <= self.config.slope, {"distance": touch.distance, "slope": slope})

    def evaluate_carried(self, a: str, b: str) -> Evaluation:
        """Whether b carries a: a touches b from above, its center of mass is over b's top face, and a is level."""
        if (a, b) not in self._carried:
            self._carried[a, b] = self._compute_carried(a, b)
        return self._carried[a, b]

    def _compute_carried(self, a: str, b: str) -> Evaluation:
        above, tilt = self.evaluate_above(a, b), self.evaluate_tilt(a)
        p_TA = self.world.X_WT(self.c, b).inverse() @ self.boxes[a].X_WU.translation()
        overhang = float(np.max(np.abs(p_TA[:2]) - self.world.top_size(self.c, b) / 2))
        holds = above.holds and tilt.holds and overhang <= 0 < p_TA[2]
        return Evaluation(holds, {**above.quantities, **tilt.quantities, "overhang": overhang})

    def evaluate_gripped(self, a: str) -> Evaluation:
        """Whether both fingers touch a and neither cuts into it."""
        distances = {f: self._touches[f, a].distance if (f, a) in self._touches else np.inf for f in FINGERS}
        return Evaluation(max(map(abs, distances.values())) <= self.config.contact, distances)
