"""Tables in Markdown."""

from collections.abc import Iterable, Sequence


def table(headings: Sequence[object], rows: Iterable[Sequence[object]], left: int = 1) -> list[str]:
    """The lines of a table whose first columns, as many as `left`, stand on the left and all others on the right."""
    rule = ["---"] * left + ["---:"] * (len(headings) - left)
    return [f"| {' | '.join(map(str, cells))} |" for cells in (headings, rule, *rows)]


def drop_empty_columns(headings: Sequence[str], rows: Sequence[Sequence[str]]) -> tuple[list[str], list[list[str]]]:
    """Headings and rows without the columns that hold nothing, in which every row has "-"."""
    kept = [number for number in range(len(headings)) if any(cells[number] != "-" for cells in rows)]
    return [headings[number] for number in kept], [[cells[number] for number in kept] for cells in rows]
