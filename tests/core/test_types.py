"""c is immutable, compared bit for bit, and unchanged after a trip to another process."""

import pickle
from dataclasses import FrozenInstanceError, fields, replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from ictamp_drake.core.types import Configuration, FloatArray, GripperCommand

NUMBERS = st.floats(-10, 10)
POSES = st.dictionaries(st.sampled_from(["red", "blue", "tall"]), arrays(float, 7, elements=NUMBERS))
COMMANDS = st.builds(GripperCommand, st.floats(0, 0.08), st.floats(0, 70))
CONFIGURATIONS = st.builds(
    Configuration,
    arrays(float, 7, elements=NUMBERS),
    arrays(float, 2, elements=NUMBERS),
    POSES,
    st.none() | st.sampled_from(["red", "blue"]),
    COMMANDS,
    st.none() | arrays(float, 7, elements=NUMBERS),
    st.none() | arrays(float, st.integers(0, 40), elements=NUMBERS),
)


def copy_apart(c: Configuration) -> Configuration:
    """Copy of c with its own arrays and with its poses in a different order."""
    poses = {name: c.poses[name].copy() for name in reversed(list(c.poses))}
    state = None if c.x is None else c.x.copy()
    return Configuration(c.q.copy(), c.fingers.copy(), poses, c.held, c.gripper, c.commanded.copy(), state)


def arrays_of(c: Configuration) -> list[FloatArray]:
    return [c.q, c.fingers, c.commanded, *c.poses.values(), *([] if c.x is None else [c.x])]


@given(CONFIGURATIONS)
def test_equal_parts_make_equal_configurations(c: Configuration) -> None:
    other = copy_apart(c)
    assert c == other
    assert hash(c) == hash(other)
    assert list(c.poses) == list(other.poses) == sorted(c.poses)


@given(CONFIGURATIONS)
def test_pickling_keeps_every_bit_and_the_protection(c: Configuration) -> None:
    read = pickle.loads(pickle.dumps(c))
    assert read == c
    assert hash(read) == hash(c)
    assert not any(array.flags.writeable for array in arrays_of(read))


@given(CONFIGURATIONS, st.sampled_from([field.name for field in fields(Configuration)]))
def test_a_part_that_differs_in_one_bit_makes_another_configuration(c: Configuration, part: str) -> None:
    changed = {
        "q": np.nextafter(c.q, 20.0),
        "fingers": np.nextafter(c.fingers, 20.0),
        "poses": {**c.poses, "green": np.zeros(7)},
        "held": "another_box",
        "gripper": GripperCommand(c.gripper.width, c.gripper.force + 1.0),
        "commanded": np.nextafter(c.commanded, 20.0),
        "x": np.zeros(3) if c.x is None else None,
    }
    assert replace(c, **{part: changed[part]}) != c  # type: ignore[arg-type]


def test_states_differ_by_one_bit() -> None:
    c = Configuration(np.zeros(7), np.zeros(2), {}, x=np.zeros(4))
    assert replace(c, x=np.array([0.0, 0.0, 0.0, 5e-324])) != c
    assert replace(c, x=np.zeros(4)) == c


@given(CONFIGURATIONS)
def test_nothing_in_it_can_be_changed(c: Configuration) -> None:
    for array in arrays_of(c):
        if array.size:
            with pytest.raises(ValueError, match="read-only"):
                array[0] = 1.0
    with pytest.raises(FrozenInstanceError):
        c.x = None  # type: ignore[misc]


def test_it_keeps_no_hold_on_what_it_was_made_of() -> None:
    q, fingers, pose, commanded, x = np.zeros(7), np.zeros(2), np.zeros(7), np.zeros(7), np.zeros(20)
    c = Configuration(q, fingers, {"red": pose}, commanded=commanded, x=x)
    for array in (q, fingers, pose, commanded, x):
        array.fill(1.0)
    assert not any(array.any() for array in arrays_of(c))


@given(arrays(float, st.integers(0, 9), elements=NUMBERS))
def test_the_arm_is_where_it_was_commanded_unless_said_otherwise(q: FloatArray) -> None:
    c = Configuration(q, np.zeros(2), {})
    assert c.commanded.tobytes() == q.tobytes()
    assert c.x is None
