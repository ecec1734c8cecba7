"""The networks in the package are complete, small, documented, and trained together."""

import re

import numpy as np
import pytest

from ictamp_drake.learning.checkpoint import SHIPPED, SKILLS, Kind, load, name_of
from ictamp_drake.learning.models import load_dynamics, load_estimator, load_skill

KINDS: tuple[Kind, ...] = ("policy", "estimator", "dynamics")
LOADERS = {"policy": load_skill, "estimator": load_estimator, "dynamics": load_dynamics}


def test_they_are_all_there_and_take_less_than_ten_megabytes() -> None:
    sizes = {path.name: path.stat().st_size for path in SHIPPED.iterdir()}
    assert set(sizes) == {name_of(kind, skill) for kind in KINDS for skill in SKILLS}
    assert sum(sizes.values()) < 10e6


@pytest.mark.parametrize("skill", SKILLS)
@pytest.mark.parametrize("kind", KINDS)
def test_each_can_be_loaded_and_says_how_it_was_made(kind: Kind, skill: str) -> None:
    LOADERS[kind](SHIPPED, skill)
    found = load(SHIPPED, kind, skill)
    command = found.provenance["command"]
    assert re.match(r"python -m ictamp_drake\.experiments\.train_\w+ --data data/\w+ ", command)
    assert " /" not in command  # no path of the machine that made it
    assert re.fullmatch(r"[0-9a-f]{40}", found.provenance["commit"])
    assert found.provenance["data"]["attempts"] > 9000
    assert found.metrics["count"] > 400


@pytest.mark.parametrize("skill", SKILLS)
def test_P_is_the_success_of_the_shipped_policy(skill: str) -> None:
    policy = {
        name: array for name, array in load(SHIPPED, "policy", skill).arrays.items() if name.startswith("policy.")
    }
    own = load(SHIPPED, "estimator", skill).arrays
    for name, array in policy.items():
        np.testing.assert_array_equal(own[name], array)
