"""Tables in Markdown."""

from collections.abc import Iterable, Sequence


def table(headings: Sequence[object], rows: Iterable[Sequence[object]], left: int = 1) -> list[str]:
    """The lines of a table whose first columns, as many as `left`, stand on the left and all others on the right."""
    rule = ["---"] * left + ["---:"] * (len(headings) - left)
    return [f"| {' | '.join(map(str, cells))} |" for cells in (headings, rule, *rows)]
