"""Plain data become dataclasses, and errors name the field that does not fit."""

from dataclasses import dataclass, field
from typing import Any, Literal

import pytest

from ictamp_drake.core.checks import check_range
from ictamp_drake.core.decoding import decode
from ictamp_drake.core.errors import Code
from tests.refusals import refusal


@dataclass(frozen=True)
class Wheel:
    radius: float
    spokes: int = 20

    def __post_init__(self) -> None:
        check_range("radius", self.radius, 0, 1, " m")


@dataclass(frozen=True)
class Cart:
    name: str
    wheels: tuple[Wheel, ...] = ()
    named: dict[str, Wheel] = field(default_factory=dict)
    spare: Wheel | None = None
    kind: Literal["hand", "ox"] = "hand"
    size: tuple[float, float] = (1.0, 2.0)
    path: tuple[tuple[float, float], ...] = ()
    words: tuple[str, ...] = ()
    lengths: tuple[float, ...] = ()
    is_new: bool = False
    load: float | None = None
    about: Any = None
    ready: bool = field(default=False, init=False)


def test_all_kinds_of_fields_are_read() -> None:
    wheel = {"radius": 0.3}
    raw = {
        "name": "red",
        "wheels": [wheel, {"radius": "1e-1", "spokes": 12.0}],
        "named": {"left": wheel},
        "spare": wheel,
        "kind": "ox",
        "size": [3, "4.5"],
        "path": [[0, 0], [1, 1]],
        "words": ["a", "b"],
        "is_new": True,
        "load": 3,
        "about": {"any": ["thing"]},
    }
    found = decode(Cart, raw)
    assert found == Cart(
        name="red",
        wheels=(Wheel(0.3), Wheel(0.1, 12)),
        named={"left": Wheel(0.3)},
        spare=Wheel(0.3),
        kind="ox",
        size=(3.0, 4.5),
        path=((0.0, 0.0), (1.0, 1.0)),
        words=("a", "b"),
        is_new=True,
        load=3.0,
        about={"any": ["thing"]},
    )
    assert type(found.load) is type(found.size[0]) is float
    assert type(found.wheels[1].spokes) is int


def test_a_number_stands_for_a_list_of_one() -> None:
    assert decode(Cart, {"name": "red", "lengths": 2}).lengths == (2.0,)


def test_what_is_left_out_has_its_default_and_nothing_can_be_given() -> None:
    assert decode(Cart, {"name": "red", "spare": None, "load": None}) == Cart("red")


@pytest.mark.parametrize(
    ("raw", "code", "where"),
    [
        ([], Code.WRONG_TYPE, "cart"),
        ({}, Code.MISSING_FIELD, "cart.name"),
        ({"name": 3}, Code.WRONG_TYPE, "cart.name"),
        ({"name": "a", "ready": True}, Code.UNKNOWN_FIELD, "cart.ready"),
        ({"name": "a", 3: 4}, Code.BAD_NAME, "cart"),
        ({"name": "a", "wheels": {}}, Code.WRONG_TYPE, "cart.wheels"),
        ({"name": "a", "wheels": [{"radius": 0.1}, {"radius": 7}]}, Code.OUT_OF_RANGE, "cart.wheels[1].radius"),
        ({"name": "a", "wheels": [{"radius": 0.1}, 7]}, Code.WRONG_TYPE, "cart.wheels[1]"),
        ({"name": "a", "wheels": [{"radius": 0.1, "spokes": 1.5}]}, Code.WRONG_TYPE, "cart.wheels[0].spokes"),
        ({"name": "a", "named": {"left": {}}}, Code.MISSING_FIELD, "cart.named.left.radius"),
        ({"name": "a", "spare": {"radius": True}}, Code.WRONG_TYPE, "cart.spare.radius"),
        ({"name": "a", "kind": "horse"}, Code.UNKNOWN_CHOICE, "cart.kind"),
        ({"name": "a", "kind": ["hand"]}, Code.UNKNOWN_CHOICE, "cart.kind"),
        ({"name": "a", "size": [1, 2, 3]}, Code.WRONG_LENGTH, "cart.size"),
        ({"name": "a", "size": "12"}, Code.WRONG_TYPE, "cart.size"),
        ({"name": "a", "path": [[0, 0], [1]]}, Code.WRONG_LENGTH, "cart.path[1]"),
        ({"name": "a", "path": [[0, 0], [1, "x"]]}, Code.WRONG_TYPE, "cart.path[1]"),
        ({"name": "a", "lengths": True}, Code.WRONG_TYPE, "cart.lengths"),
        ({"name": "a", "words": 1}, Code.WRONG_TYPE, "cart.words"),
        ({"name": "a", "words": [1]}, Code.WRONG_TYPE, "cart.words"),
        ({"name": "a", "is_new": 1}, Code.WRONG_TYPE, "cart.is_new"),
        ({"name": "a", "load": "heavy"}, Code.WRONG_TYPE, "cart.load"),
        ({"name": "a", "load": 10**400}, Code.WRONG_TYPE, "cart.load"),
        ({"name": "a", "wheels": [{"radius": 0.1, "spokes": 10**400}]}, Code.WRONG_TYPE, "cart.wheels[0].spokes"),
        ({"name": "a", "load": 16**5000}, Code.WRONG_TYPE, "cart.load"),
    ],
)
def test_what_does_not_fit_is_named(raw: object, code: Code, where: str) -> None:
    with refusal(code, where):
        decode(Cart, raw, "cart")
