"""Load and prepare spoiled scene files: `python -m benchmarks.fuzz_scenes`, ten to twenty minutes for 5,000 files.

A process that may die takes one file after the other; another takes its place then. What became of each file goes to
a file in runs/, so that the same command continues after an interruption. Writes a table to benchmarks/fuzz_scenes.md.
"""

import gc
import json
import multiprocessing
import os
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from multiprocessing.connection import Connection
from pathlib import Path

import numpy as np
import tyro

from benchmarks.spoiled import spoiled
from ictamp_drake.core.errors import IctampError
from ictamp_drake.core.files import write_whole
from ictamp_drake.reports import markdown
from ictamp_drake.tamp.task import load

OUT = Path(__file__).with_suffix(".md")
LONGEST = 1000
"""Length of the longest sentence that counts as one [characters]; half of it may be quotation."""
SLOW = 5.0
"""Processor time after which a file counts as slow [s]."""
GIVE_UP = 60.0
"""Time after which the process is ended [s]."""
SENTENCE, ACCEPTED = "sentence", "accepted"


@dataclass(frozen=True)
class Options:
    """Load and prepare spoiled scene files.

    Attributes:
        count: Number of files.
        seed: Random seed of the files.
        log: File of results, which is continued.
        minutes: Time after which to stop [min]; the table then says how many files were tried.
    """

    count: int = 5000
    seed: int = 25
    log: Path = Path("runs/fuzz_scenes.jsonl")
    minutes: float = 60.0


@dataclass(frozen=True)
class Outcome:
    """What became of a file.

    Attributes:
        number: Number of the file.
        kind: Class of the file.
        outcome: "sentence", "accepted", or the name of another exception or end.
        detail: Text of the error.
        seconds: Processor time [s].
        rss: Memory of the process afterwards [MB].
        process: Number of the process.
    """

    number: int
    kind: str
    outcome: str
    detail: str = ""
    seconds: float = 0.0
    rss: float = 0.0
    process: int = 0


def serve(connection: Connection, seed: int) -> None:
    """Try the files whose numbers come in, until the connection is closed."""
    path = Path(tempfile.mkdtemp()) / "scene.yaml"
    while (number := connection.recv()) is not None:
        kind, content = spoiled(seed, number)
        path.write_bytes(content)
        started = time.process_time()
        outcome, detail = attempt(path)
        seconds = time.process_time() - started
        if number % 50 == 0:
            gc.collect()
        connection.send(Outcome(number, kind, outcome, detail[:3000], round(seconds, 4), memory(), os.getpid()))
    path.unlink(missing_ok=True)
    path.parent.rmdir()


def attempt(path: Path) -> tuple[str, str]:
    """Return how loading and preparing a file ended, and the text of the error."""
    try:
        load(path)
    except IctampError as error:
        text = str(error)
        is_sentence = "\n" not in text and len(text) - len(str(path)) <= LONGEST and str(path) in text
        return SENTENCE if is_sentence else "bad sentence", text
    except BaseException as error:  # Drake ends processes with SystemExit
        return type(error).__name__, repr(error)
    return ACCEPTED, ""


def memory() -> float:
    """Return the resident memory of this process [MB]."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6


class Tester:
    """A process that tries files, and is replaced when it dies or hangs. Used as a context, it ends with the block."""

    def __init__(self, seed: int) -> None:
        self._seed = seed
        self._process: multiprocessing.process.BaseProcess | None = None

    def __enter__(self) -> "Tester":
        return self

    def __exit__(self, *_: object) -> None:
        if self._process is not None:
            self._connection.send(None)
            self._process.join()

    def test(self, number: int) -> Outcome:
        """Return what becomes of a file."""
        if self._process is None:
            context = multiprocessing.get_context("spawn")
            self._connection, theirs = context.Pipe()
            self._process = context.Process(target=serve, args=(theirs, self._seed), daemon=True)
            self._process.start()
            theirs.close()
        self._connection.send(number)
        ended = "died"
        try:
            if self._connection.poll(GIVE_UP):
                return self._connection.recv()
            ended = "no end"
        except (EOFError, ConnectionError):
            pass
        self._process.kill()
        self._process.join()
        self._process = None
        return Outcome(number, spoiled(self._seed, number)[0], ended, seconds=GIVE_UP if ended == "no end" else 0.0)


def growth(outcomes: Sequence[Outcome]) -> float:
    """Return the growth of memory per file [MB]: the slope of a line, over processes that tried 100 files or more."""
    slopes = []
    for process in {each.process for each in outcomes if each.process}:
        rss = [each.rss for each in outcomes if each.process == process]
        if len(rss) >= 100:
            slopes.append((len(rss), np.polyfit(range(len(rss) // 10, len(rss)), rss[len(rss) // 10 :], 1)[0]))
    return float(sum(n * slope for n, slope in slopes) / sum(n for n, _ in slopes)) if slopes else float("nan")


def table(outcomes: Sequence[Outcome]) -> list[str]:
    """Return the lines of the table."""
    rows = []
    for kind in [*dict.fromkeys(each.kind for each in outcomes), "all"]:
        group = [each for each in outcomes if kind in (each.kind, "all")]
        ends = Counter(each.outcome for each in group)
        others = {name: count for name, count in ends.items() if name not in (SENTENCE, ACCEPTED)}
        seconds = [each.seconds for each in group]
        refused = [each.seconds for each in group if each.outcome == SENTENCE]
        rows.append(
            [
                kind,
                len(group),
                ends[SENTENCE],
                ends[ACCEPTED],
                ", ".join(f"{count} {name}" for name, count in others.items()) or 0,
                sum(each > SLOW for each in seconds),
                f"{np.median(seconds):.3f}",
                f"{max(seconds):.2f}",
                f"{max(refused, default=0.0):.2f}",
                max(len(each.detail) for each in group if each.outcome == SENTENCE),
            ]
        )
    heads = [
        "class",
        "files",
        "sentence",
        "accepted",
        "other",
        "> 5 s",
        "median s",
        "max s",
        "refused, max s",
        "longest",
    ]
    return markdown.table(heads, rows)


def main() -> None:
    """Try the files that were not tried yet, and write the table."""
    options = tyro.cli(Options, description=__doc__)
    options.log.parent.mkdir(parents=True, exist_ok=True)
    lines = options.log.read_text().splitlines() if options.log.exists() else []
    outcomes = {each.number: each for each in (Outcome(**json.loads(line)) for line in lines)}
    ends = time.monotonic() + 60 * options.minutes
    with Tester(options.seed) as tester, options.log.open("a") as log:
        for number in range(options.count):
            if number in outcomes or time.monotonic() > ends:
                continue
            outcomes[number] = each = tester.test(number)
            log.write(json.dumps(asdict(each)) + "\n")
            log.flush()
            if each.outcome not in (SENTENCE, ACCEPTED) or each.seconds > SLOW:
                print(
                    f"{number} {each.kind}: {each.outcome} after {each.seconds:.1f} s {each.detail[:300]}", flush=True
                )
    found = [outcomes[number] for number in sorted(outcomes)]
    text = [
        "# Spoiled scene files, loaded and prepared",
        "",
        f"{len(found)} files of seed {options.seed} by `python -m benchmarks.fuzz_scenes`; the classes are in",
        "benchmarks/spoiled.py. Seconds are processor time. sentence: refused with one line that names the file;",
        "longest: its number of characters. accepted: valid and ready for planning.",
        "",
        *table(found),
        "",
        f"Memory of the process grew by {growth(found):.3f} MB per file.",
        "",
    ]
    write_whole(OUT, "\n".join(text))
    print("\n".join(text))


if __name__ == "__main__":
    sys.exit(main())
