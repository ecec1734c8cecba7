"""From a command line to an exit code: what every program does around its own work."""

import sys
from collections.abc import Callable, Sequence
from typing import TypeVar

import tyro
from rich.console import Console

from ictamp_drake.core.errors import IctampError

T = TypeVar("T")

COMPLETE, BROKEN, BAD_INPUT, INTERRUPTED = 0, 1, 2, 130
"""Exit codes: all came to an end, with or without success; some broke down; a mistake of the user; Ctrl-C."""


def command(
    name: str,
    options: type[T],
    act: Callable[[T, Console], int],
    interrupted: str,
    arguments: Sequence[str] | None = None,
) -> int:
    """Run a program and return its exit code.

    Args:
        name: of its module.
        options: dataclass that its command line is derived from.
        act: the program's work; returns its exit code.
        interrupted: what is said on Ctrl-C.
        arguments: command line, that of the process by default.
    """
    console = Console(width=None if sys.stdout.isatty() else 120, markup=False, emoji=False, highlight=False)
    config = (tyro.conf.FlagCreatePairsOff,)
    prog = sys.argv[0] if sys.argv[0].startswith("ictamp ") else f"python -m {name}"
    try:
        return act(tyro.cli(options, prog=prog, args=arguments, config=config), console)
    except IctampError as error:
        print(error, file=sys.stderr)
        return BAD_INPUT
    except KeyboardInterrupt:
        print(interrupted, file=sys.stderr)
        return INTERRUPTED
