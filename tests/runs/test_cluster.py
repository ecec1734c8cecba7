"""A sweep on a real Ray cluster of two nodes, one of which is killed during the sweep."""

import os
import time
from collections.abc import Iterator, Sequence
from pathlib import Path

import pytest
from ray.cluster_utils import Cluster

from ictamp_drake.core.errors import Code
from ictamp_drake.runs.board import Board
from ictamp_drake.runs.cluster import connect_cluster
from ictamp_drake.runs.conduct import Conduct
from ictamp_drake.runs.engine import EngineConfig
from ictamp_drake.runs.jobs import Job, Problem
from ictamp_drake.runs.pool import end_with_parent
from ictamp_drake.runs.records import Record, read_records
from ictamp_drake.runs.sweep import sweep
from ictamp_drake.scenes.levels import problem_files
from ictamp_drake.scenes.spec import load_scene
from ictamp_drake.tamp.method import Method
from tests.refusals import refusal
from tests.runs.clusters import two_nodes
from tests.runs.programs import timeless

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def cluster() -> Iterator[Cluster]:
    with two_nodes() as cluster:
        yield cluster


def square_or_fail(number: int) -> int:
    """Return a result, raise an error, die or never end."""
    if number == 1:
        raise ValueError("one")
    if number == 2:
        os._exit(5)
    if number == 3:
        time.sleep(600)
    return number * number


def test_a_task_that_fails_dies_or_hangs_takes_no_other_with_it(cluster: Cluster) -> None:
    with connect_cluster(cluster.address, end_with_parent) as engine:
        futures = [engine.submit(square_or_fail, number, timeout=20.0) for number in range(5)]
        assert futures[0].result() == 0
        assert futures[4].result() == 16
        with pytest.raises(ValueError, match="one"):
            futures[1].result()
        with pytest.raises(Exception, match="WorkerDied"):
            futures[2].result()
        with pytest.raises(TimeoutError):
            futures[3].result()


def jobs() -> list[Job]:
    """Single steps of six problems."""
    method = Method(max_steps=1, time_limit=200.0)
    return [
        Job(Problem(path.stem, load_scene(path), "easy"), method, "p-score") for path in problem_files("easy", "0:6")
    ]


def test_a_node_that_dies_in_mid_sweep_costs_nothing(cluster: Cluster, tmp_path: Path) -> None:
    told: list[Record] = []

    def kill_a_node_after_the_first(_: Board, records: Sequence[Record]) -> None:
        told.extend(records)
        if told and len(cluster.list_all_nodes()) == 2:
            cluster.remove_node(cluster.list_all_nodes()[1], allow_graceful=False)

    on_cluster = Conduct(artefacts="plan", engine=EngineConfig("ray", ray_address=cluster.address))
    assert sweep(jobs(), tmp_path, on_cluster, kill_a_node_after_the_first)
    assert len(cluster.list_all_nodes()) == 1
    lines = (tmp_path / "results.jsonl").read_text().splitlines()
    assert len(lines) == len(told) == 6
    here = tmp_path / "here"
    here.mkdir()
    assert sweep(jobs(), here, Conduct(artefacts="plan"), lambda *_: None)
    ours, theirs = (read_records(folder / "results.jsonl") for folder in (here, tmp_path))
    assert {name: timeless(record) for name, record in ours.items()} == {name: timeless(theirs[name]) for name in ours}
    scenes = [sorted(folder.glob("p-score/0/*/scene.yaml")) for folder in (here, tmp_path)]
    assert len(scenes[0]) == len(scenes[1]) == 6


def test_an_address_where_nobody_answers_is_refused(tmp_path: Path) -> None:
    conduct = Conduct(engine=EngineConfig("ray", ray_address="127.0.0.1:1"))
    with refusal(Code.NOT_REACHABLE, "ray-address", value="127.0.0.1:1"):
        sweep(jobs(), tmp_path, conduct, lambda *_: None)
