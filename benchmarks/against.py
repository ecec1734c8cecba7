"""Processor time of an older commit and of the working tree on the same problems, alternately and in one thread.

`python benchmarks/against.py --commit ba33f5b --levels easy medium --problems 0:10 --rounds 2 --out runs/against`

Each tree has its own process in each round, and the two never work at the same time; every second round begins with the
other tree. Adds a line to results.jsonl in the folder after each problem, and continues from there when called again.
Prints the ratios of the working tree to the commit, and writes them to table.md: medians over problems, with 95 %
bootstrap intervals over problems. The working tree is copied at the start and may be edited during the run.
"""

import hashlib
import json
import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterable, Iterator, Sequence
from contextlib import ExitStack, closing, contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pandas as pd
import tyro

from ictamp_drake.core.checks import check_range
from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.files import write_whole
from ictamp_drake.reports.comparison import PROBLEM, ratio
from ictamp_drake.reports.markdown import drop_empty_columns, table
from ictamp_drake.runs.conduct import Conduct
from ictamp_drake.runs.folder import RESULTS, open_run_folder
from ictamp_drake.scenes.levels import problem_files

ROOT = Path(__file__).parents[1]
PACKAGE = "ictamp_drake"
MEASURED = Path(__file__).with_name("measured.py")
WARM_UP = Path(__file__).with_name("scenes") / "warm_up.yaml"
BEFORE, AFTER = TREES = ("before", "after")
ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
OTHER = "_reference"
"""Suffix of the commit's figures, as `ratio` expects it."""

Row = dict[str, Any]


@dataclass(frozen=True)
class Options:
    """Compare a commit and the working tree.

    Attributes:
        commit: Commit with which to compare the working tree.
        out: Folder for the results; the folder of an unfinished comparison continues it.
        levels: Levels of the packing problems; ignored when there are scenes.
        problems: Number of a problem of each level, or a slice, e.g. 3, 0:5 or 10:.
        scenes: Scene files instead of levels; their folder counts as their level.
        rounds: Number of times that each tree solves each problem.
        shared: Options of both trees, e.g. --shared="--planner adaptive".
        options: Further options of the working tree only, e.g. --options="--time-limit 30".
        options_before: Further options of the commit only.
    """

    commit: str
    out: Path
    levels: tuple[str, ...] = ("easy", "medium", "hard")
    problems: str = ":"
    scenes: tuple[Path, ...] = ()
    rounds: int = 2
    shared: str = ""
    options: str = ""
    options_before: str = ""

    def __post_init__(self) -> None:
        check_range("rounds", self.rounds, 1, 1000)

    @property
    def by_tree(self) -> dict[str, str]:
        """All options of each tree."""
        return {BEFORE: f"{self.shared} {self.options_before}".strip(), AFTER: f"{self.shared} {self.options}".strip()}


def choose_problems(options: Options) -> list[Row]:
    """List the problems in order: level (or the scene's folder), name, and the scene or number for `measured.py`."""
    if options.scenes:
        paths = [path.absolute() for path in options.scenes]
        return [{"level": path.parent.name, "problem": path.stem, "scene": str(path)} for path in paths]
    return [
        {"level": level, "problem": f"{level}-{path.stem}", "number": int(path.stem)}
        for level in options.levels
        for path in problem_files(level, options.problems)
    ]


@dataclass
class Child:
    """A process that solves problems with the package of one tree; it starts when needed."""

    tree: Path
    options: str
    process: subprocess.Popen[str] | None = None

    def solve(self, problem: Row) -> Row:
        """Solve the problem and return its costs, or an error if the process died."""
        process = self.process or self._start()
        try:
            print(json.dumps(problem), file=process.stdin, flush=True)
            return self._answer()
        except (BrokenPipeError, EOFError):
            self.close()
            return {"solved": False, "error": "the process ended"}

    def _start(self) -> subprocess.Popen[str]:
        self.process = subprocess.Popen(
            [sys.executable, "-P", str(MEASURED), self.options, str(WARM_UP)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env={**os.environ, **ONE_THREAD, "PYTHONPATH": str(self.tree)},
            start_new_session=True,  # Ctrl-C is for the parent, which then ends it
        )
        try:
            ready = self._answer()
        except EOFError:
            raise IctampError(
                Code.CONFLICT, "its process cannot start with the options {value}", file=self.tree, value=self.options
            ) from None
        if not Path(ready["package"]).is_relative_to(self.tree):
            raise IctampError(Code.CONFLICT, f"expected the package of {self.tree}", file=ready["package"])
        if "error" in ready:
            problem = f"cannot plan here with {self.tree}: {ready['error']}"
            raise IctampError(Code.CONFLICT, problem, file=WARM_UP)
        return self.process

    def _answer(self) -> Row:
        line = self.process.stdout.readline() if self.process and self.process.stdout else ""
        if not line:
            raise EOFError
        return dict(json.loads(line))

    def close(self) -> None:
        """End the process."""
        if self.process is not None:
            self.process.kill()
            self.process.communicate()
            self.process = None


def git(*arguments: str) -> str:
    """Return the output of git in this repository; raise IctampError when it fails."""
    done = subprocess.run(["git", "-C", str(ROOT), *arguments], capture_output=True, text=True, check=False)
    if done.returncode:
        raise IctampError(Code.NOT_FOUND, f"git {' '.join(arguments)}: {done.stderr.strip()}")
    return done.stdout.strip()


@contextmanager
def trees(commit: str) -> Iterator[dict[str, Path]]:
    """Yield the commit and the working tree's package, each in a temporary folder that is removed at the end."""
    with TemporaryDirectory() as temporary:
        paths = {tree: Path(temporary).resolve() / tree for tree in TREES}
        shutil.copytree(ROOT / PACKAGE, paths[AFTER] / PACKAGE, ignore=shutil.ignore_patterns("__pycache__"))
        try:
            git("worktree", "add", "--detach", str(paths[BEFORE]), commit)
            yield paths
        finally:
            with suppress(IctampError):  # when it was not added
                git("worktree", "remove", "--force", str(paths[BEFORE]))


def digest(folder: Path) -> str:
    """Hash of a folder's content."""
    found = hashlib.sha256()
    for path in sorted(path for path in folder.rglob("*") if path.is_file()):
        found.update(f"{path.relative_to(folder)}\0{path.stat().st_size}\0".encode() + path.read_bytes())
    return found.hexdigest()[:16]


def read(path: Path) -> list[Row]:
    """Read the last row of each measurement."""
    lines = path.read_text().splitlines() if path.exists() else []
    return list({key(row): row for row in map(json.loads, lines)}.values())


def key(row: Row) -> tuple[Any, ...]:
    """Key that identifies a measurement."""
    return tuple(row[name] for name in ("round", *PROBLEM, "tree"))


def list_missing(problems: Sequence[Row], rounds: int, rows: Iterable[Row]) -> Iterator[list[Row]]:
    """Yield the missing measurements in order, one list per round. Failed measurements are repeated."""
    done = {key(row) for row in rows if "error" not in row}
    for number in range(rounds):
        order = TREES if number % 2 == 0 else TREES[::-1]
        turns = [{"round": number, "tree": tree, **problem} for problem in problems for tree in order]
        yield [turn for turn in turns if key(turn) not in done]


def measure(options: Options, problems: Sequence[Row]) -> list[Row]:
    """Measure what is missing and return all rows."""
    options_of = options.by_tree
    with trees(options.commit) as paths:
        about = {
            "program": "against",
            "commit": git("rev-parse", f"{options.commit}^{{commit}}"),
            "working_tree": digest(paths[AFTER] / PACKAGE),
            "options_before": options_of[BEFORE],
            "options_after": options_of[AFTER],
        }
        with open_run_folder("against", about, Conduct(out=options.out)) as folder:
            results = folder / RESULTS
            for turns in list_missing(problems, options.rounds, read(results)):
                with ExitStack() as stack:
                    new = {tree: Child(paths[tree], options_of[tree]) for tree in TREES}
                    children = {tree: stack.enter_context(closing(child)) for tree, child in new.items()}
                    for turn in turns:
                        add(turn | children[turn["tree"]].solve(turn), results)
            wanted = {key(turn) for turns in list_missing(problems, options.rounds, ()) for turn in turns}
            return [row for row in read(results) if key(row) in wanted]


def add(row: Row, path: Path) -> None:
    """Add a line to the results and show progress."""
    with path.open("a") as file:
        file.write(json.dumps(row) + "\n")
        file.flush()
        os.fsync(file.fileno())
    became = "error" if "error" in row else f"{row['cpu_s']:.2f} s{'' if row['solved'] else ', not solved'}"
    print(f"round {row['round']}, {row['level']}, {row['problem']}, {row['tree']}: {became}", file=sys.stderr)


def pair_rows(rows: Iterable[Row]) -> pd.DataFrame:
    """Return one line per round and problem that both trees ran; names of the commit's figures end with `OTHER`."""
    columns = ["round", *PROBLEM, "tree", "solved", "cpu_s", "plan_duration_s", "geometric_time_s"]
    runs = pd.DataFrame(list(rows), columns=columns)
    after, before = (runs[runs["tree"] == tree].drop(columns="tree") for tree in (AFTER, BEFORE))
    return after.merge(before, on=["round", *PROBLEM], suffixes=("", OTHER), validate="1:1")


def ratios(pairs: pd.DataFrame) -> list[str]:
    """Format a table with one row per level."""
    headings = ["level", "problems", "solved before", "solved after", "CPU before [s]", "CPU after [s]"]
    headings += ["CPU after / before (95 %)", "first geometric plan / CPU before (95 %)", "plan duration (95 %)"]
    rows = []
    for level, group in pairs.groupby("level", sort=False):
        both = group[group["solved"].astype(bool) & group[f"solved{OTHER}"].astype(bool)]
        geometric = both.assign(**{f"geometric_time_s{OTHER}": both[f"cpu_s{OTHER}"]})
        solved = [f"{int(group[name].sum())} of {len(group)}" for name in (f"solved{OTHER}", "solved")]
        seconds = [typical(both, name) for name in (f"cpu_s{OTHER}", "cpu_s")]
        found = [part(both, "cpu_s"), part(geometric, "geometric_time_s"), part(both, "plan_duration_s")]
        rows.append([str(level), str(group["problem"].nunique()), *solved, *seconds, *found])
    return table(*drop_empty_columns(headings, rows))


def typical(runs: pd.DataFrame, figure: str) -> str:
    """Median over problems of the median over rounds."""
    value = runs.groupby("problem")[figure].median().median()
    return "-" if pd.isna(value) else f"{value:.2f}"


def part(both: pd.DataFrame, figure: str) -> str:
    """Ratio of the working tree's figure to the commit's, with its interval if there are enough problems."""
    found = ratio(both, figure)
    if found is None:
        return "-"
    return f"{found.value:.3f}" + (f" ({found.low:.3f} to {found.high:.3f})" if found.low == found.low else "")


def report(options: Options, rows: Sequence[Row]) -> str:
    """Return the tables, and a note on what they exclude."""
    pairs = pair_rows(rows)
    one = int((pairs["solved"] != pairs[f"solved{OTHER}"]).sum())
    broken = sum("error" in row for row in rows)
    excluded = (
        "Processor time of one thread from before the scene is read until a plan is verified or given up. Not counted: "
        "imports, one problem to warm up in each process, garbage collection between problems. Ratios and medians are "
        f"those of runs that both trees solved: {one} were solved by one tree alone, {broken} broke down."
    )
    of = options.by_tree
    head = f"Before: {options.commit} {of[BEFORE]}".rstrip() + f"; after: the working tree {of[AFTER]}".rstrip() + "."
    return "\n".join([head, "", *ratios(pairs), "", excluded]) + "\n"


def main() -> None:
    """Measure and print; a user's mistake ends with one sentence."""
    options = tyro.cli(Options, description=__doc__)
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(128 + signal.SIGTERM))  # so that temporary folders are removed
    try:
        text = report(options, measure(options, choose_problems(options)))
        write_whole(options.out / "table.md", text)
        print(text)
    except IctampError as error:
        sys.exit(str(error))
    except KeyboardInterrupt:
        sys.exit("Interrupted; the same command continues.")


if __name__ == "__main__":
    main()
