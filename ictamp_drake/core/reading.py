"""From YAML text to frozen dataclasses, with errors that say where in the file they are.

Drake's `yaml_load_typed` fills mutable, default-constructed objects and names no place in its errors.
"""

import dataclasses
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any, TypeVar, get_args, get_origin, get_type_hints

import yaml

from ictamp_drake.core.errors import IctampError

T = TypeVar("T")


class _Strict:
    """What PyYAML's safe loaders do not do: they keep the last of repeated keys and tell no place of a value."""

    def get_single_node(self) -> yaml.Node | None:
        """The document as it is written, before merging (<<) adds to its mappings."""
        node: yaml.Node | None = super().get_single_node()  # type: ignore[misc]
        _refuse_repeated(node, set())
        return node

    def construct_object(self, node: yaml.Node, deep: bool = False) -> Any:
        try:
            return super().construct_object(node, deep)  # type: ignore[misc]
        except (AttributeError, LookupError, ValueError) as error:
            kind = node.tag.rpartition(":")[2]
            raise IctampError(f"{_line(node)}: not valid YAML: '{node.value}' is no {kind}") from error


class _PythonLoader(_Strict, yaml.SafeLoader):
    """PyYAML's own, whose words for a mistake are the better ones."""


class _Loader(_Strict, getattr(yaml, "CSafeLoader", yaml.SafeLoader)):  # type: ignore[misc]
    """That of libyaml where it is installed, ten times faster."""


def _refuse_repeated(node: yaml.Node | None, seen: set[int]) -> None:
    """Raise IctampError when a mapping in the node, or it itself, has a key twice; aliases may lead to nodes `seen`."""
    if isinstance(node, yaml.ScalarNode) or node is None or id(node) in seen:
        return
    seen.add(id(node))
    is_mapping = isinstance(node, yaml.MappingNode)
    for child in (part for pair in node.value for part in pair) if is_mapping else node.value:
        _refuse_repeated(child, seen)
    keys = set()
    for key in (key for key, _ in node.value if isinstance(key, yaml.ScalarNode)) if is_mapping else ():
        if key.value in keys:
            raise IctampError(f"{_line(key)}: '{key.value}' is used twice in one mapping")
        keys.add(key.value)


def _line(node: yaml.Node) -> str:
    return f"line {node.start_mark.line + 1}"


def read_text(path: Path | str) -> str:
    """The text of a file.

    Raises:
        IctampError: it cannot be read or is not UTF-8.
    """
    try:
        return Path(path).read_text(encoding="utf-8")
    except OSError as error:
        raise IctampError(f"{path}: cannot be read: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise IctampError(f"{path}: not a text file in UTF-8") from error


def parse(text: str) -> object:
    """The document as plain mappings, lists and scalars.

    Raises:
        IctampError: on a syntax error, an impossible value or a key used twice, naming the line.
    """
    with suppress(yaml.YAMLError):  # what libyaml refuses is read again, for the sake of the message
        return yaml.load(text, Loader=_Loader)
    try:
        return yaml.load(text, Loader=_PythonLoader)
    except yaml.MarkedYAMLError as error:
        line = f"line {error.problem_mark.line + 1}: " if error.problem_mark else ""
        raise IctampError(f"{line}not valid YAML: {error.problem}") from error
    except yaml.YAMLError as error:
        raise IctampError(f"not valid YAML: {' '.join(str(error).split())}") from error


def build(schema: type[T], raw: object, where: str = "") -> T:
    """The dataclass `schema` from a YAML mapping; `where` is the mapping's place in the file, e.g. boxes.red_box.

    Raises:
        IctampError: for an unknown or missing field, or a value that is of the wrong type or refused by the dataclass.
    """
    hints = get_type_hints(schema)
    fields = {field.name: field for field in dataclasses.fields(schema)}  # type: ignore[arg-type]
    values = {}
    for name, value in mapping(raw, where).items():
        if name not in fields:
            raise IctampError(f"unknown field '{_join(where, name)}'; valid are: {', '.join(fields)}")
        values[name] = _value(hints[name], value, _join(where, name))
    needed = [name for name, field in fields.items() if field.default is field.default_factory is dataclasses.MISSING]
    for name in needed:
        if name not in values:
            raise IctampError(f"'{_join(where, name)}' is missing; needed are: {', '.join(needed)}")
    try:
        return schema(**values)
    except IctampError as error:
        raise IctampError(_join(where, str(error))) from error


def mapping(raw: object, where: str) -> Mapping[str, object]:
    """The value itself when it is a mapping whose keys are all text.

    Raises:
        IctampError: otherwise.
    """
    if not isinstance(raw, dict):
        raise IctampError(f"{where or 'the file'} is {raw!r}, but must be a mapping (name: value)")
    for key in raw:
        if not isinstance(key, str):
            trap = "; YAML reads on, off, yes and no as truth values" if isinstance(key, bool) else ""
            raise IctampError(f"{where or 'the file'} has the key {key!r}, but names must be text{trap}")
    return raw


def _value(hint: Any, raw: object, where: str) -> object:
    if get_origin(hint) is dict:
        return {name: _value(get_args(hint)[1], item, _join(where, name)) for name, item in mapping(raw, where).items()}
    if dataclasses.is_dataclass(hint):
        return build(hint, raw, where)  # type: ignore[arg-type]
    is_tuple = get_origin(hint) is tuple
    if is_tuple != isinstance(raw, list):
        raise IctampError(f"{where} is {raw!r}, but must be {_describe_type(hint)}")
    try:
        if is_tuple:
            return tuple(_scalar(get_args(hint)[0], item) for item in raw)  # type: ignore[attr-defined]
        return _scalar(hint, raw)
    except (ValueError, TypeError, OverflowError) as error:
        raise IctampError(f"{where} is {raw!r}, but must be {_describe_type(hint)}") from error


def _scalar(kind: type, raw: object) -> object:
    """A value of the kind: a number may be written as text (YAML takes 1e-3 for one), but nothing else for another."""
    if type(raw) is kind:
        return raw
    if kind is str or type(raw) not in (int, float, str):
        raise TypeError
    value = kind(raw)
    if kind is int and isinstance(raw, float) and value != raw:
        raise ValueError
    return value


def _describe_type(hint: Any) -> str:
    words = {float: "a number", int: "a whole number", str: "text"}
    return words.get(hint) or ("a list of texts" if get_args(hint)[0] is str else "a list of three numbers")


def _join(where: str, rest: str) -> str:
    return f"{where}.{rest}" if where else rest
