"""Tables in Markdown."""

from collections.abc import Iterable, Sequence


def table(headings: Sequence[object], rows: Iterable[Sequence[object]]) -> list[str]:
    """The lines of a table whose first column stands on the left and all others on the right."""
    rule = ["---", *["---:"] * (len(headings) - 1)]
    return [f"| {' | '.join(map(str, cells))} |" for cells in (headings, rule, *rows)]
