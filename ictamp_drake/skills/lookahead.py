"""Order of placements that prefers those from which the hand will reach what the plan stacks on top later."""

from collections.abc import Iterator
from itertools import chain, islice, pairwise, product

import numpy as np

from ictamp_drake.core.failures import Failure
from ictamp_drake.core.protocols import Sampler
from ictamp_drake.core.types import Configuration, FloatArray, Parameter, Skeleton
from ictamp_drake.models.hand import TIP
from ictamp_drake.motion.inverse_kinematics import ArmKinematics
from ictamp_drake.skills.config import PlaceConfig
from ictamp_drake.skills.geometry import level_pose
from ictamp_drake.symbolic.atoms import objects_beneath, supporters
from ictamp_drake.world.matrices import grasps
from ictamp_drake.world.world import World


class Lookahead:
    """Puts off placements that the rest of the plan cannot build on. It drops none.

    The test is kinematics alone: the hand points down, with G's x along W's x, and each later box lies wholly on the
    top face below and is gripped in its middle. A tower that leans towards the arm can be built although it fails the
    test.

    Args:
        world: The scene.
        arm: Kinematics of its arm.
        random: Sampler of random placements.
        draws: Number of placements taken from the action's sampler in one attempt, and then from `random`, before those
            put off have their turn.
        place: Constants of a placement. They say how far the hand rises above a box.
    """

    def __init__(
        self, world: World, arm: ArmKinematics, random: Sampler[Configuration], draws: int, place: PlaceConfig
    ) -> None:
        self._world = world
        self._arm = arm
        self._random = random
        self._draws = draws
        self._place = place

    def sort(
        self, c: Configuration, plan: Skeleton, drawing: Iterator[Parameter | Failure], rng: np.random.Generator
    ) -> Iterator[Parameter | Failure]:
        """Yield the parameters drawn for the plan's first action from c, with those put off after the others.

        Only placements are put off. Random ones come before them. A failure ends the drawing.
        """
        ahead = self._list_ahead(c, plan)
        if not ahead:
            yield from drawing
            return
        action, late = plan.actions[0], list[Parameter | Failure]()
        random = self._random.draws(c, action, rng)
        for k in chain(islice(drawing, self._draws), islice(random, self._draws)):
            if not isinstance(k, Failure) and self._is_within_reach(c, action.args[1], k, np.array(ahead)):
                yield k
                continue
            late.append(k)
            if isinstance(k, Failure):
                break
        yield from chain(late, drawing)

    def _list_ahead(self, c: Configuration, plan: Skeleton) -> list[FloatArray]:
        """List the boxes that the plan later stacks on the one that its first action places, if it places one.

        Returns:
            For each later box, the largest distance of its center from that of the first box along both axes of the
            first box's upright frame, and the height of G above the bottom of the first box when the hand has risen,
            shape (3,) [m].
        """
        box, sizes = plan.actions[0].args[0], {name: self._world.upright_frame(c, name).size for name in c.poses}
        ahead = []
        for before, after in pairwise(map(supporters, plan.states[1:])):
            if before.get(box) != after.get(box) or box not in before:
                break  # it is picked up again
            for name in after.keys() - before.keys():
                tower = [name, *objects_beneath(name, after)]
                if box in tower:
                    tower = tower[: tower.index(box) + 1]
                    size, *below = (sizes[each] for each in tower)
                    rise = max(self._place.drop, size[2] + TIP + self._place.margin)
                    room = [np.maximum(low[:2] - up[:2], 0) / 2 for up, low in pairwise([size, *below])]
                    ahead.append(np.append(sum(room), sum(each[2] for each in below) + rise))
        return ahead

    def _is_within_reach(self, c: Configuration, receptacle: str, k: Parameter, ahead: FloatArray) -> bool:
        """Whether the hand reaches each of the boxes ahead, shape (n, 3) [m], somewhere on the box placed with k."""
        X_WB = self._world.X_WT(c, receptacle) @ level_pose(k)
        spots = np.array([*product((-1, 0, 1), repeat=2)] if ahead[:, :2].any() else [(0, 0)])
        p_BG = np.dstack([ahead[:, None, :2] * spots, np.broadcast_to(ahead[:, 2:], (len(ahead), len(spots)))])
        p_WG = (X_WB @ p_BG.reshape(-1, 3).T).T
        times = self._arm.travel_times(grasps(np.insert(p_WG, 3, 0.0, axis=1)), c.q)
        return bool(np.isfinite(times).reshape(p_BG.shape[:2]).any(axis=1).all())
