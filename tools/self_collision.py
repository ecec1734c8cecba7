"""Pairs of links that need no collision test, found by sampling postures.

A pair is left out when it touches in nearly every posture, so that a test says nothing, or in none of many. Drake
itself leaves out pairs joined by a joint or a weld.
"""

from collections import Counter
from collections.abc import Callable, Iterable
from itertools import combinations
from pathlib import Path

import numpy as np
import yaml
from pydrake.geometry import PenetrationAsPointPair, QueryObject, SceneGraphInspector
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph
from pydrake.systems.framework import DiagramBuilder

from ictamp_drake.core.types import FloatArray
from ictamp_drake.models.package import add_package
from tools.sdf_parts import Pair

SAMPLES = 100_000
SEED = 0
ALWAYS = 0.95
"""Share of postures above which a pair counts as always touching."""


class Probe:
    """A robot alone in the world, to find which of its links touch.

    Args:
        add: What adds the robot to a plant and welds it. Its last two joints are the fingers, which move alike.
    """

    def __init__(self, add: Callable[[Parser], None]) -> None:
        builder = DiagramBuilder()
        self.plant, self.scene_graph = AddMultibodyPlantSceneGraph(builder, time_step=0.0)
        parser = Parser(self.plant)
        add_package(parser)
        add(parser)
        self.plant.Finalize()
        self._context = builder.Build().CreateDefaultContext()

    def touching_pairs(self, q: FloatArray) -> frozenset[Pair]:
        """Pairs of links that touch at the joint positions q, shape (joints,)."""
        self.plant.SetPositions(self.plant.GetMyContextFromRoot(self._context), q)
        query: QueryObject = self.scene_graph.get_query_output_port().Eval(
            self.scene_graph.GetMyContextFromRoot(self._context)
        )
        links = [self._links(query.inspector(), contact) for contact in query.ComputePointPairPenetration()]
        return frozenset(links)

    def _links(self, inspector: SceneGraphInspector, contact: PenetrationAsPointPair) -> Pair:
        frames = (inspector.GetFrameId(geometry) for geometry in (contact.id_A, contact.id_B))
        first, second = sorted(self.plant.GetBodyFromFrameId(frame).name() for frame in frames)
        return first, second

    def random_positions(self, rng: np.random.Generator) -> FloatArray:
        """Random joint positions, uniform within the limits, with both fingers alike, shape (joints,)."""
        q = rng.uniform(self.plant.GetPositionLowerLimits(), self.plant.GetPositionUpperLimits())
        q[-1] = q[-2]
        return np.asarray(q)


def shares(probe: Probe, links: Iterable[str], samples: int, seed: int) -> dict[Pair, float]:
    """Share of random postures in which each pair of links touches. Every pair has an entry."""
    rng = np.random.default_rng(seed)
    counts: Counter[Pair] = Counter()
    for _ in range(samples):
        counts.update(probe.touching_pairs(probe.random_positions(rng)))
    return {pair: counts[pair] / samples for pair in combinations(sorted(links), 2)}


def write_shares(probe: Probe, links: Iterable[str], file: Path, samples: int = SAMPLES) -> None:
    """Sample and write the shares."""
    found = shares(probe, links, samples, SEED)
    record = {"samples": samples, "seed": SEED, "shares": {" ".join(pair): share for pair, share in found.items()}}
    file.write_text(yaml.safe_dump(record, sort_keys=False))


def read_ignored_pairs(file: Path, fingers: Pair) -> tuple[Pair, ...]:
    """Pairs that need no test, in alphabetical order; the fingers meet only where their joints' limits stop them."""
    found = yaml.safe_load(file.read_text())["shares"]
    pairs = {_pair(key) for key, share in found.items() if share == 0.0 or share >= ALWAYS}
    return tuple(sorted(pairs | {fingers}))


def _pair(key: str) -> Pair:
    first, second = key.split()
    return first, second
