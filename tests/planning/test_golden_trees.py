"""Whole searches agree with recorded ones: `pytest tests/planning --force-regen` rewrites the records on purpose."""

import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

import pytest
from pytest_regressions.file_regression import FileRegressionFixture

from ictamp_drake.estimators.constant import Constant, ConstantConfig
from ictamp_drake.planning.adaptive import AdaptiveConfig
from ictamp_drake.planning.els import ElsConfig
from ictamp_drake.planning.proportional import ProportionalConfig
from ictamp_drake.planning.round_robin import RoundRobinConfig
from ictamp_drake.planning.rule import RuleConfig
from ictamp_drake.planning.stap import StapConfig
from ictamp_drake.planning.uniform import UniformAllocationConfig
from tests.runs.programs import run_code
from tests.toy_world import ToyOptimizer, ToyWorld, encode, toy_planner

ALGORITHMS: dict[type, str] = {
    ProportionalConfig: "proportional",
    ElsConfig: "els",
    RoundRobinConfig: "round robin",
    UniformAllocationConfig: "uniform",
    StapConfig: "stap",
    AdaptiveConfig: "adaptive",
}
GOLDEN = Path(__file__).parents[1] / "golden"
WALLS = ToyWorld(size=(2, 2), walls=((2, 0), (1, 1)), success=0.8, expansions=3)
NARROW = ToyWorld(size=(2, 1), doors={(2, 1): 0.15}, max_plans=1)
SLIPPING = ToyWorld(size=(2, 2), success=0.3)
CASES: dict[str, tuple[ToyWorld, RuleConfig]] = {
    "sure": (ToyWorld(size=(2, 2)), ProportionalConfig()),
    "slipping": (SLIPPING, ProportionalConfig(W=2.0)),
    "door": (NARROW, ProportionalConfig()),
    "door_without_redrawing": (NARROW, ProportionalConfig(redraw=False)),
    "walls": (WALLS, ProportionalConfig(W=3.0)),
    "unsolvable": (ToyWorld(size=(1, 1), walls=((1, 1),), expansions=1200), ProportionalConfig(W=50.0)),
    "els": (WALLS, ElsConfig()),
    "els_3_1": (SLIPPING, ElsConfig(p_w=3.0, p_c=1.0)),
    "els_weighted": (SLIPPING, ElsConfig(weighted=True)),
    "round_robin": (WALLS, RoundRobinConfig()),
    "uniform": (SLIPPING, UniformAllocationConfig()),
    "stap": (ToyWorld(size=(2, 1), doors={(2, 1): 0.15}, success=0.8), StapConfig(plans=2)),
    "adaptive": (WALLS, AdaptiveConfig()),
    "adaptive_door": (NARROW, AdaptiveConfig()),
}


def record(name: str) -> str:
    """Algorithm, parameters, toy model and the whole tree of one search."""
    world, rule = CASES[name]
    seed, steps, estimator = 5, 80, ConstantConfig()
    asked = ToyOptimizer(world) if isinstance(rule, StapConfig) else Constant(estimator.P)
    result = toy_planner(world, seed=seed, steps=steps, rule=rule, estimator=asked).run()
    contents: dict[str, Any] = {
        "algorithm": ALGORITHMS[type(rule)],
        "parameters": asdict(rule) | {"estimator": asdict(estimator), "steps": steps, "seed": seed},
        "world": world.to_dict(),
        "stop_reason": result.stop_reason.name,
        "tree": result.tree.to_dict(encode),
    }
    return json.dumps(contents, indent=1) + "\n"


@pytest.mark.parametrize("name", CASES)
def test_the_search_grows_the_recorded_tree(name: str, file_regression: FileRegressionFixture) -> None:
    file_regression.check(record(name), fullpath=GOLDEN / f"{name}.json", encoding="utf-8")


def test_no_record_is_left_over() -> None:
    assert {path.stem for path in GOLDEN.glob("*.json")} == set(CASES)


@pytest.mark.parametrize("hash_seed", [0, 4242])
def test_the_tree_does_not_depend_on_the_order_of_sets(hash_seed: int) -> None:
    code = "from tests.planning.test_golden_trees import record; print(record('walls'), end='')"
    assert run_code(code, hash_seed) == (GOLDEN / "walls.json").read_text(encoding="utf-8")
