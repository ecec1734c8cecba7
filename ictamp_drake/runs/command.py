"""Common frame of all programs, from the command line to the exit code."""

import os
import sys
from collections.abc import Callable, Sequence
from typing import TypeVar

import tyro
from rich.console import Console

from ictamp_drake.core.errors import IctampError
from ictamp_drake.core.spelling import respell_option

T = TypeVar("T")

COMPLETE, UNSOLVED, BROKEN, BAD_INPUT, INTERRUPTED = 0, 1, 1, 2, 130
"""Exit codes: success; a single problem was not solved; some of several problems broke down; invalid input; Ctrl-C.

A single problem succeeds when it is solved, and several when each has a sound record, solved or not.
"""


def command(
    name: str,
    options: type[T],
    act: Callable[[T, Console], int],
    interrupted: str,
    arguments: Sequence[str] | None = None,
) -> int:
    """Run a program and return its exit code.

    Args:
        name: Name of the program's module.
        options: Dataclass that defines the command line.
        act: Function that does the work and returns the exit code.
        interrupted: Message on Ctrl-C.
        arguments: Command line, by default that of the process.
    """
    console = Console(width=None if sys.stdout.isatty() else 120, markup=False, emoji=False, highlight=False)
    config = (tyro.conf.FlagCreatePairsOff,)
    given = [respell_option(argument) for argument in (sys.argv[1:] if arguments is None else arguments)]
    prog = sys.argv[0] if sys.argv[0].startswith("ictamp ") else f"python -m {name}"
    try:
        return act(tyro.cli(options, prog=prog, args=given, config=config), console)
    except IctampError as error:
        print(error, *getattr(error, "__notes__", ()), sep="\n", file=sys.stderr)
        return BAD_INPUT
    except KeyboardInterrupt:
        print(interrupted, file=sys.stderr)
        return INTERRUPTED
    except BrokenPipeError:  # nobody reads on, as in `... --help | head`
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # for what Python still flushes at its end
        return BROKEN
