"""Your own parts: installed ones, and those named by `package.module:Class` or given as an object.

An installed package offers parts as entry points of these groups; users choose them by the entry point's name:

    [project.entry-points."ictamp_drake.samplers"]
    mine = "my_package.my_module:MySampler"

The text may set the part's constants, e.g. `mine(depth=0.02)` or `my_package.my_module:MySampler(depth=0.02)`.
"""

import ast
import dataclasses
import re
import sys
from collections.abc import Mapping
from functools import cache
from importlib import import_module, metadata
from multiprocessing import current_process
from typing import Any, TypeVar

from ictamp_drake.core.checks import check_choice
from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.protocols import Config

GROUPS = {
    "sampler": "ictamp_drake.samplers",
    "estimator": "ictamp_drake.estimators",
    "generator": "ictamp_drake.generators",
    "planner": "ictamp_drake.planners",
}
"""Group of entry points of each replaceable part of a `Method`."""

P = TypeVar("P")

_TEXT = re.compile(r"(?P<name>[\w.:-]+)(?P<constants>\(.*\))?", re.DOTALL)


def find_part(option: str, chosen: str | P, known: Mapping[str, P]) -> P:
    """Find the configuration of a part from its name, from a text, or from the configuration itself.

    Args:
        option: Key of `GROUPS`.
        chosen: Name or `package.module:Class`, optionally with constants in parentheses, or a configuration.
        known: Configurations of this package by name.

    Raises:
        IctampError: The part does not exist, cannot be imported or cannot be made.
    """
    if not isinstance(chosen, str):
        return chosen
    if chosen in known:
        return known[chosen]
    name, constants = _split_text(option, chosen)
    if ":" in name:
        return _make_part(option, chosen, _import_part(option, name), constants)
    installed = load_installed(option)
    check_choice(option, name, [*known, *installed])
    if name in known:
        problem, advice = "expected a name without constants, got {value}", f"set them by --{option}s.{name}.…"
        raise IctampError(Code.NOT_READABLE, problem, field=option, value=chosen, advice=advice)
    return _make_part(option, chosen, installed[name], constants)


def name_part(config: object) -> str:
    """Return the text that names the class of a configuration."""
    return f"{type(config).__module__}:{type(config).__qualname__}"


def list_constants(config: object) -> dict[str, Any]:
    """Return the constants of a configuration by name; empty if it is not a dataclass."""
    return dataclasses.asdict(config) if dataclasses.is_dataclass(config) and not isinstance(config, type) else {}


def set_constants(config: P, constants: Mapping[str, object]) -> P:
    """Copy a configuration with new values of some constants."""
    return type(config)(**{**vars(config), **constants})


def load_installed(option: str) -> dict[str, object]:
    """Return the parts of installed packages by name. Those that cannot be imported are named once on stderr."""
    return _load_all()[option]


@cache
def _load_all() -> dict[str, dict[str, object]]:
    points = metadata.entry_points()  # takes some milliseconds, hence the cache
    found: dict[str, dict[str, object]] = {option: {} for option in GROUPS}
    for option, group in GROUPS.items():
        for point in sorted(points.select(group=group)):
            try:
                found[option][point.name] = point.load()
            except (Exception, SystemExit) as error:
                if current_process().name == "MainProcess":  # workers keep quiet
                    part = f"{option} {point.name} ({point.value})"
                    print(f"{part} cannot be imported and is left out: {_say(error)}", file=sys.stderr)
    return found


def _split_text(option: str, text: str) -> tuple[str, dict[str, object]]:
    """Split a text into the name and the constants behind it."""
    match = _TEXT.fullmatch(text)
    if match is None:
        return text, {}
    try:
        call = ast.parse(f"part{match['constants'] or '()'}", mode="eval").body
        if not isinstance(call, ast.Call) or not isinstance(call.func, ast.Name) or call.args:
            raise ValueError("constants need names")
        return match["name"], {each.arg or "**": ast.literal_eval(each.value) for each in call.keywords}
    except (SyntaxError, ValueError) as error:
        problem = "cannot read the constants of {value}; expected e.g. mine(depth=0.02)"
        raise IctampError(Code.NOT_READABLE, problem, field=option, value=text) from error


def _import_part(option: str, name: str) -> object:
    module, _, attribute = name.partition(":")
    try:
        found = import_module(module)
        for part in attribute.split("."):
            found = getattr(found, part)
    except Exception as error:
        problem = f"cannot import {{value}}: {_say(error)}"
        raise IctampError(Code.NOT_FOUND, problem, field=option, value=name) from error
    return found


def _make_part(option: str, text: str, found: object, constants: Mapping[str, object]) -> Any:
    if isinstance(found, type):
        try:
            found = found(**constants)
        except TypeError as error:
            problem = f"cannot make {{value}}: {error}"
            raise IctampError(Code.UNKNOWN_FIELD, problem, field=option, value=text) from error
    elif constants:
        raise IctampError(Code.WRONG_TYPE, "cannot set constants of {value}: not a class", field=option, value=text)
    return found


def check_part(option: str, part: object) -> None:
    """Raise IctampError unless this is a configuration of a part."""
    if not isinstance(part, Config) or isinstance(part, type):
        problem = "expected the configuration of a part, with a method create(context), got {value}"
        raise IctampError(Code.WRONG_TYPE, problem, field=option, value=name_part(part))


def _say(error: BaseException) -> str:
    return f"{type(error).__name__}: {error}".partition("\n")[0]
