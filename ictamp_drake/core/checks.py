"""Checks of single values; each raises one sentence that names the field, its value and the valid choices."""

import re
from collections.abc import Iterable, Sequence
from typing import Literal

from ictamp_drake.core.errors import IctampError

_MODEL_NAMES = ("world", "panda", "WorldModelInstance", "DefaultModelInstance")
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_-]*")
_WORDS = {2: "two", 3: "three", 7: "seven"}
_PDDL_WORDS = frozenset({"and", "or", "not", "imply", "when", "forall", "exists", "either", "object", "define"})


def check_range(field: str, value: float, low: float, high: float, unit: str = "") -> None:
    """Raise IctampError unless `low` <= `value` <= `high`; nan fails too."""
    if not low <= value <= high:
        raise IctampError(f"{field} is {value:g}{unit}, but must be between {low:g} and {high:g}{unit}")


def check_fields(config: object, where: str, **ranges: tuple[float, float]) -> None:
    """Raise IctampError unless fields of a dataclass are in their ranges; `where` leads to it on the command line."""
    for name, (low, high) in ranges.items():
        check_range(f"{where}.{name.replace('_', '-')}", getattr(config, name), low, high)


def check_interval(field: str, ends: Sequence[float], low: float, high: float) -> None:
    """Raise IctampError unless `ends` are two numbers between `low` and `high`, in their order."""
    check_vector(field, ends, low, high, count=2)
    if ends[0] > ends[1]:
        raise IctampError(f"{field} is {list(ends)}, but the least must not exceed the greatest")


def check_vector(
    field: str, values: Sequence[float], low: float, high: float, unit: str = "", *, count: Literal[2, 3, 7] | None = 3
) -> None:
    """Raise IctampError unless `values` are so many numbers, None for any, each between `low` and `high`."""
    if count is not None and len(values) != count:
        raise IctampError(f"{field} is {list(values)}, but must be {_WORDS[count]} numbers")
    if not all(low <= value <= high for value in values):
        raise IctampError(f"{field} is {list(values)}, but each number must be between {low:g} and {high:g}{unit}")


def check_choice(field: str, value: str, choices: Iterable[str]) -> None:
    """Raise IctampError unless `value` is one of `choices`."""
    if value not in choices:
        raise IctampError(f"{field} is '{value}', but must be one of: {', '.join(choices)}")


def check_different(field: str, values: Sequence[object]) -> None:
    """Raise IctampError when a value is there more than once."""
    for value in values:
        if values.count(value) > 1:
            raise IctampError(f"{field} has {value!r} more than once, but all must be different")


def check_names(names: Iterable[str]) -> None:
    """Raise IctampError unless the names can stand side by side in a PDDL problem, where case does not count."""
    seen = set()
    for name in names:
        if not _NAME.fullmatch(name):
            raise IctampError(f"the name '{name}' is not valid; use letters, digits, _ and -, a letter first")
        if name in _MODEL_NAMES:
            raise IctampError(f"the name '{name}' is taken by the world or the robot; choose another, e.g. '{name}_1'")
        if name.lower() in _PDDL_WORDS:
            raise IctampError(f"the name '{name}' is a word of PDDL; choose another, e.g. '{name}_1'")
        if name.lower() in seen:
            raise IctampError(f"the name '{name}' is used twice (case does not count); every name must be its own")
        seen.add(name.lower())
