"""Older spellings that stay readable for good: in options, scenes, configurations, records and data."""

from typing import Any

TODAY = {"optimisation": "optimization", "optimisation-constant": "optimization-constant", "colour": "color"}
"""What is written today for each older name."""


def respell(name: str) -> str:
    """The name as it is written today."""
    return TODAY.get(name, name)


def spellings(name: str) -> list[str]:
    """All that the name is or was written as."""
    return [respell(name), *(older for older, today in TODAY.items() if today == respell(name))]


def respell_option(argument: str) -> str:
    """An argument of a command line, its option named as it is today, e.g. --samplers.optimization.turn."""
    if not argument.startswith("--"):
        return argument
    name, equals, value = argument.removeprefix("--").partition("=")
    return f"--{'.'.join(map(respell, name.split('.')))}{equals}{value}"


def respell_options(values: Any) -> Any:
    """Options in the types of YAML, as they are named today."""
    if not isinstance(values, dict):
        return values
    return {
        respell(key): respell(value) if key == "sampler" and isinstance(value, str) else respell_options(value)
        for key, value in values.items()
    }
