"""Tables in Markdown."""

from collections.abc import Iterable, Sequence


def table(headings: Sequence[object], rows: Iterable[Sequence[object]], left: int = 1) -> list[str]:
    """Format the lines of a table. The first `left` columns are aligned to the left, all others to the right."""
    rule = ["---"] * left + ["---:"] * (len(headings) - left)
    return [f"| {' | '.join(map(str, cells))} |" for cells in (headings, rule, *rows)]


def drop_empty_columns(headings: Sequence[str], rows: Sequence[Sequence[str]]) -> tuple[list[str], list[list[str]]]:
    """Drop the columns without content, in which every row has "-", from headings and rows."""
    kept = [number for number in range(len(headings)) if any(cells[number] != "-" for cells in rows)]
    return [headings[number] for number in kept], [[cells[number] for number in kept] for cells in rows]
