"""Results of a run as a table, and explanations of unsolved problems."""

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from statistics import mean, median

from rich import box
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from ictamp_drake.core.failures import Failure
from ictamp_drake.runs.records import OWN, Record

LEGEND = (
    "Medians over the solved problems: time to a verified plan [s], high-level plans, low-level steps, low-level steps "
    "for each skill of the plan, planning time / computing time of executing the plan once."
)


def format_results(records: Sequence[Record]) -> Group:
    """Format everything that is printed at the end of a run."""
    parts: list[RenderableType] = [Text(), results(records), Text(LEGEND, "dim")]
    if failures := sum((Counter(record.failures) for record in records), Counter[str]()):
        steps = sum(record.low_level_steps for record in records)
        parts += [Text(), _failures(failures, steps)]
    if len(records) == 1 and records[0].torque is not None:
        parts += [Text(), Text(str(records[0].torque))]
    for record in records:
        if not record.solved and (record.error is not None or not record.strategy):
            parts += [Text(), *explain_unsolved(record)]
    return Group(*parts)


def results(records: Sequence[Record]) -> Table:
    """Table of results, with a row per level and strategy, or per kind of interference and for all problems."""
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    columns = ("problems", "solved", "time median", "mean", "plans", "steps", "steps / skill", "overhead")
    for column in columns:
        table.add_column(column, justify="left" if column == "problems" else "right")
    for name, group in _groups(records):
        table.add_row(name, *figures(group))
    return table


def figures(records: Sequence[Record]) -> list[str]:
    """Cells of one row of the table of results, see `LEGEND`."""
    solved = [record for record in records if record.solved]

    def of(figure: Callable[[Record], float], average: Callable[[list[float]], float] = median) -> str:
        return f"{average([figure(record) for record in solved]):.3g}" if solved else "-"

    return [
        f"{len(solved)} of {len(records)}",
        of(lambda record: record.planning_time_s),
        of(lambda record: record.planning_time_s, mean),
        of(lambda record: record.high_level_plans),
        of(lambda record: record.low_level_steps),
        of(lambda record: record.low_level_steps / (record.plan_length or 1)),
        of(lambda record: record.planning_time_s / (record.replay_time_s or 1)),
    ]


def _groups(records: Sequence[Record]) -> Iterator[tuple[str, list[Record]]]:
    """Group records by level and strategy if they have strategies, otherwise by kind of interference, then all."""
    if any(record.strategy for record in records):
        groups: dict[str, list[Record]] = {}
        for record in records:
            groups.setdefault(f"{record.level or OWN}  {record.strategy}", []).append(record)
        yield from groups.items()
        return
    kinds = sorted({kind for record in records for kind in record.interference})
    if kinds:
        plain = [record for record in records if not record.interference]
        yield from [("plain", plain)] if plain else []
        for kind in kinds:
            yield f"with {kind}", [record for record in records if kind in record.interference]
    yield "all", list(records)


def _failures(failures: Counter[str], steps: int) -> Table:
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column(f"failures in {steps} low-level steps")
    table.add_column("", justify="right")
    for name, count in failures.most_common():
        table.add_row(str(Failure.__members__.get(name, name)), str(count))
    return table


def explain_unsolved(record: Record) -> Iterator[Text]:
    """Yield lines that explain why a problem was not solved: the causes that blocked actions that never succeeded."""
    explanation = record.explanation
    yield Text(f"{record.problem}: {explanation.reason}", "bold")
    if record.error is not None:
        yield Text(f"  {record.error.strip()}", "red")
        return
    for line in explanation.lines():
        yield Text(f"  {line}")
