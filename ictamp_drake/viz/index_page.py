"""index.html: the problems of a run with picture, result and links, to filter and to sort, without network."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path

from ictamp_drake.core.files import write_whole
from ictamp_drake.viz.page import resource, to_script


@dataclass(frozen=True, kw_only=True)
class Entry:
    """A problem as the page shows it.

    Attributes:
        problem: Name of the problem.
        level: Level of the problem.
        strategy: Name of the method; empty in a run with one method.
        seed: Random seed of the method.
        solved: Whether a plan was found.
        reason: Reason why the problem was not solved, as a clause; empty when it was solved.
        details: Further explanations of the reason, or facts about the plan, one line each.
        error: Description of the breakdown; empty when there was none.
        seconds: Planning time [s].
        skills: Number of skills in the plan; None when there is no plan.
        steps: Number of low-level steps.
        picture: Address of the picture, relative to the page; empty when there is none.
        links: Addresses of the problem's files, relative to the page, by their labels.
    """

    problem: str
    level: str
    strategy: str = ""
    seed: int = 0
    solved: bool = False
    reason: str = ""
    details: tuple[str, ...] = ()
    error: str = ""
    seconds: float = 0.0
    skills: int | None = None
    steps: int = 0
    picture: str = ""
    links: Mapping[str, str] = field(default_factory=dict)


def index_html(title: str, entries: Sequence[Entry], waiting: int, path: Path) -> None:
    """Write the page; it appears whole or not at all.

    Args:
        title: Name of the run.
        entries: Finished problems of the run.
        waiting: Number of unfinished problems.
        path: File of the page.
    """
    data = to_script({"title": title, "waiting": waiting, "entries": [asdict(entry) for entry in entries]})
    script = f"<script>\nconst run = {data};\n{resource('index/table.js')}</script>\n"
    write_whole(path, resource("index/page.html") + script)
