"""Collection of training data: random walks through training scenes, with one row of a Parquet file per attempt.

`python -m ictamp_drake.experiments.collect --scenes 0:500 --out data/attempts`

After an interruption of any kind, the same command continues. `learning.dataset` documents the rows, `collection.walk`
the walks, and `scenes.training` the scenes.
"""

import json
import sys
import time
from collections.abc import Sequence
from concurrent.futures import FIRST_COMPLETED, Future, wait
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated

import tyro
from rich.console import Console

from ictamp_drake.collection.shards import Shards, summary
from ictamp_drake.collection.walk import WalkConfig, write_walk
from ictamp_drake.core.checks import check_range
from ictamp_drake.core.files import make_folder, read_json, write_whole
from ictamp_drake.runs.command import BROKEN, COMPLETE, command
from ictamp_drake.runs.engine import EngineConfig
from ictamp_drake.runs.folder import check_same, lock_folder
from ictamp_drake.runs.pool import end_with_parent
from ictamp_drake.runs.progress import format_clock
from ictamp_drake.runs.provenance import provenance
from ictamp_drake.scenes.levels import parse_selection

COLLECTION = "collection.json"
"""File beside the attempts that records how they were made, with a summary of them."""

MAX_SCENES = 1_000_000
_MAX_SPARED = 3
"""Number of attempts per scene in which a process may die or hang. After one more, the scene is given up."""
_REPORT = 30.0
"""Time between two progress lines [s]."""


@dataclass(frozen=True)
class Collect:
    """Collect attempts at skills in training scenes.

    Attributes:
        out: Folder for the attempts. An existing folder is continued, and scenes can be added to it.
        scenes: Number of a training scene or slice of scenes, e.g. 3 or 0:500.
        seed: Random seed of the scenes and walks.
        limit: Time after which the walk through one scene counts as hung [s].
        engine: Processes that walk through the scenes, each one scene at a time. All need access to the folder `out`.
        walk: Settings of the random walks.
    """

    out: Path
    scenes: str = "0:100"
    seed: int = 0
    limit: float = 600.0
    engine: Annotated[EngineConfig, tyro.conf.arg(name="")] = EngineConfig()
    walk: WalkConfig = WalkConfig()

    def __post_init__(self) -> None:
        check_range("seed", self.seed, 0, 2**63 - 1)
        check_range("limit", self.limit, 1, 1e6, " s")


def collect(options: Collect, console: Console) -> int:
    """Collect the missing scenes, print a summary of the folder, and return the exit code.

    Raises:
        IctampError: The folder holds attempts made with other options, is in use, or cannot be written.
    """
    scenes = parse_selection(options.scenes, MAX_SCENES, "scenes")
    options.walk.check()
    options.engine.check()
    make_folder(options.out)
    with lock_folder(options.out):
        _check_same(options)
        shards = Shards(options.out)
        shards.join(scenes)
        done = shards.list_done()
        todo = [scene for scene in scenes if scene not in done]
        console.print(f"{options.out}: {len(todo)} scenes to walk through, {len(scenes) - len(todo)} done before")
        broken = _walk_all(options, todo, shards, console) if todo else 0
        shards.join(scenes)
        _conclude(options, console)
    return BROKEN if broken else COMPLETE


def _check_same(options: Collect) -> None:
    """Record how attempts are made, or compare the options with those on record."""
    path = options.out / COLLECTION
    fixed = json.loads(json.dumps({"seed": options.seed, "walk": asdict(options.walk)}, default=str))
    if not path.exists():
        write_whole(path, json.dumps({**fixed, **provenance()}, indent=2))
        return
    before = read_json(path)
    check_same(options.out, {key: before.get(key) for key in fixed}, fixed)


def _walk_all(options: Collect, todo: Sequence[int], shards: Shards, console: Console) -> int:
    """Walk through the scenes in worker processes and return the number of breakdowns.

    After a breakdown the walk through the scene is repeated without the attempt that caused it.
    """
    progress = _Progress(len(todo), console)
    spared: dict[int, list[int]] = {scene: [] for scene in todo}
    out = options.out.absolute()
    with options.engine.start(len(todo), end_with_parent) as engine:

        def start(scene: int) -> Future[tuple[int, int]]:
            how = options.seed, options.walk, spared[scene]
            return engine.submit(write_walk, out, scene, *how, timeout=options.limit)

        pending = {start(scene): scene for scene in todo}
        while pending:
            for future in wait(pending, timeout=1.0, return_when=FIRST_COMPLETED).done:
                scene = pending.pop(future)
                try:
                    progress.add(*future.result())
                except Exception as error:
                    attempt = shards.read_begun(scene)
                    again = attempt is not None and len(spared[scene]) < _MAX_SPARED
                    spared[scene].append(-1 if attempt is None else attempt)
                    what = f"is walked through again without attempt {attempt}" if again else "is given up"
                    console.print(f"scene {scene} {what}: {error!r}".partition("\n")[0])
                    if again:
                        pending[start(scene)] = scene
                    else:
                        shards.add(scene, [])
                        progress.add(0, 0)
                if progress.finished % 10 == 0:
                    shards.join(todo)
            progress.tell()
    return sum(map(len, spared.values()))


class _Progress:
    """Printer of regular progress lines: work done, speed, and time left."""

    def __init__(self, total: int, console: Console) -> None:
        self._total = total
        self._console = console
        self._start = self._told = time.monotonic()
        self._attempts = self._executed = 0
        self.finished = 0

    def add(self, attempts: int, executed: int) -> None:
        """Count a finished scene."""
        self.finished += 1
        self._attempts += attempts
        self._executed += executed

    def tell(self) -> None:
        """Print a line when one is due."""
        now = time.monotonic()
        if now - self._told < _REPORT and self.finished < self._total:
            return
        self._told = now
        elapsed = now - self._start
        left = format_clock(elapsed / self.finished * (self._total - self.finished)) if self.finished else "unknown"
        self._console.print(
            f"{format_clock(elapsed)}  {self.finished} of {self._total} scenes, {self._attempts} attempts, "
            f"{self._executed} executed ({60 * self._executed / elapsed:.0f} a minute), time left {left}"
        )


def _conclude(options: Collect, console: Console) -> None:
    """Write a summary beside the data, and print it."""
    path = options.out / COLLECTION
    about = read_json(path)
    about["summary"] = found = summary(options.out)
    write_whole(path, json.dumps(about, indent=2))
    rate = found["succeeded"] / max(1, found["executed"])
    console.print(
        f"\n{found['scenes']} scenes, {found['attempts']} attempts, {found['executed']} executed, {rate:.0%} of these "
        f"succeeded; {sum(found['cpu_hours'].values()):.2f} CPU hours, {found['bytes'] / 1e6:.1f} MB"
    )
    for name, counts in found["by_skill_and_sampler"].items():
        share = counts["succeeded"] / max(1, counts["executed"])
        console.print(
            f"  {name:20} {counts['attempts']:7} attempts {counts['executed']:7} executed {share:5.0%} succeeded"
        )
    for name, failures in found["failures"].items():
        console.print(f"  {name} failed: " + ", ".join(f"{cause} {count}" for cause, count in failures.items()))


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the program and return its exit code."""
    interrupted = "Interrupted; the same command goes on, and repeats at most the scenes under way."
    return command("ictamp_drake.experiments.collect", Collect, collect, interrupted, arguments)


if __name__ == "__main__":
    sys.exit(main())
