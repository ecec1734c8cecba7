"""Older spellings that remain readable: in options, scenes, configurations, records and data."""

from typing import Any

TODAY = {"optimisation": "optimization", "optimisation-constant": "optimization-constant", "colour": "color"}
"""Today's spelling of each older name."""


def respell(name: str) -> str:
    """Return today's spelling of a name."""
    return TODAY.get(name, name)


def spellings(name: str) -> list[str]:
    """Return all spellings of a name, today's first."""
    return [respell(name), *(older for older, today in TODAY.items() if today == respell(name))]


def respell_option(argument: str) -> str:
    """Return a command-line argument with today's spelling of its option, e.g. --samplers.optimization.turn."""
    if not argument.startswith("--"):
        return argument
    name, equals, value = argument.removeprefix("--").partition("=")
    return f"--{'.'.join(map(respell, name.split('.')))}{equals}{value}"


def respell_options(values: Any) -> Any:
    """Return options, in types that YAML supports, with today's spelling of their names."""
    if not isinstance(values, dict):
        return values
    return {
        respell(key): respell(value) if key == "sampler" and isinstance(value, str) else respell_options(value)
        for key, value in values.items()
    }
