"""Worker processes that fail, die, hang or cannot start."""

import os
import signal
import time
from pathlib import Path

import pytest

from ictamp_drake.runs import pool as pool_module
from ictamp_drake.runs.pool import WorkerDied, end_with_parent, start_pool


def square(number: int) -> int:
    return number * number


def fail() -> None:
    raise ValueError("one")


def die() -> None:
    os._exit(5)


def die_at_first(counter: Path) -> None:
    """Start only when others have died before."""
    with counter.open("a") as file:
        file.write("x")
    if len(counter.read_text()) < 4:
        os.kill(os.getpid(), signal.SIGKILL)


def name_process(_: int) -> int:
    return os.getpid()


def blocked_signals() -> tuple[set[signal.Signals], object]:
    return set(signal.pthread_sigmask(signal.SIG_BLOCK, [])), signal.getsignal(signal.SIGINT)  # type: ignore[arg-type]


def leave_a_file(content: str) -> str:
    """Write a temporary file, and leave it."""
    import tempfile  # noqa: PLC0415

    with tempfile.NamedTemporaryFile("w", delete=False) as file:
        file.write(content)
    return file.name


def test_a_task_that_fails_dies_or_hangs_takes_no_other_with_it() -> None:
    with start_pool(2, end_with_parent) as pool:
        good = [pool.submit(square, number, timeout=60.0) for number in range(3)]
        failing, dying = pool.submit(fail, timeout=60.0), pool.submit(die, timeout=60.0)
        hanging = pool.submit(time.sleep, 600.0, timeout=0.2)
        good += [pool.submit(square, number, timeout=60.0) for number in range(3, 200)]
        assert [future.result(60.0) for future in good] == [number * number for number in range(200)]
        with pytest.raises(ValueError, match="one"):
            failing.result(60.0)
        with pytest.raises(WorkerDied, match="exit code 5"):
            dying.result(60.0)
        with pytest.raises(TimeoutError):
            hanging.result(60.0)


def test_what_cannot_travel_is_an_error_of_its_task() -> None:
    with start_pool(1, end_with_parent) as pool:
        there = pool.submit(lambda: 0, timeout=60.0)
        back = pool.submit(eval, "lambda: 0", timeout=60.0)
        with pytest.raises(Exception, match="pickle"):
            there.result(60.0)
        with pytest.raises(RuntimeError, match="pickle"):
            back.result(60.0)
        assert pool.submit(square, 3, timeout=60.0).result(60.0) == 9


def test_workers_that_die_before_they_are_ready_are_replaced(tmp_path: Path) -> None:
    with start_pool(1, die_at_first, tmp_path / "counter") as pool:
        assert pool.submit(square, 3, timeout=60.0).result(60.0) == 9
    assert (tmp_path / "counter").read_text() == "xxxx"


def test_a_pool_whose_workers_never_start_gives_up(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pool_module, "STARTS", 2)
    with start_pool(2, die) as pool:
        futures = [pool.submit(square, number, timeout=60.0) for number in range(20)]
        for future in futures:
            with pytest.raises(WorkerDied):
                future.result(60.0)


def test_a_start_that_fails_is_the_error_of_each_task() -> None:
    with start_pool(1, fail) as pool, pytest.raises(ValueError, match="one"):
        pool.submit(square, 3, timeout=60.0).result(60.0)


def test_a_worker_is_replaced_after_some_tasks(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pool_module, "TASKS", 3)
    with start_pool(1, end_with_parent) as pool:
        futures = [pool.submit(name_process, number, timeout=60.0) for number in range(7)]
        processes = [future.result(60.0) for future in futures]
    assert [processes.count(process) for process in dict.fromkeys(processes)] == [3, 3, 1]


def test_a_worker_never_hears_ctrl_c() -> None:
    """Not even before its first line of Python."""
    with start_pool(1, end_with_parent) as pool:
        blocked, handler = pool.submit(blocked_signals, timeout=60.0).result(60.0)
    assert signal.SIGINT in blocked
    assert handler == signal.SIG_IGN
    assert signal.SIGINT not in signal.pthread_sigmask(signal.SIG_BLOCK, [])


def test_a_task_that_no_worker_has_begun_can_be_cancelled() -> None:
    with start_pool(1, time.sleep, 0.5) as pool:
        futures = [pool.submit(square, number, timeout=60.0) for number in range(5)]
        assert all(future.cancel() for future in futures)
        assert pool.submit(square, 3, timeout=60.0).result(60.0) == 9


def test_killed_workers_leave_no_temporary_files() -> None:
    with start_pool(1, end_with_parent) as pool:
        left = Path(pool.submit(leave_a_file, "content", timeout=60.0).result(60.0))
        assert left.exists()
    assert not left.exists()
