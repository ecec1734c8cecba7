import time

import pytest

from ictamp_drake.core.stopwatch import Stopwatch


def test_stages_add_up_until_they_are_taken() -> None:
    stopwatch = Stopwatch()
    for _ in range(2):
        with stopwatch.stage("a"):
            time.sleep(0.002)
    with pytest.raises(ValueError, match="late"), stopwatch.stage("b"):
        raise ValueError("late")
    seconds = stopwatch.take()
    assert seconds["a"] >= 0.004
    assert set(seconds) == {"a", "b"}
    assert stopwatch.take() == {}
