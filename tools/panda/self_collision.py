"""Pairs of links that need no collision test: `python -m tools.panda.self_collision` samples and writes them.

A pair is left out when it touches in nearly every configuration, so that a test says nothing, or in none of many. Drake
itself leaves out pairs joined by a joint or a weld.
"""

from collections import Counter
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
from ictamp_drake.models.panda import INERTIALS
from tools.panda.panda import Pair, panda_sdf

FILE = Path(__file__).parent / "self_collision.yaml"
SAMPLES = 100_000
SEED = 0
ALWAYS = 0.95
"""Share of configurations above which a pair counts as always touching."""

FINGERS: Pair = ("panda_leftfinger", "panda_rightfinger")
"""Fingers, which meet only where the limits of their joints stop them."""


class Probe:
    """A Panda alone in the world, to find which of its links touch."""

    def __init__(self, sdf: str) -> None:
        builder = DiagramBuilder()
        plant, scene_graph = AddMultibodyPlantSceneGraph(builder, time_step=0.0)
        self.plant, self.scene_graph = plant, scene_graph
        parser = Parser(plant)
        add_package(parser)
        (self._panda,) = parser.AddModelsFromString(sdf, "sdf")
        plant.WeldFrames(plant.world_frame(), plant.GetFrameByName("panda_link0"))
        plant.Finalize()
        self._context = builder.Build().CreateDefaultContext()

    def touching_pairs(self, q: FloatArray) -> frozenset[Pair]:
        """Pairs of links that touch at the joint positions q, shape (9,)."""
        self.plant.SetPositions(self.plant.GetMyContextFromRoot(self._context), self._panda, q)
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
        """Random joint positions, uniform within the limits, with both fingers alike, shape (9,)."""
        q = rng.uniform(self.plant.GetPositionLowerLimits(), self.plant.GetPositionUpperLimits())
        q[8] = q[7]
        return np.asarray(q)


def shares(sdf: str, samples: int, seed: int) -> dict[Pair, float]:
    """Share of random configurations in which each pair of links touches. Every pair has an entry."""
    probe, rng = Probe(sdf), np.random.default_rng(seed)
    counts: Counter[Pair] = Counter()
    for _ in range(samples):
        counts.update(probe.touching_pairs(probe.random_positions(rng)))
    return {pair: counts[pair] / samples for pair in combinations(sorted(INERTIALS), 2)}


def _pair(key: str) -> Pair:
    first, second = key.split()
    return first, second


def ignored_pairs() -> tuple[Pair, ...]:
    """Pairs that need no test, in alphabetical order."""
    found = yaml.safe_load(FILE.read_text())["shares"]
    pairs = {_pair(key) for key, share in found.items() if share == 0.0 or share >= ALWAYS}
    return tuple(sorted(pairs | {FINGERS}))


def main() -> None:
    """Sample and write the shares."""
    found = shares(panda_sdf(()), SAMPLES, SEED)
    record = {"samples": SAMPLES, "seed": SEED, "shares": {" ".join(pair): share for pair, share in found.items()}}
    FILE.write_text(yaml.safe_dump(record, sort_keys=False))


if __name__ == "__main__":
    main()
