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
        problem: Its name.
        level: Its level.
        strategy: Name of the method; empty in a run of one method.
        seed: Seed of the method.
        solved: Whether a plan was found.
        reason: Why it was not solved, as a clause; empty when it was.
        details: What more there is to say about that, a clause each.
        error: What broke down; empty when nothing did.
        seconds: Time of planning [s].
        skills: Skills of the plan, None when there is none.
        steps: Low-level steps.
        picture: Address of its picture, relative to the page; empty when there is none.
        links: Addresses of its files, relative to the page, by what they are called.
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
        title: name of the run.
        entries: its problems that are over.
        waiting: how many are not.
        path: of the page.
    """
    data = to_script({"title": title, "waiting": waiting, "entries": [asdict(entry) for entry in entries]})
    script = f"<script>\nconst run = {data};\n{resource('index/table.js')}</script>\n"
    write_whole(path, resource("index/page.html") + script)
