"""Parenthesized expressions, the syntax of PDDL: parsing of text into nested groups of words."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from textwrap import shorten

from ictamp_drake.core.errors import Code, IctampError

MAX_CHARACTERS = 200_000
"""Maximum length of a text."""

MAX_DEPTH = 50
"""Maximum depth of nested parentheses, low enough for recursion with one call per level."""

_TOKEN = re.compile(r"[()]|[^\s()]+")


@dataclass(frozen=True)
class Group:
    """Content between an opening parenthesis and its closing one.

    Attributes:
        items: Words and groups in their order.
        line: Line number of the opening parenthesis, from 1.
    """

    items: tuple["Expression", ...]
    line: int

    def __str__(self) -> str:
        return f"({' '.join(map(str, self.items))})"


Expression = str | Group


def read(text: str) -> Group:
    """Read a text that consists of one group. A semicolon begins a comment.

    Raises:
        IctampError: The text is malformed. The message names the line and what was expected there.
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
            raise _unexpected(token, "'('", line)
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
        missing = f"')' for the '(' of line {unclosed[-1][0]}" if unclosed else "'('"
        raise IctampError(Code.NOT_PDDL, f"expected {missing}, got the end of the text", line=line)
    return whole


def _unexpected(token: str, expected: str, line: int) -> IctampError:
    return IctampError(Code.NOT_PDDL, f"expected {expected}, got {{value}}", line=line, value=quote_expression(token))


def _tokens(text: str) -> Iterator[tuple[str, int]]:
    """Yield parentheses and words with their line numbers."""
    for line, content in enumerate(text.split("\n"), start=1):
        yield from ((token, line) for token in _TOKEN.findall(content.partition(";")[0]))


def quote_expression(expression: Expression) -> str:
    """Format the expression for a message, on one line and shortened."""
    return shorten(str(expression), 80, placeholder=" ...")
