"""Figure 2 shows a problem of each level and of each kind of interference."""

import numpy as np
import pytest

from ictamp_drake.scenes.levels import LEVELS
from ictamp_drake.scenes.spec import INTERFERENCES
from ictamp_drake.viz.gallery import examples, gallery
from tests.viz.scene import SPEC


def test_examples_are_of_all_levels_and_kinds() -> None:
    found = examples()
    assert [title.partition(" ")[0] for title in found] == [*LEVELS, *INTERFERENCES]
    assert [spec.interference for spec in found.values()] == [
        *((),) * len(LEVELS),
        *((kind,) for kind in INTERFERENCES),
    ]
    assert next(iter(found)) == "easy (easy-000)"


@pytest.mark.parametrize(("count", "panels"), [(2, 3), (4, 6)])
def test_each_scene_has_a_panel(count: int, panels: int) -> None:
    figure = gallery({f"scene {number}": SPEC for number in range(count)})
    assert len(figure.axes) == panels
    drawn = [axes for axes in figure.axes if axes.get_images()]
    assert [axes.get_title() for axes in drawn] == [f"scene {number}" for number in range(count)]
    assert all(np.ptp(np.asarray(axes.get_images()[0].get_array())) > 100 for axes in drawn)
