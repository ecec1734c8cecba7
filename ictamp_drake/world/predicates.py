"""Predicates computed from poses and contacts: whether b carries a, and whether the hand grips a."""

import numpy as np

from ictamp_drake.core.types import Configuration
from ictamp_drake.world.config import PredicateConfig
from ictamp_drake.world.world import FINGERS, Touch, World


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
        self._carried: dict[tuple[str, str], bool] = {}

    def is_level(self, a: str) -> bool:
        """Whether one of a's faces is level."""
        return self._angle(self.boxes[a].X_WU.rotation().matrix()[2, 2]) <= self.config.tilt

    def is_above(self, a: str, b: str) -> bool:
        """Whether a touches b from above."""
        touch = self._touches.get((a, b))
        return touch is not None and self._angle(touch.normal[2]) <= self.config.slope

    def is_carried(self, a: str, b: str) -> bool:
        """Whether b carries a: contact from above, the center of mass of a inside b's top face, and a level.

        A box in a region or at a pose is carried by that, and not by the support.
        """
        if (a, b) not in self._carried:
            support = self.world.spec.support_of(b)
            resting = self.is_above(a, support) and self.is_level(a) and self._is_over_top(a, support)
            self._carried[a, b] = resting and self._area(a, b) == b
        return self._carried[a, b]

    def _area(self, a: str, b: str) -> str:
        return self.world.area_at(b, self.boxes[a].X_WU, self.boxes[a].size)

    def _is_over_top(self, a: str, b: str) -> bool:
        p_TA = self.world.X_WT(self.c, b).inverse() @ self.boxes[a].X_WU.translation()
        overhang = np.max(np.abs(p_TA[:2]) - self.world.top_size(self.c, b) / 2)
        return bool(overhang <= 0 < p_TA[2])

    def is_gripped(self, a: str) -> bool:
        """Whether both fingers touch a, and none cuts into it."""
        touches = [self._touches.get((finger, a)) for finger in FINGERS]
        return all(touch is not None and abs(touch.distance) <= self.config.contact for touch in touches)

    @staticmethod
    def _angle(cosine: float) -> float:
        return float(np.arccos(np.clip(cosine, -1.0, 1.0)))
