"""Good plan files that are spoiled at random: values, entries, bytes.

`python -m tests.tamp.spoiling PLAN.yaml COUNT [SEED]` spoils a plan so many times, reads and replays what is left, and
prints what came of it.
"""

import resource
import sys
import tempfile
from collections import Counter
from collections.abc import Callable
from copy import deepcopy
from pathlib import Path
from random import Random
from time import perf_counter
from typing import Any

import yaml

from ictamp_drake.core.errors import IctampError
from ictamp_drake.tamp.plan import Plan

VALUES: list[Any] = [
    None, True, 0, -1, 7, 1e300, -1e-300, float("nan"), float("inf"), 10**400, "", "x", "1e-3", "red_box", "ü" * 300,
    [], [None], [[[]]], [0.0] * 7, {}, {"x": 1}, {1: 2},
]  # fmt: skip


def spoil(text: str, random: Random) -> str:
    """The text of a plan file, changed in one to three ways."""
    if random.random() < 0.15:
        return _spoil_text(text, random)
    content = yaml.load(text, Loader=getattr(yaml, "CSafeLoader", yaml.SafeLoader))
    for _ in range(random.choice((1, 1, 1, 2, 3))):
        parent, key = _pick(content, random)
        random.choice(CHANGES)(parent, key, random)
    return yaml.dump(content, Dumper=getattr(yaml, "CSafeDumper", yaml.SafeDumper), sort_keys=False)


def _pick(content: Any, random: Random) -> tuple[Any, Any]:
    """A place in the content: the parent and its key. Long lists of numbers are not likelier than single fields."""
    while True:
        here, depth = content, random.randint(1, 7)
        found = None
        while isinstance(here, dict | list) and here and depth:
            key = random.choice(list(here)) if isinstance(here, dict) else random.randrange(len(here))
            found, here, depth = (here, key), here[key], depth - 1
        if found is not None:
            return found


def _replace(parent: Any, key: Any, random: Random) -> None:
    parent[key] = deepcopy(random.choice(VALUES))


def _remove(parent: Any, key: Any, _: Random) -> None:
    del parent[key]


def _repeat(parent: Any, key: Any, random: Random) -> None:
    if isinstance(parent, list):
        parent.insert(key, deepcopy(parent[key]))
    else:
        parent[random.choice(("x", f"{key}_2", 3))] = deepcopy(parent[key])


def _shift(parent: Any, key: Any, random: Random) -> None:
    """Change a number a little or much."""
    if type(parent[key]) in (int, float) and abs(parent[key]) < 1e9:
        parent[key] = random.choice(
            [parent[key] + random.gauss(0, 10 ** random.uniform(-5, 2)), -parent[key], 1000 * parent[key]]
        )
    else:
        _replace(parent, key, random)


def _exchange(parent: Any, key: Any, random: Random) -> None:
    other = random.choice(list(parent)) if isinstance(parent, dict) else random.randrange(len(parent))
    parent[key], parent[other] = parent[other], parent[key]


def _reverse(parent: Any, key: Any, random: Random) -> None:
    if isinstance(parent[key], list):
        parent[key].reverse()
    else:
        _shift(parent, key, random)


CHANGES: list[Callable[[Any, Any, Random], None]] = [_replace, _replace, _remove, _repeat, _shift, _shift, _exchange]
CHANGES.append(_reverse)


def _spoil_text(text: str, random: Random) -> str:
    start, end = sorted(random.randrange(len(text)) for _ in range(2))
    end = min(end, start + random.choice((1, 5, 100, 10**6)))
    middle = random.choice(["", text[end : end + 50], "{", "[" * 2000, "\t", "\0", "&a [*a]", "9" * 500, ": ", "\n- "])
    return text[:start] + middle + text[end:]


def judge(path: Path) -> str:
    """Read and replay a plan, and return what came of it.

    Raises:
        Exception: Anything other than a sentence for the user.
    """
    try:
        plan = Plan.load(path)
    except IctampError as error:
        return _check_sentence(error)
    replay = plan.replay()
    assert len(replay.outcomes) <= len(plan)
    return "reached" if replay.reached else "not reached"


def _check_sentence(error: IctampError) -> str:
    assert "\n" not in str(error)
    assert len(str(error)) < 700, str(error)
    return str(error.code)


def main(source: str, count: int, seed: int = 0) -> None:
    """Spoil a plan `count` times, and print what came of it."""
    text = Path(source).read_text(encoding="utf-8")
    found: Counter[str] = Counter()
    longest, grown = 0.0, [0, 0]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "plan.yaml"
        for number in range(count):
            path.write_text(spoil(text, Random(seed + number)), encoding="utf-8")
            started = perf_counter()
            try:
                found[judge(path)] += 1
            except BaseException as error:
                if isinstance(error, KeyboardInterrupt):
                    raise
                found[f"{type(error).__name__} with seed {seed + number}: {error}"[:200]] += 1
            longest = max(longest, perf_counter() - started)
            grown[number > count // 10] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    growth = (grown[1] - grown[0]) / 1024 / (0.9 * count)
    print(*(f"{times:5} {what}" for what, times in found.most_common()), sep="\n")
    print(f"longest {longest:.1f} s, growth {growth:.3f} MiB a file")


if __name__ == "__main__":
    main(sys.argv[1], *map(int, sys.argv[2:]))
