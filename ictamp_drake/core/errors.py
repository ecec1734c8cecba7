"""Errors that a user can fix. Everything that goes wrong inside a search is a `Failure`, not an error."""

import math
import reprlib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from itertools import accumulate, takewhile
from pathlib import Path


class Code(StrEnum):
    """Kind of mistake. Codes are stable; the sentences of errors are not."""

    # One value
    OUT_OF_RANGE = "out-of-range"
    WRONG_TYPE = "wrong-type"
    WRONG_LENGTH = "wrong-length"
    UNKNOWN_CHOICE = "unknown-choice"
    REPEATED = "repeated"
    EMPTY = "empty"
    BAD_NAME = "bad-name"
    CONFLICT = "conflict"
    # Fields and files
    UNKNOWN_FIELD = "unknown-field"
    MISSING_FIELD = "missing-field"
    NOT_FOUND = "not-found"
    NOT_READABLE = "not-readable"
    NOT_WRITABLE = "not-writable"
    NOT_TEXT = "not-text"
    NOT_YAML = "not-yaml"
    NOT_JSON = "not-json"
    NOT_PDDL = "not-pddl"
    TOO_LARGE = "too-large"
    TOO_DEEP = "too-deep"
    DAMAGED = "damaged"
    OTHER_VERSION = "other-version"
    # Scenes and goals
    TOO_WIDE = "too-wide"
    TOO_HEAVY = "too-heavy"
    OVERLAP = "overlap"
    NOT_CARRIED = "not-carried"
    NOT_HELD = "not-held"
    NOT_AT_REST = "not-at-rest"
    BAD_STATE = "bad-state"
    IMPOSSIBLE_GOAL = "impossible-goal"
    # Runs and learning
    NOT_A_RUN = "not-a-run"
    NO_RUN = "no-run"
    IN_USE = "in-use"
    OTHER_OPTIONS = "other-options"
    TOO_FEW_DATA = "too-few-data"
    NOT_INSTALLED = "not-installed"
    NOT_REACHABLE = "not-reachable"


@dataclass(frozen=True)
class Where:
    """Place of a mistake. Fields that are not known are empty.

    Attributes:
        file: File or folder, or the name of a scene that was made in Python.
        line: Line of the file, counted from 1.
        field: Path of the field, e.g. boxes.red_box.size or start.joints[2], or of the option, e.g. planners.els.p-w.
    """

    file: str = ""
    line: int | None = None
    field: str = ""

    def __str__(self) -> str:
        line = "" if self.line is None else f"line {self.line}"
        return ": ".join(
            filter(None, [", ".join(filter(None, [self.file, line])), _shorten(self.field, _LONGEST_FIELD)])
        )


class IctampError(Exception):
    """Base of all errors raised on purpose. `str` of it is one sentence; programs print it and exit with code 2.

    Attributes:
        code: Kind of the mistake.
        where: Place of the mistake.
        problem: Description of the mistake without its place; "{value}" stands for the value.
        value: Refused value; None if there is none.
        choices: Values that would be valid there; empty if they cannot be listed.
        advice: Advice on how to fix it, e.g. "choose another --out"; may be empty.
    """

    def __init__(
        self,
        code: Code,
        problem: str,
        *,
        field: str = "",
        file: Path | str = "",
        line: int | None = None,
        value: object = None,
        choices: Iterable[str] = (),
        advice: str = "",
    ) -> None:
        super().__init__(code, problem)
        self.code = code
        self.problem = problem
        self.where = Where(str(file), line, field)
        self.value = value
        self.choices = tuple(choices)
        self.advice = advice

    def add_field(self, field: str) -> None:
        """Put the path of the enclosing field in front, e.g. boxes.red_box before size."""
        self.where = replace(self.where, field=join_fields(field, self.where.field))

    def add_file(self, file: Path | str, line: int | None = None) -> None:
        """Add the file, and the line if it is known, unless the error has a file already."""
        if not self.where.file:
            self.where = replace(self.where, file=str(file), line=self.where.line or line)

    def __str__(self) -> str:
        """Return e.g. "scene.yaml, line 7: boxes.red_box.size: expected three numbers, got [1, 2]"."""
        problem = _shorten(self.problem, _LONGEST).replace("{value}", show(self.value))
        choices = f"choose from: {_list_choices(self.choices)}" if self.choices else ""
        sentence = "; ".join(filter(None, [problem, choices, _shorten(self.advice, _LONGEST)]))
        return _print(": ".join(filter(None, [str(self.where), sentence])))


def join_fields(field: str, rest: str) -> str:
    """Join the path of a field and that of a part of it; either may be empty."""
    return field + rest if not field or not rest or rest.startswith("[") else f"{field}.{rest}"


_LONGEST = 200
"""Number of characters of a value, and of each other part of a sentence, that are shown."""
_LONGEST_FIELD = 120
_MOST_DIGITS = 1000
"""Number of digits up to which a whole number is written out; Python refuses to write more than 4300."""


def _shorten(text: str, limit: int) -> str:
    return text if len(text) <= limit else f"{text[:limit]}..."


def _list_choices(choices: Sequence[str]) -> str:
    """List as many choices as there is room for, at least one."""
    shown = [_shorten(choice, _LONGEST_FIELD) for choice in choices]
    room = _LONGEST - max(map(len, shown[:1]))
    rest = list(takewhile(lambda end: end <= room, accumulate(len(choice) + 2 for choice in shown[1:])))
    left = len(shown) - 1 - len(rest)
    return ", ".join(shown[: 1 + len(rest)]) + (f", ... ({left} more)" if left else "")


def _print(text: str) -> str:
    """Return the text on one line, with spaces for characters that cannot be printed, such as those of terminals."""
    return "".join(character if character.isprintable() else " " for character in text)


class _Shown(reprlib.Repr):
    def __init__(self) -> None:
        super().__init__()
        self.maxlist = self.maxdict = 9
        self.maxlevel = 3
        self.maxstring = self.maxother = 80

    def repr_float(self, number: float, _: int) -> str:
        return f"{number:g}"

    def repr_int(self, number: int, level: int) -> str:
        digits = int(number.bit_length() * math.log10(2)) + 1
        return super().repr_int(number, level) if digits <= _MOST_DIGITS else f"a number of {digits} digits"


def show(value: object) -> str:
    """Return the value as messages quote it: on one line, abbreviated if it is long."""
    if isinstance(value, Path):
        value = str(value)
    text = _Shown().repr(list(value) if isinstance(value, Sequence) and not isinstance(value, str | bytes) else value)
    return _shorten(text, _LONGEST)
