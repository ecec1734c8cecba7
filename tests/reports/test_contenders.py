"""The estimators under comparison, and the base rates."""

from pathlib import Path

import numpy as np
import pytest

from ictamp_drake.core.errors import Code
from ictamp_drake.core.types import Action, Skeleton
from ictamp_drake.learning.checkpoint import Checkpoint, load
from ictamp_drake.reports.contenders import BaseRates, KnownRates, contenders
from tests.learning.synthetic import write_untrained
from tests.refusals import refusal


@pytest.fixture(scope="module")
def checkpoints(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Untrained networks, except that the estimator of picks knows its base rate."""
    folder = write_untrained(tmp_path_factory.mktemp("checkpoints"))
    plain = load(folder, "estimator", "pick")
    names = ("kind", "skill", "arrays", "network", "provenance")
    Checkpoint(**{name: getattr(plain, name) for name in names}, metrics={"base_rate": 0.25}).save(folder)
    return folder


def test_rates_are_those_of_the_checkpoints_unless_given(checkpoints: Path) -> None:
    assert BaseRates(place=0.75).complete(checkpoints).rates == {"pick": 0.25, "place": 0.75}
    assert BaseRates(0.5, 0.75).complete(checkpoints).rates == {"pick": 0.5, "place": 0.75}


def test_every_option_has_the_rate_of_its_first_action() -> None:
    state = frozenset[object]()
    plans = [Skeleton((state,) * 3, (Action(skill, ()), Action("pick", ()))) for skill in ("place", "pick", "place")]  # type: ignore[arg-type]
    estimator = KnownRates({"pick": 0.25, "place": 0.75})
    np.testing.assert_array_equal(estimator.estimate([(None, plan) for plan in plans]), [0.75, 0.25, 0.75])


def test_P_comes_first_and_the_base_rate_last(checkpoints: Path) -> None:
    rates = KnownRates({"pick": 0.25, "place": 0.75})
    found = contenders(checkpoints, rates)
    assert list(found)[:2] == ["P", "Q of 1 draw"]
    assert list(found.values())[-1] is rates
    assert set(found) - set(contenders(checkpoints, rates, plans=False)) == {"Q along plan"}


def test_dynamics_are_needed_for_plans_only(checkpoints: Path, tmp_path: Path) -> None:
    for path in checkpoints.glob("*_[ep]*.safetensors"):
        (tmp_path / path.name).write_bytes(path.read_bytes())
    rates = KnownRates({"pick": 0.25, "place": 0.75})
    assert contenders(tmp_path, rates, plans=False)
    with refusal(Code.NOT_FOUND, file=tmp_path / "pick_dynamics.safetensors"):
        contenders(tmp_path, rates)


def test_mistakes_are_refused(checkpoints: Path, tmp_path: Path) -> None:
    with refusal(Code.MISSING_FIELD, "metrics.base_rate"):
        BaseRates().complete(checkpoints)
    with refusal(Code.OUT_OF_RANGE, "base-rate.place", value=1.5):
        BaseRates(place=1.5)
    with refusal(Code.NOT_FOUND):
        contenders(tmp_path, KnownRates({}))
