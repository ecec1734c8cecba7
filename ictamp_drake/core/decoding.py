"""Decode plain data, as read from YAML and JSON, into frozen dataclasses: scenes, plans, records, networks."""

import dataclasses
from collections.abc import Mapping
from functools import cache
from types import NoneType, UnionType
from typing import Any, Literal, TypeVar, get_args, get_origin, get_type_hints

from ictamp_drake.core.checks import check_choice
from ictamp_drake.core.errors import Code, IctampError, join_fields
from ictamp_drake.core.spelling import respell

T = TypeVar("T")

_NUMBERS = {float: ("a number", "numbers"), int: ("a whole number", "whole numbers")}
_NAMES = {**_NUMBERS, str: ("text", "texts"), bool: ("true or false", "truth values"), NoneType: ("nothing", "nothing")}
_COUNTS = {2: "two", 3: "three", 4: "four", 7: "seven"}


def decode(schema: type[T], raw: object, where: str = "") -> T:
    """Build the dataclass `schema` from a mapping; `where` is the mapping's place in the file, e.g. boxes.red_box.

    Fields may hold other dataclasses, dict[str, …], tuple[…], unions, literals, numbers, text and truth values. Values
    of fields with any other annotation are not converted. Numbers may be given as text, since YAML reads 1e-3 as text.
    A number stands for a list of that one number where a list may have any length.

    Raises:
        IctampError: A field is unknown or missing, or its value has the wrong type or is refused by the dataclass.
    """
    fields, hints = _fields(schema)  # type: ignore[arg-type]  # a class can be hashed
    if "on" in fields and isinstance(raw, dict):
        raw = {"on" if key is True else key: value for key, value in raw.items()}  # YAML reads the key on as True
    values = {}
    for written, value in mapping(raw, where).items():
        name = written if written in fields else respell(written)
        if name not in fields:
            raise IctampError(Code.UNKNOWN_FIELD, "unknown field", field=join_fields(where, written), choices=fields)
        if name in values:
            raise IctampError(Code.REPEATED, f"expected either {name} or {written}", field=join_fields(where, name))
        values[name] = _value(hints[name], value, join_fields(where, name))
    for name, is_required in fields.items():
        if is_required and name not in values:
            raise IctampError(Code.MISSING_FIELD, "missing field", field=join_fields(where, name))
    try:
        return schema(**values)
    except IctampError as error:
        error.add_field(where)
        raise


def mapping(raw: object, where: str = "") -> Mapping[str, object]:
    """Return the value unchanged if it is a mapping whose keys are all text.

    Raises:
        IctampError: The value is not such a mapping.
    """
    if not isinstance(raw, dict):
        raise IctampError(Code.WRONG_TYPE, "expected a mapping (name: value), got {value}", field=where, value=raw)
    for key in raw:
        if not isinstance(key, str):
            trap = "YAML reads on, off, yes and no as truth values" if isinstance(key, bool) else ""
            expected = "expected names that are text, got {value}"
            raise IctampError(Code.BAD_NAME, expected, field=where, value=key, advice=trap)
    return raw


@cache
def _fields(schema: type) -> tuple[dict[str, bool], dict[str, Any]]:
    """Return whether each field is required, and the type of each field, both by name."""
    required = {
        field.name: field.default is field.default_factory is dataclasses.MISSING
        for field in dataclasses.fields(schema)
        if field.init
    }
    return required, get_type_hints(schema)


def _value(hint: Any, raw: object, where: str) -> object:
    """Convert the value to the annotated type of its field."""
    origin, parts = get_origin(hint), get_args(hint)
    if dataclasses.is_dataclass(hint):
        return decode(hint, raw, where)  # type: ignore[arg-type]
    if origin is dict:
        value: object = {k: _value(parts[1], item, join_fields(where, k)) for k, item in mapping(raw, where).items()}
    elif origin is tuple and isinstance(raw, list | tuple):
        value = _items(hint, raw, where)
    elif parts == (float, ...) and type(raw) in (int, float):
        value = _items(hint, (raw,), where)
    elif origin is UnionType:
        value = None if raw is None and NoneType in parts else _value(_some(hint), raw, where)
    elif origin is Literal:
        check_choice(where, raw, parts)  # type: ignore[arg-type]
        value = raw
    else:
        value = _scalars(hint, raw, where)
    return value


def _scalars(hint: Any, raw: object, where: str) -> object:
    if hint not in _NAMES and get_origin(hint) is not tuple:
        return raw
    try:
        return _scalar(hint, raw)
    except (ValueError, TypeError, OverflowError) as error:
        raise _wrong_type(hint, raw, where) from error


def _some(hint: Any) -> Any:
    """Type of an optional field when it is not None."""
    (some,) = (part for part in get_args(hint) if part is not NoneType)
    return some


def _items(hint: Any, raw: list[object] | tuple[object, ...], where: str) -> tuple[object, ...]:
    kind, *rest = get_args(hint)
    if rest != [...] and len(raw) != len(rest) + 1:
        raise IctampError(Code.WRONG_LENGTH, f"expected {_describe(hint)}, got {{value}}", field=where, value=raw)
    if kind not in _NAMES:
        return tuple(_value(kind, item, f"{where}[{number}]") for number, item in enumerate(raw))
    try:
        return tuple(_scalar(kind, item) for item in raw)
    except (ValueError, TypeError, OverflowError) as error:
        raise _wrong_type(hint, raw, where) from error


def _scalar(kind: type, raw: object) -> object:
    """Return a value of the kind; a number may be written as text, and no other conversion is allowed."""
    if type(raw) is not kind and (kind not in _NUMBERS or type(raw) not in (int, float, str)):
        raise TypeError
    value = raw if type(raw) is kind else kind(raw)
    if isinstance(value, int):
        float(value)  # raises OverflowError for a number with which nothing could be computed
    if kind is int and isinstance(raw, float) and value != raw:
        raise ValueError
    return value


def _wrong_type(hint: Any, raw: object, where: str) -> IctampError:
    expected = f"expected {_describe(hint)}, got {{value}}"
    return IctampError(Code.WRONG_TYPE, expected, field=where, value=raw)


def _describe(hint: Any) -> str:
    """Describe the values of a field in words."""
    if get_origin(hint) is not tuple:
        return _NAMES[hint][0]
    kind, *rest = get_args(hint)
    many = _NAMES[kind][1] if kind in _NAMES else "values"
    return f"a list of {many}" if rest == [...] else f"{_COUNTS.get(len(rest) + 1, len(rest) + 1)} {many}"
