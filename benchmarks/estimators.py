"""Computing time of the estimators: `python benchmarks/estimators.py`, processor time of one thread.

Scores 64 options of the search at once: every applicable action in the first configurations of packing problems.
"""

import time
from itertools import islice

import numpy as np
import torch
from rich.console import Console
from rich.table import Table

from ictamp_drake.core.types import Configuration, Skeleton
from ictamp_drake.estimators.context import EstimatorContext
from ictamp_drake.estimators.p_score import PScoreConfig
from ictamp_drake.estimators.q_value import QValueConfig
from ictamp_drake.scenes.levels import problem_files
from ictamp_drake.scenes.spec import load_scene
from ictamp_drake.symbolic.domain import Domain
from ictamp_drake.world.abstraction import SceneAbstraction
from ictamp_drake.world.world import World

OPTIONS, CALLS = 64, 200
ESTIMATORS = {
    "P": PScoreConfig(),
    "P, mean of 16 draws": PScoreConfig(draws=16),
    "P, mean of 4 draws": PScoreConfig(draws=4),
    "Q, one draw": QValueConfig(),
    "Q, mean of 16 draws": QValueConfig(draws=16),
    "Q along plans of one action, best of 16": QValueConfig(draws=16, best=True, horizon="plan"),
}


def options(world: World) -> list[tuple[Configuration, Skeleton]]:
    """Return options of one scene, repeated with boxes moved slightly so that all configurations differ."""
    abstraction, rng = SceneAbstraction(world), np.random.default_rng(0)
    c = world.initial_configuration()
    state = abstraction(c)
    successors = Domain.create(sorted(world.spec.boxes), sorted(world.spec.supports), state).successors(state)
    found = []
    while len(found) < OPTIONS:
        poses = {name: pose + np.append(np.zeros(4), rng.normal(scale=0.005, size=3)) for name, pose in c.poses.items()}
        moved = Configuration(c.q, c.fingers, poses, c.held, c.gripper)
        found += [(moved, Skeleton((state, after), (action,))) for action, after in successors]
    return found[:OPTIONS]


def main() -> None:
    """Time and print."""
    torch.set_num_threads(1)
    table = Table("estimator", "median [ms]", "90 % [ms]", title=f"{OPTIONS} options in one call")
    worlds = [World(load_scene(path)) for path in islice(problem_files("hard", ":"), 4)]
    for name, config in ESTIMATORS.items():
        samples = []
        for world in worlds:
            estimator, asked = config.create(EstimatorContext(world)), options(world)
            estimator.estimate(asked)
            for _ in range(CALLS // len(worlds)):
                start = time.process_time()
                estimator.estimate(asked)
                samples.append(1e3 * (time.process_time() - start))
        table.add_row(name, *(f"{np.quantile(samples, share):.2f}" for share in (0.5, 0.9)))
    Console().print(table)


if __name__ == "__main__":
    main()
