import time

import pytest

from ictamp_drake.core.stopwatch import Stopwatch


def test_stages_add_up() -> None:
    stopwatch = Stopwatch(time.perf_counter)
    for _ in range(2):
        with stopwatch.stage("a"):
            time.sleep(0.002)
    with pytest.raises(ValueError, match="late"), stopwatch.stage("b"):
        raise ValueError("late")
    seconds = stopwatch.seconds
    assert seconds["a"] >= 0.004
    assert set(seconds) == {"a", "b"}
