"""Expressions in parentheses: how they are read, their places, and what is refused."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ictamp_drake.core.errors import Code
from ictamp_drake.symbolic.expressions import MAX_CHARACTERS, MAX_DEPTH, Expression, Group, quote_expression, read
from tests.refusals import refusal

words = st.text(alphabet="abc?:-=_019", min_size=1, max_size=5)
groups = st.recursive(
    st.builds(Group, st.lists(words, max_size=3).map(tuple), st.just(1)),
    lambda inner: st.builds(Group, st.lists(words | inner, max_size=4).map(tuple), st.just(1)),
    max_leaves=20,
)


@given(groups)
def test_what_is_written_is_read_back(group: Group) -> None:
    assert read(str(group)) == group


@given(groups, st.lists(st.sampled_from([" ", "\n", "\t", "; a comment\n"]), min_size=1, max_size=3).map("".join))
def test_spaces_lines_and_comments_make_no_difference(group: Group, space: str) -> None:
    def strip_lines(expression: Expression) -> object:
        return expression if isinstance(expression, str) else [strip_lines(item) for item in expression.items]

    spaced = str(group).replace(" ", space).replace("(", f"{space}({space}").replace(")", f"{space})")
    assert strip_lines(read(f"{spaced}{space}")) == strip_lines(group)


def test_a_group_knows_its_line() -> None:
    group = read("; first\n(a\n (b c)\n\n (d))")
    inner = [item for item in group.items if isinstance(item, Group)]
    assert [group.line, *(item.line for item in inner)] == [2, 3, 5]


@pytest.mark.parametrize(
    ("text", "code", "line", "value"),
    [
        ("", Code.NOT_PDDL, 1, None),
        ("; nothing\n; at all", Code.NOT_PDDL, 1, None),
        ("\nword", Code.NOT_PDDL, 2, "word"),
        (")", Code.NOT_PDDL, 1, ")"),
        ("(a\n(b\n)", Code.NOT_PDDL, 3, None),
        ("(a)\n(b)", Code.NOT_PDDL, 2, "("),
        ("(" * 1000, Code.TOO_DEEP, 1, None),
        ("(" + " a" * MAX_CHARACTERS, Code.TOO_LARGE, None, 2 * MAX_CHARACTERS + 1),
    ],
)
def test_what_is_no_expression_is_refused(text: str, code: Code, line: int | None, value: object) -> None:
    with refusal(code, line=line, value=value):
        read(text)


def test_the_deepest_nesting_is_read() -> None:
    assert str(read("(" * MAX_DEPTH + ")" * MAX_DEPTH)) == "(" * MAX_DEPTH + ")" * MAX_DEPTH


def test_a_message_quotes_no_more_than_a_line() -> None:
    assert quote_expression(read("(a\n (b c))")) == "(a (b c))"
    assert len(quote_expression(read(f"({' a' * 1000})"))) <= 80
    assert len(quote_expression("a" * 1000)) <= 80
