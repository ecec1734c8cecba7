"""Tasks in this process end with results or errors, and those that take too long are ended."""

import os
import signal
import time
from contextlib import suppress

import numpy as np
import pytest
from threadpoolctl import threadpool_info

from ictamp_drake.runs.inline import start_inline
from ictamp_drake.scenes.spec import load_scene
from ictamp_drake.world.config import PhysicsConfig
from ictamp_drake.world.world import World
from tests.runs.programs import SCENE


def fail() -> None:
    raise ValueError("one")


def loop() -> None:
    """Catch every ordinary exception, and run forever."""
    while True:
        with suppress(Exception):
            time.sleep(0.01)


def test_a_task_returns_or_fails() -> None:
    begun: list[str] = []
    with start_inline(begun.append, "begun") as engine:
        assert begun == ["begun"]
        assert engine.submit(pow, 3, 2, timeout=60.0).result() == 9
        with pytest.raises(ValueError, match="one"):
            engine.submit(fail, timeout=60.0).result()


def test_a_task_that_takes_too_long_is_ended_whatever_it_catches() -> None:
    with start_inline(bool) as engine, pytest.raises(TimeoutError):
        engine.submit(loop, timeout=0.1).result()


def test_a_simulation_that_takes_too_long_is_ended(tmp_path) -> None:  # type: ignore[no-untyped-def]
    (tmp_path / "scene.yaml").write_text(SCENE)
    spec = load_scene(tmp_path / "scene.yaml")
    physics = PhysicsConfig(settle_time=1e3, rest_speed=1e-6, rest_turn=1e-6, settle_check=10.0).create(World(spec))
    c = World(spec).initial_configuration()
    with start_inline(bool) as engine, pytest.raises(TimeoutError):
        engine.submit(physics.run, c, (), timeout=0.1).result()


def test_no_alarm_is_left_and_an_earlier_one_goes_on() -> None:
    handler, before = signal.getsignal(signal.SIGALRM), signal.setitimer(signal.ITIMER_REAL, 1000.0)
    try:
        with start_inline(bool) as engine:
            engine.submit(pow, 3, 2, timeout=60.0).result()
        assert signal.getsignal(signal.SIGALRM) is handler
        assert 900.0 < signal.getitimer(signal.ITIMER_REAL)[0] <= 1000.0
    finally:
        signal.setitimer(signal.ITIMER_REAL, *before)


@pytest.mark.skipif((os.cpu_count() or 1) < 2, reason="needs a second core to tell")
def test_tasks_have_one_thread_and_others_what_they_had() -> None:
    def threads() -> set[int]:
        np.eye(2) @ np.eye(2)
        return {library["num_threads"] for library in threadpool_info() if library["user_api"] == "blas"}

    before = threads()
    with start_inline(bool) as engine:
        assert engine.submit(threads, timeout=60.0).result() == {1}
    assert threads() == before
