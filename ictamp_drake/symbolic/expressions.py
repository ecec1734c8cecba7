"""Expressions in brackets, the form of all PDDL: from text to groups of words and groups."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from textwrap import shorten

from ictamp_drake.core.errors import Code, IctampError

MAX_CHARACTERS = 200_000
"""Longest text that is read."""

MAX_DEPTH = 50
"""Deepest nesting of brackets, low enough for functions that call themselves once a level."""

_TOKEN = re.compile(r"[()]|[^\s()]+")


@dataclass(frozen=True)
class Group:
    """What stands between an opening bracket and its closing one.

    Attributes:
        items: words and groups in their order.
        line: number of the line of the opening bracket, from 1.
    """

    items: tuple["Expression", ...]
    line: int

    def __str__(self) -> str:
        return f"({' '.join(map(str, self.items))})"


Expression = str | Group


def read(text: str) -> Group:
    """The one group that a text consists of; a semicolon begins a comment.

    Raises:
        IctampError: what was expected in which line.
    """
    if len(text) > MAX_CHARACTERS:
        problem = f"expected at most {MAX_CHARACTERS} characters, got {{value}}"
        raise IctampError(Code.TOO_LARGE, problem, value=len(text))
    whole, line = None, 1
    unclosed: list[tuple[int, list[Expression]]] = []
    for token, line in _tokens(text):
        if whole is not None:
            raise _unexpected(token, "the end of the text", line)
        if token == "(":
            unclosed.append((line, []))
            if len(unclosed) > MAX_DEPTH:
                problem = f"expected brackets nested at most {MAX_DEPTH} deep"
                raise IctampError(Code.TOO_DEEP, problem, line=line)
        elif not unclosed:
            raise _unexpected(token, "(", line)
        elif token != ")":
            unclosed[-1][1].append(token)
        else:
            start, items = unclosed.pop()
            group = Group(tuple(items), start)
            if unclosed:
                unclosed[-1][1].append(group)
            else:
                whole = group
    if whole is None:
        missing = f") for the ( of line {unclosed[-1][0]}" if unclosed else "("
        raise IctampError(Code.NOT_PDDL, f"expected {missing}, got the end of the text", line=line)
    return whole


def _unexpected(token: str, expected: str, line: int) -> IctampError:
    return IctampError(Code.NOT_PDDL, f"expected {expected}, got {{value}}", line=line, value=quote_expression(token))


def _tokens(text: str) -> Iterator[tuple[str, int]]:
    """Brackets and words with the numbers of their lines."""
    for line, content in enumerate(text.split("\n"), start=1):
        yield from ((token, line) for token in _TOKEN.findall(content.partition(";")[0]))


def quote_expression(expression: Expression) -> str:
    """The expression as a message quotes it, on one line and not too long."""
    return shorten(str(expression), 80, placeholder=" ...")
