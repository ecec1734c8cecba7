"""Names that a module promises and imports only when they are used, since Drake and torch take a second to load."""

from collections.abc import Callable, Mapping
from importlib import import_module
from typing import Any


def import_lazily(module: str, names: dict[str, Any], homes: Mapping[str, str]) -> Callable[[str], Any]:
    """The `__getattr__` of a module.

    Args:
        module: Name of the module.
        names: Its globals, which keep what was imported.
        homes: For each promised name where it is defined, e.g. tamp.task:load.
    """

    def get(name: str) -> Any:
        if name not in homes:
            raise AttributeError(f"module {module!r} has no attribute {name!r}")
        home, _, attribute = homes[name].partition(":")
        names[name] = getattr(import_module(f"ictamp_drake.{home}"), attribute)
        return names[name]

    return get
