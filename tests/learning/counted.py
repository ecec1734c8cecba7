"""Recorded attempts from the initial configurations of their scenes, with any outcomes."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ictamp_drake.core.failures import Failure
from ictamp_drake.core.types import Action, Attempt, Configuration
from ictamp_drake.learning.cases import Case
from ictamp_drake.learning.dataset import AttemptRow, scene_text, write
from ictamp_drake.scenes.training import training_scene
from ictamp_drake.world.world import World

OPEN = Configuration(np.zeros(7), np.zeros(2), {})


def case(scene: int, outcomes: Sequence[bool], skill: str = "pick", state: int = 0) -> Case:
    """A case in which only the outcomes matter."""
    return Case(scene, state, "", OPEN, Action(skill, ("box", "table")), np.array(outcomes, dtype=bool))


def picks(number: int, outcomes: Sequence[bool], box: str | None = None, sampler: str = "policy") -> list[AttemptRow]:
    """Picks of a box, by default the last one on top, in a training scene as specified."""
    spec = training_scene(number)
    c = World(spec).initial_configuration()
    highest = max(spec.boxes, key=lambda name: spec.boxes[name].position[2])
    action = Action("pick", (box or highest, "table"))
    failures = [None if success else Failure.NO_PATH for success in outcomes]
    attempts = [Attempt[Configuration](action, failure) for failure in failures]
    return [AttemptRow(number, scene_text(spec), 0, draw, sampler, c, each) for draw, each in enumerate(attempts)]


def folder_of(folder: Path, *rows: Sequence[AttemptRow]) -> Path:
    """Folder with the rows."""
    folder.mkdir(parents=True, exist_ok=True)
    write([row for part in rows for row in part], folder / "all.parquet")
    return folder
