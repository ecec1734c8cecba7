"""plan.yaml: numbers are read back exactly, and files that are not plans are refused."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from ictamp_drake.core.decoding import decode
from ictamp_drake.core.errors import Code
from ictamp_drake.core.reading import parse
from ictamp_drake.core.types import Action, Attempt, Configuration, FloatArray, GripperCommand, Segment
from ictamp_drake.scenes.spec import SceneSpec
from ictamp_drake.tamp.plan import Plan, read_plan, write_plan
from tests.refusals import refusal
from tests.runs.programs import SCENE

SPEC = decode(SceneSpec, parse(SCENE))
OPEN = GripperCommand(0.08)
numbers = st.floats(-10, 10)
POSE = np.array([1.0, 0, 0, 0, 0, 0, 0])


def segment(
    control_points: FloatArray, order: int, duration: float, force: float, touches: frozenset[str] | None
) -> Segment:
    knots = np.linspace(0, duration, len(control_points) + order)
    return Segment("lift", duration, GripperCommand(0.05, force), order, knots, control_points, touches)


segments = st.builds(
    segment,
    arrays(float, st.tuples(st.integers(1, 5), st.just(7)), elements=numbers),
    st.integers(1, 4),
    st.floats(0.1, 10),
    st.floats(0, 70),
    st.none() | st.frozensets(st.sampled_from(["red_box", "rack"])),
)


@given(
    k=arrays(float, 4, elements=numbers),
    motion=st.lists(segments, min_size=1, max_size=3),
    c=st.builds(
        lambda q, commanded, x: Configuration(
            np.nan_to_num(q), dict.fromkeys(SPEC.boxes, POSE), None, OPEN, commanded, x
        ),
        arrays(float, 9),
        st.none() | arrays(float, 7, elements=numbers),
        st.none() | arrays(float, 40, elements=numbers),
    ),
)
def test_a_plan_survives_bit_for_bit(
    k: FloatArray,
    motion: list[Segment],
    c: Configuration,
    tmp_path_factory: pytest.TempPathFactory,
) -> None:
    path = tmp_path_factory.mktemp("plan") / "plan.yaml"
    action = Action("place", ("red_box", "rack"))
    write_plan(Plan(SPEC, c, (Attempt(action, None, k=k, motion=tuple(motion)),)), path)
    plan = read_plan(path)
    assert plan.spec == SPEC
    assert plan.c == c
    (attempt,) = plan.attempts
    assert attempt.action == action
    assert attempt.k is not None
    assert attempt.k.tobytes() == k.tobytes()
    for read, written in zip(attempt.motion, motion, strict=True):
        assert (read.label, read.duration, read.order) == (written.label, written.duration, written.order)
        assert (read.gripper, read.touches) == (written.gripper, written.touches)
        assert read.knots.tobytes() == written.knots.tobytes()
        assert read.control_points.tobytes() == written.control_points.tobytes()


@pytest.mark.parametrize(
    ("content", "code", "field"),
    [
        ("- 1", Code.WRONG_TYPE, ""),
        ("format: 1", Code.MISSING_FIELD, "scene"),
        ("format: [", Code.NOT_YAML, ""),
        ("format: 9", Code.OTHER_VERSION, "format"),
        ("format: " + "[" * 30_000, Code.TOO_DEEP, ""),
    ],
)
def test_what_is_no_plan_is_refused(content: str, code: Code, field: str, tmp_path: Path) -> None:
    path = tmp_path / "plan.yaml"
    path.write_text(content)
    with refusal(code, field, file=path):
        read_plan(path)


def test_a_missing_plan_is_named(tmp_path: Path) -> None:
    with refusal(Code.NOT_READABLE, file=tmp_path / "plan.yaml"):
        read_plan(tmp_path / "plan.yaml")
