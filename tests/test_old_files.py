"""Files from earlier versions can still be read: those in the repository, and a plan of format 1."""

from pathlib import Path

import numpy as np
import pytest
import yaml

from ictamp_drake.core.files import read_json
from ictamp_drake.learning.checkpoint import SHIPPED, SKILLS
from ictamp_drake.learning.dataset import open_table, scene
from ictamp_drake.learning.models import load_dynamics, load_estimator, load_skill
from ictamp_drake.runs.folder import read_config
from ictamp_drake.runs.records import read_records
from ictamp_drake.scenes.spec import load_scene
from ictamp_drake.tamp.plan import Plan, read_plan

ROOT = Path(__file__).parents[1]
RUNS = sorted(path.parent for path in (ROOT / "benchmarks" / "results").glob("*/results.jsonl"))
SCENES = sorted((ROOT / "benchmarks" / "scenes").rglob("*.yaml")) + sorted((ROOT / "ictamp_drake").rglob("[0-9]*.yaml"))
SHARDS = sorted((ROOT / "benchmarks").rglob("*.parquet"))

PLAN_1 = """\
format: 1
scene:
  supports: {table: {kind: table, position: [0.3, 0.0, 0.0]}}
  boxes: {red_box: {size: [0.05, 0.05, 0.1], position: [0.5, 0.1, 0.05], colour: [1.0, 0.0, 0.0]}}
  goal: (on red_box table)
initial:
  q: [0.0, -0.8, 0.0, -2.4, 0.0, 1.6, 0.8, 0.04, 0.04]
  poses:
    red_box: [1.0, 0.0, 0.0, 0.0, 0.5, 0.1, 0.05]
skeleton: ['pick(red_box, table)']
steps:
- action: pick(red_box, table)
  k: [0.0, 0.0, 0.01, 1.5]
  segments:
  - label: grasp
    start: 0.0
    duration: 0.5
    gripper: {width: 0.0, force: 20.0}
    order: 1
    knots: [0.0, 0.5]
    control_points:
    - [0.0, -0.8, 0.0, -2.4, 0.0, 1.6, 0.8]
"""


@pytest.mark.parametrize("folder", RUNS, ids=lambda folder: folder.name)
def test_recorded_runs_are_read(folder: Path) -> None:
    records = read_records(folder / "results.jsonl")
    assert len(records) > 10
    assert all(str(record.explanation) for record in records.values())
    assert read_config(folder / "config.yaml")["sessions"]


def test_the_recorded_search_is_read() -> None:
    assert read_json(ROOT / "benchmarks" / "results" / "search" / "tree.json")["nodes"]


def test_scenes_are_read() -> None:
    assert len(SCENES) > 200
    assert all(load_scene(path).boxes for path in SCENES)


@pytest.mark.parametrize("path", SHARDS, ids=lambda path: path.stem)
def test_recorded_attempts_are_read(path: Path) -> None:
    texts = set(open_table(path.parent).to_table(columns=["spec"]).column("spec").to_pylist())
    assert all(scene(text).boxes for text in texts)


@pytest.mark.parametrize("skill", SKILLS)
def test_shipped_networks_are_read(skill: str) -> None:
    for load in (load_skill, load_estimator, load_dynamics):
        assert load(SHIPPED, skill) is not None


def test_a_plan_of_format_1_is_read(tmp_path: Path) -> None:
    path = tmp_path / "plan.yaml"
    path.write_text(PLAN_1)
    plan = read_plan(path)
    (attempt,), (segment,) = plan.attempts, plan.attempts[0].motion
    assert str(attempt.action) == "pick(red_box, table)"
    assert attempt.k is not None
    np.testing.assert_array_equal(attempt.k, [0.0, 0.0, 0.01, 1.5])
    np.testing.assert_array_equal(plan.c.commanded, plan.c.q)
    assert plan.c.x is None
    assert (segment.label, segment.gripper.force, segment.touches) == ("grasp", 20.0, None)
    assert segment.control_points.shape == (1, 7)


def test_a_plan_of_format_1_becomes_one_of_today(tmp_path: Path) -> None:
    path = tmp_path / "plan.yaml"
    path.write_text(PLAN_1)
    plan = read_plan(path)
    plan.save(path)
    assert yaml.safe_load(path.read_text())["format"] > 1
    again = Plan.load(path)
    assert (again.spec, again.c) == (plan.spec, plan.c)
