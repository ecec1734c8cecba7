"""Read files as plain data, with limits, and with errors that name the line."""

import json
import re
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import yaml

from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.spelling import spellings

MAX_BYTES = 64 * 2**20
"""Size of the largest file that is read [bytes]."""
MAX_NODES = 2_000_000
"""Maximum number of mappings, lists and scalars in a YAML document with expanded aliases."""
MAX_DEPTH = 60
"""Maximum nesting depth of a YAML document, low enough for functions that recurse once per level."""
MAX_DIGITS = 1000
"""Maximum number of characters of a number; the time for a number with colons (base 60) grows with its square."""
MAX_EXPLAINED = 2**16
"""Maximum length of a text that PyYAML reads for its better messages; it is ten times slower than libyaml."""

_NUMBER_TAGS = frozenset({"tag:yaml.org,2002:int", "tag:yaml.org,2002:float"})
_TOO_DEEP = f"expected values nested at most {MAX_DEPTH} deep"


class _Strict:
    """Checks that PyYAML's safe loaders lack: repeated keys are errors, and errors of values name the line."""

    def get_single_node(self) -> yaml.Node | None:
        """Return the document as written, before merge keys (<<) add to its mappings."""
        node: yaml.Node | None = super().get_single_node()  # type: ignore[misc]
        _refuse_repeated(node, set())
        return node

    def construct_object(self, node: yaml.Node, deep: bool = False) -> Any:
        if isinstance(node, yaml.ScalarNode) and node.tag in _NUMBER_TAGS and len(node.value) > MAX_DIGITS:
            problem = f"expected numbers of at most {MAX_DIGITS} digits, got {{value}}"
            raise IctampError(Code.TOO_LARGE, problem, line=_line(node), value=node.value)
        try:
            return super().construct_object(node, deep)  # type: ignore[misc]
        except (ArithmeticError, AttributeError, LookupError, ValueError) as error:
            kind = {"int": "whole number", "bool": "truth value"}.get(tag := node.tag.rpartition(":")[2], tag)
            problem = f"not valid YAML: {{value}} is not a {kind}"
            raise IctampError(Code.NOT_YAML, problem, line=_line(node), value=node.value) from error


class _PythonLoader(_Strict, yaml.SafeLoader):
    """PyYAML's own loader, which has the better error messages."""


class _Loader(_Strict, getattr(yaml, "CSafeLoader", yaml.SafeLoader)):  # type: ignore[misc]
    """Loader of libyaml where it is installed, ten times faster."""


def _refuse_repeated(node: yaml.Node | None, seen: set[int]) -> None:
    """Raise IctampError when the node, or a mapping in it, repeats a key; skip nodes `seen` before through an alias."""
    if isinstance(node, yaml.ScalarNode) or node is None or id(node) in seen:
        return
    seen.add(id(node))
    is_mapping = isinstance(node, yaml.MappingNode)
    for child in (part for pair in node.value for part in pair) if is_mapping else node.value:
        _refuse_repeated(child, seen)
    keys = set()
    for key in (key for key, _ in node.value if isinstance(key, yaml.ScalarNode)) if is_mapping else ():
        if key.value in keys:
            raise IctampError(Code.REPEATED, "{value} is used twice in one mapping", line=_line(key), value=key.value)
        keys.add(key.value)


def _line(node: yaml.Node) -> int:
    return int(node.start_mark.line) + 1


def read_bytes(path: Path | str, limit: int | None = None) -> bytes:
    """Read the content of a file.

    Raises:
        IctampError: The file cannot be read, or is larger than `limit` bytes, by default `MAX_BYTES`.
    """
    limit = limit or MAX_BYTES
    try:
        with Path(path).open("rb") as file:
            content = file.read(limit + 1)
    except OSError as error:
        raise IctampError(Code.NOT_READABLE, f"cannot be read: {error.strerror}", file=path) from error
    except ValueError as error:  # a NUL character in the path
        name = str(path).replace("\0", "\\0")
        raise IctampError(Code.NOT_READABLE, f"cannot be read: {error}", file=name) from error
    if len(content) > limit:
        raise IctampError(Code.TOO_LARGE, f"expected a file of at most {limit / 2**20:g} MiB", file=path)
    return content


def read_text(path: Path | str, limit: int | None = None) -> str:
    """Read the text of a file.

    Raises:
        IctampError: The file cannot be read, is not UTF-8, or is larger than `limit` bytes, by default `MAX_BYTES`.
    """
    try:
        return read_bytes(path, limit).decode("utf-8")
    except UnicodeDecodeError as error:
        raise IctampError(Code.NOT_TEXT, "not a text file in UTF-8", file=path) from error


def parse(text: str, limit: int | None = None) -> object:
    """Parse a YAML document into plain mappings, lists and scalars.

    Raises:
        IctampError: A syntax error, an impossible value, a repeated key, or a document that is too deep or has more
            than `limit` values, by default `MAX_NODES`.
    """
    limit = limit or MAX_NODES
    try:
        if len(text) > MAX_EXPLAINED:
            return _load(text, _Loader, limit)
        with suppress(yaml.YAMLError):  # what libyaml refuses is read again, for the sake of the message
            return _load(text, _Loader, limit)
        return _load(text, _PythonLoader, limit)
    except yaml.MarkedYAMLError as error:
        line = error.problem_mark.line + 1 if error.problem_mark else None
        raise IctampError(Code.NOT_YAML, f"not valid YAML: {error.problem}", line=line) from error
    except yaml.YAMLError as error:
        raise IctampError(Code.NOT_YAML, f"not valid YAML: {' '.join(str(error).split())}") from error
    except RecursionError as error:
        raise IctampError(Code.TOO_DEEP, _TOO_DEEP) from error


def parse_json(text: str | bytes) -> Any:
    """Parse a JSON document into plain mappings, lists and scalars.

    Raises:
        IctampError: A syntax error, or a document that is nested too deeply.
    """
    try:
        return json.loads(text)
    except ValueError as error:
        raise IctampError(Code.NOT_JSON, f"not valid JSON: {error}") from error
    except RecursionError as error:
        raise IctampError(Code.TOO_DEEP, "expected values nested less deeply") from error


@contextmanager
def in_file(path: Path | str) -> Iterator[None]:
    """Add the file to errors of a block, and for YAML files the line of the field."""
    try:
        yield
    except IctampError as error:
        field = error.where.field
        is_yaml = not error.where.file and Path(path).suffix in (".yaml", ".yml")
        error.add_file(path, _find_line(Path(path), field) if field and is_yaml else None)
        raise


def _load(text: str, loader: type[_Loader | _PythonLoader], limit: int) -> object:
    _check_limits(text, loader, limit)
    return yaml.load(text, Loader=loader)


def _check_limits(text: str, loader: type[_Loader | _PythonLoader], limit: int) -> None:
    """Raise IctampError when a YAML document is nested too deep or, with its aliases written out, too large."""
    measures: dict[str, tuple[int, int]] = {}  # size and height of what has an anchor
    unfinished: list[tuple[str | None, int, int]] = [(None, 0, 0)]  # of each collection anchor, size and height
    for event in yaml.parse(text, Loader=loader):
        line = event.start_mark.line + 1 if event.start_mark else None
        if isinstance(event, yaml.CollectionStartEvent):
            unfinished.append((event.anchor, 1, 1))
            size = height = 0
        elif isinstance(event, yaml.CollectionEndEvent):
            anchor, size, height = unfinished.pop()
            measures |= {anchor: (size, height)} if anchor else {}
        elif isinstance(event, yaml.AliasEvent):
            if any(anchor == event.anchor for anchor, *_ in unfinished):
                raise IctampError(Code.TOO_DEEP, "{value} contains itself", line=line, value=f"&{event.anchor}")
            size, height = measures.get(event.anchor or "", (1, 0))
        else:
            size, height = 1, 0
        anchor, size_around, height_around = unfinished[-1]
        unfinished[-1] = anchor, size_around + size, max(height_around, height + 1)
        if len(unfinished) + height > MAX_DEPTH:
            raise IctampError(Code.TOO_DEEP, _TOO_DEEP, line=line)
        if sum(size for _, size, _ in unfinished) > limit:
            raise IctampError(Code.TOO_LARGE, f"expected at most {limit} values, aliases written out", line=line)


def _find_line(path: Path, field: str) -> int | None:
    """Line of a field or, if it is missing, of what should have it; None if the file cannot be read."""
    for loader in (_Loader, _PythonLoader):
        with suppress(IctampError, yaml.YAMLError):
            return _find_node(yaml.compose(read_text(path), Loader=loader), field)
    return None


def _find_node(node: yaml.Node | None, field: str) -> int | None:
    """Line of the part of a node to which a field leads or, if it is missing, of its nearest parent."""
    line = None
    for key in re.findall(r"[^.\[\]]+", field):
        if isinstance(node, yaml.MappingNode):
            found = [(name, value) for name, value in node.value if name.value in spellings(key)]
        elif isinstance(node, yaml.SequenceNode) and key.isdigit():
            found = [(item, item) for item in node.value[int(key) : int(key) + 1]]
        else:
            found = []
        if not found:
            break
        (name, node), *_ = found
        line = _line(name)
    return line
