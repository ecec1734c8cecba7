"""Checks of single values; each raises an error with the field, its value and the valid choices."""

import math
import re
import sys
from collections.abc import Iterable, Sequence
from typing import Literal

from ictamp_drake.core.errors import Code, IctampError, show

POSITIVE = math.ulp(0.0)
"""Smallest number above 0, as the lower end of a range."""
FINITE = sys.float_info.max
"""Greatest finite number, as the upper end of a range."""

MAX_NAME = 100
"""Maximum length of the name of a box or a support."""

_MODEL_NAMES = ("world", "robot", "WorldModelInstance", "DefaultModelInstance")
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_-]*")
_WORDS = {2: "two", 3: "three", 7: "seven"}
_PDDL_WORDS = frozenset({"and", "or", "not", "imply", "when", "forall", "exists", "either", "object", "define"})


def check_range(field: str, value: float, low: float, high: float, unit: str = "") -> None:
    """Raise IctampError unless `low` <= `value` <= `high`; nan fails too."""
    if not low <= value <= high:
        expected = f"a {_describe_range(low, high, unit, 'number')}"
        raise IctampError(Code.OUT_OF_RANGE, f"expected {expected}, got {{value}}", field=field, value=value)


def check_fields(config: object, where: str, **ranges: tuple[float, float]) -> None:
    """Raise IctampError unless fields of a dataclass are in their ranges; `where` is its path on the command line."""
    for name, (low, high) in ranges.items():
        check_range(f"{where}.{name.replace('_', '-')}", getattr(config, name), low, high)


def check_interval(field: str, ends: Sequence[float], low: float, high: float) -> None:
    """Raise IctampError unless `ends` are two numbers from `low` to `high`, in ascending order."""
    check_vector(field, ends, low, high, count=2)
    if ends[0] > ends[1]:
        raise IctampError(Code.OUT_OF_RANGE, "expected the lower end first, got {value}", field=field, value=ends)


def check_vector(
    field: str, values: Sequence[float], low: float, high: float, unit: str = "", *, count: Literal[2, 3, 7] | None = 3
) -> None:
    """Raise IctampError unless `values` are `count` numbers (None: any number), each from `low` to `high`."""
    if count is not None and len(values) != count:
        expected = f"expected {_WORDS[count]} numbers, got {{value}}"
        raise IctampError(Code.WRONG_LENGTH, expected, field=field, value=values)
    if not all(low <= value <= high for value in values):
        expected = f"expected {_describe_range(low, high, unit, 'numbers')}, got {{value}}"
        raise IctampError(Code.OUT_OF_RANGE, expected, field=field, value=values)


def check_count(field: str, values: Sequence[object], low: int, high: int) -> None:
    """Raise IctampError unless there are `low` to `high` values."""
    if not low <= len(values) <= high:
        expected = f"expected {low} to {high} values, got {{value}}"
        raise IctampError(Code.WRONG_LENGTH, expected, field=field, value=values)


def check_choice(field: str, value: str, choices: Iterable[str]) -> None:
    """Raise IctampError unless `value` is one of `choices`."""
    choices = tuple(choices)
    if value not in choices:
        raise IctampError(Code.UNKNOWN_CHOICE, "{value} is not valid", field=field, value=value, choices=choices)


def check_different(field: str, values: Sequence[object]) -> None:
    """Raise IctampError when a value occurs more than once."""
    for value in values:
        if values.count(value) > 1:
            raise IctampError(Code.REPEATED, "expected different values, got {value} twice", field=field, value=value)


def check_names(**sections: Iterable[str]) -> None:
    """Raise IctampError unless the names of all sections fit into one PDDL problem, which ignores case."""
    seen = set()
    for field, name in ((f"{section}.{name}", name) for section, names in sections.items() for name in names):
        other = f"choose another name, e.g. {name}_1"
        if not _NAME.fullmatch(name):
            rule = "use letters, digits, _ and -, and begin with a letter"
            raise IctampError(Code.BAD_NAME, "{value} is not a valid name", field=field, value=name, advice=rule)
        if len(name) > MAX_NAME:
            problem = f"expected names of at most {MAX_NAME} characters, got {{value}}"
            raise IctampError(Code.BAD_NAME, problem, field=field, value=name)
        if name in _MODEL_NAMES:
            problem = "{value} is a name of the world or the robot"
            raise IctampError(Code.BAD_NAME, problem, field=field, value=name, advice=other)
        if name.lower() in _PDDL_WORDS:
            raise IctampError(Code.BAD_NAME, "{value} is a word of PDDL", field=field, value=name, advice=other)
        if name.lower() in seen:
            problem = "the name {value} is used twice, and case does not count"
            raise IctampError(Code.REPEATED, problem, field=field, value=name, advice=other)
        seen.add(name.lower())


def _describe_range(low: float, high: float, unit: str, noun: str) -> str:
    finite = "finite " if high == FINITE else ""
    if high < FINITE and low != POSITIVE:
        return f"{noun} from {_end(low)} to {_end(high)}{unit}"
    least = f"above 0{unit}" if low == POSITIVE else f"of at least {_end(low)}{unit}"
    most = f" and at most {_end(high)}{unit}" if high < FINITE else ""
    return f"{finite}{noun} {least}{most}"


def _end(number: float) -> str:
    """Return an end of a range, exact if it is a whole number."""
    return show(number if isinstance(number, int) else float(number))
