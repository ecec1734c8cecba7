"""Whole searches against recorded ones: `pytest tests/planning --force-regen` rewrites the records on purpose."""

import json
import os
import subprocess
import sys
from dataclasses import asdict
from pathlib import Path
from typing import Any

import pytest
from pytest_regressions.file_regression import FileRegressionFixture

from ictamp_drake.estimators.constant import ConstantConfig
from ictamp_drake.planning.proportional import ProportionalConfig
from tests.toy_world import ToyWorld, encode, toy_planner

REPOSITORY = Path(__file__).parents[2]
GOLDEN = REPOSITORY / "tests" / "golden"
CASES: dict[str, tuple[ToyWorld, ProportionalConfig]] = {
    "sure": (ToyWorld(size=(2, 2)), ProportionalConfig()),
    "slipping": (ToyWorld(size=(2, 2), success=0.3), ProportionalConfig(W=2.0)),
    "door": (ToyWorld(size=(2, 1), doors={(2, 1): 0.15}, max_plans=1), ProportionalConfig()),
    "door_without_redrawing": (
        ToyWorld(size=(2, 1), doors={(2, 1): 0.15}, max_plans=1),
        ProportionalConfig(redraw=False),
    ),
    "walls": (ToyWorld(size=(2, 2), walls=((2, 0), (1, 1)), success=0.8, expansions=3), ProportionalConfig(W=3.0)),
    "unsolvable": (ToyWorld(size=(1, 1), walls=((1, 1),), expansions=1200), ProportionalConfig(W=50.0)),
}


def record(name: str) -> str:
    """Algorithm, parameters, toy model and the whole tree of one search."""
    world, rule = CASES[name]
    seed, steps, estimator = 5, 80, ConstantConfig()
    result = toy_planner(world, seed=seed, steps=steps, rule=rule, estimator=estimator.create()).run()
    contents: dict[str, Any] = {
        "algorithm": "proportional",
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


@pytest.mark.parametrize("hash_seed", ["0", "4242"])
def test_the_tree_does_not_depend_on_the_order_of_sets(hash_seed: str) -> None:
    program = "from tests.planning.test_golden_trees import record; print(record('walls'), end='')"
    run = subprocess.run(
        [sys.executable, "-c", program],
        cwd=REPOSITORY,
        env=os.environ | {"PYTHONHASHSEED": hash_seed},
        capture_output=True,
        text=True,
        check=True,
    )
    assert run.stdout == (GOLDEN / "walls.json").read_text(encoding="utf-8")
