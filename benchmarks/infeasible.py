"""How soon impossible problems are refused: `python -m benchmarks.infeasible`, two minutes.

Writes infeasible.md beside it. Makes scenes of three kinds in which an action of every plan is impossible by
construction, and for each a twin in which the culprit is out of the way. Each is loaded and solved, with a limit of no
steps, so that what is not refused at once is not searched. Afterwards the problems of the levels are swept, none of
which is impossible.
"""

import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np
import tyro

from ictamp_drake.core.errors import IctampError
from ictamp_drake.core.failures import Failure
from ictamp_drake.core.files import write_whole
from ictamp_drake.reports import markdown
from ictamp_drake.scenes.spec import BoxSpec, SceneSpec, SupportSpec, load_scene
from ictamp_drake.tamp.explanation import Explanation
from ictamp_drake.tamp.method import SCENE_METHOD
from ictamp_drake.tamp.solve import solve
from ictamp_drake.tamp.task import load

OUT = Path(__file__).with_suffix(".md")
PROBLEMS = Path(__file__).parents[1] / "ictamp_drake" / "scenes" / "problems"
KINDS = ("box under a board", "object or receptacle out of reach", "tower too high or shelf too low")
OUT_OF_REACH = str(Failure.NO_INVERSE_KINEMATICS)


@dataclass(frozen=True)
class Options:
    """Refuse impossible problems.

    Attributes:
        seed: Seed of the scenes.
        count: Number of scenes of each kind.
        levels: Whether to sweep the problems of the levels, too.
    """

    seed: int = 0
    count: int = 20
    levels: bool = True


class Case(NamedTuple):
    """A scene, the action that is impossible in it, and its cause: a support, or `OUT_OF_REACH`."""

    spec: SceneSpec
    action: str
    cause: str


def make(kind: str, number: int, seed: int, *, possible: bool) -> Case:
    """Return a scene of a kind, or its twin, which is possible."""
    rng = np.random.default_rng([seed, KINDS.index(kind), number])
    odd = number % 2 == 1
    if kind == KINDS[0]:
        return _under_a_board(rng, possible=possible)
    if kind == KINDS[1]:
        return _receptacle_far(rng, number % 4 == 1, possible) if odd else _object_far(rng, possible)
    return _shelf(rng, possible) if odd else _tower(rng, possible)


def _box(rng: np.random.Generator, x: float, y: float, height: float | None = None, base: float = 0.0) -> BoxSpec:
    """A box that stands at x, y on a base [m]."""
    size = *rng.uniform(0.035, 0.065, 2).round(4).tolist(), round(height or float(rng.uniform(0.05, 0.12)), 4)
    turn = round(float(rng.uniform(-90, 90)), 1)
    return BoxSpec(size, (round(x, 4), round(y, 4), base + size[2] / 2), (0.0, 0.0, turn))


def _near(rng: np.random.Generator, side: int) -> tuple[float, float]:
    """A place on the table that is easy to reach, on its left (1) or right (-1) [m]."""
    return float(rng.uniform(0.4, 0.55)), side * float(rng.uniform(0.18, 0.28))


def _table() -> SupportSpec:
    return SupportSpec("table", (0.3, 0.0, 0.0))


def _tray(x: float, y: float, z: float = 0.02) -> SupportSpec:
    return SupportSpec("table", (x, y, z), size=(0.2, 0.16, 0.02))


def _board(x: float, y: float, bottom: float, sides: tuple[float, float]) -> SupportSpec:
    return SupportSpec("table", (x, y, bottom + 0.02), size=(*sides, 0.02))


def _under_a_board(rng: np.random.Generator, *, possible: bool) -> Case:
    x, y = _near(rng, 1)
    box = _box(rng, x, y)
    bottom = box.size[2] + float(rng.uniform(0.02, 0.12))
    shift = rng.uniform(-0.04, 0.04, 2) + ([0.0, 0.42] if possible else [0.0, 0.0])
    board = _board(x + shift[0], y + shift[1], bottom, (0.36, 0.36))
    supports = {"table": _table(), "tray": _tray(*_near(rng, -1)), "board": board}
    return Case(SceneSpec(supports=supports, boxes={"jar": box}, goal="(on jar tray)"), "pick(jar, table)", "board")


def _far(rng: np.random.Generator, possible: bool) -> tuple[float, float]:
    """A place in front of the table, or on its left [m]."""
    if possible:
        return _near(rng, 1)
    radius, angle = rng.uniform(0.95, 1.3), rng.uniform(-0.35, 0.35)
    return float(radius * np.cos(angle)), float(radius * np.sin(angle))


def _object_far(rng: np.random.Generator, possible: bool) -> Case:
    x, y = _far(rng, possible)
    supports = {"table": _table(), "tray": _tray(*_near(rng, -1)), "stand": _tray(x, y, 0.04)}
    boxes = {"cup": _box(rng, x, y, base=0.04), "other": _box(rng, 0.45, 0.0)}
    return Case(SceneSpec(supports=supports, boxes=boxes, goal="(on cup tray)"), "pick(cup, stand)", OUT_OF_REACH)


def _receptacle_far(rng: np.random.Generator, on_box: bool, possible: bool) -> Case:
    x, y = _far(rng, possible)
    supports = {"table": _table(), "stand": _tray(x, y, 0.04)}
    boxes = {"cup": _box(rng, *_near(rng, -1)), "base": _box(rng, x, y, base=0.04)}
    place = "base" if on_box else "stand"
    return Case(
        SceneSpec(supports=supports, boxes=boxes, goal=f"(on cup {place})"), f"place(cup, {place})", OUT_OF_REACH
    )


def _tower(rng: np.random.Generator, possible: bool) -> Case:
    height = float(rng.uniform(0.15, 0.18))
    count = 2 if possible else 7
    names = [f"block_{i}" for i in range(count)]
    places = [(0.35 + 0.12 * (i % 3), 0.1 + 0.14 * (i // 3)) for i in range(count)]
    boxes = {name: _box(rng, x, y, height) for name, (x, y) in zip(names, places, strict=True)}
    goal = "".join(f" (on {box} {below})" for box, below in zip(names, ["tray", *names], strict=False))
    supports = {"table": _table(), "tray": _tray(0.45, -0.25)}
    action = f"place({names[-1]}, {names[-2]})"
    return Case(SceneSpec(supports=supports, boxes=boxes, goal=f"(and{goal})"), action, OUT_OF_REACH)


def _shelf(rng: np.random.Generator, possible: bool) -> Case:
    x, y = _near(rng, -1)
    box = _box(rng, *_near(rng, 1))
    shift = rng.uniform(-0.02, 0.02, 2) + ([0.0, -0.42] if possible else [0.0, 0.0])
    board = _board(x + shift[0], y + shift[1], 0.02 + box.size[2] + float(rng.uniform(0.02, 0.12)), (0.44, 0.4))
    supports = {"table": _table(), "tray": _tray(x, y), "board": board}
    return Case(SceneSpec(supports=supports, boxes={"jar": box}, goal="(on jar tray)"), "place(jar, tray)", "board")


def refuse(spec: SceneSpec) -> tuple[Explanation, float]:
    """Return what is said without a search, and the processor time of loading and sweeping [s]."""
    started = time.process_time()
    said = solve(load(spec), SCENE_METHOD, max_steps=0).explain()
    return said, time.process_time() - started


def is_right(case: Case, said: Explanation) -> bool:
    """Whether the action is named with its cause, and beside it only actions of the same kind."""
    if said.stop_reason != "IMPOSSIBLE":
        return False
    named = {each.action: each for each in said.blocked}
    found = named.get(case.action)
    if found is None or any(name.partition("(")[0] != case.action.partition("(")[0] for name in named):
        return False
    cause = max(found.obstacles, key=lambda name: found.obstacles[name], default=OUT_OF_REACH)
    return cause == case.cause


def rows(options: Options) -> Iterator[list[object]]:
    """Yield a row of the table for each kind."""
    for kind in KINDS:
        right, wrong, refused, seconds, twins = 0, 0, [], [], []
        for number in range(options.count):
            case = make(kind, number, options.seed, possible=False)
            said, took = refuse(case.spec)
            if said.stop_reason == "IMPOSSIBLE":
                refused.append(took)
            right += is_right(case, said)
            if not is_right(case, said):
                print(f"{kind} {number}: expected {case.action}, {case.cause}; {said}", flush=True)
            said, took = refuse(make(kind, number, options.seed, possible=True).spec)
            wrong += said.stop_reason == "IMPOSSIBLE"
            twins.append(took)
            if said.stop_reason == "IMPOSSIBLE":
                print(f"twin of {kind} {number}: {said}", flush=True)
        seconds = refused or [float("nan")]
        yield [
            kind,
            f"{right} of {options.count}",
            f"{np.median(seconds):.2f}",
            f"{max(seconds):.2f}",
            f"{wrong} of {options.count}",
            f"{max(twins):.2f}",
        ]


def level_lines() -> Iterator[str]:
    """Yield sentences on the problems of the levels."""
    refused, seconds = 0, []
    paths = sorted(PROBLEMS.glob("*/*.yaml"))
    for path in paths:
        task = load(load_scene(path), SCENE_METHOD)
        solution = solve(task, SCENE_METHOD, max_steps=0)
        refused += solution.result.stop_reason.name == "IMPOSSIBLE"
        seconds.append(solution.setup_time_s - task.setup_cpu_time_s)
    yield f"Of the {len(paths)} problems of the levels, {refused} are refused. Getting ready, sweep included, takes"
    yield f"{np.median(seconds):.2f} s of processor time (median; at most {max(seconds):.2f} s)."


def main() -> None:
    """Write the table."""
    options = tyro.cli(Options, description=__doc__)
    heads = ["kind", "refused rightly", "median s", "max s", "twins refused", "twins, max s"]
    text = [
        "# What cannot be is said soon",
        "",
        f"{options.count} scenes of each kind, with seed {options.seed}, by `python -m benchmarks.infeasible`.",
        "Seconds are processor time of loading and sweeping. Refused rightly: the impossible action is named, with the",
        "support in the way or as out of reach. Twins: the same scenes with the culprit out of the way.",
        "",
        *markdown.table(heads, rows(options)),
        "",
        *(level_lines() if options.levels else ()),
    ]
    write_whole(OUT, "\n".join([*text, ""]))
    print("\n".join(text))


if __name__ == "__main__":
    try:
        main()
    except IctampError as error:
        sys.exit(str(error))
