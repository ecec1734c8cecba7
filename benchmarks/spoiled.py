"""Spoiled scene files for `fuzz_scenes.py`: each is a function of its class, a seed and its number.

Most are refused. Some are valid, by chance or on purpose, and a few of these are as large as a scene may be.
"""

import json
from collections.abc import Callable, Iterator
from copy import deepcopy
from typing import Any

import numpy as np
import yaml

from ictamp_drake.scenes.levels import LEVELS, problem_files

Rng = np.random.Generator

BASE = """\
arm: {position: [0, 0, 0], yaw: 0}
supports:
  table: {kind: table, size: [1.2, 0.9, 0.05], position: [0.3, 0, 0], yaw: 0}
  rack: {kind: rack, size: [0.44, 0.22, 0.16], position: [0.44, -0.33, 0.16], yaw: 90}
boxes:
  red_box: {size: [0.05, 0.05, 0.118], mass: 0.1, friction: 0.6, color: [0.8, 0.1, 0.1], position: [0.5, 0.1, 0.059],
            rotation: [0, 0, 30]}
  blue_box: {size: [0.06, 0.06, 0.06], mass: 0.1, friction: 0.6, color: [0.1, 0.1, 0.8], position: [0.4, 0.25, 0.03]}
goal: (on red_box rack)
start: {joints: [0, -0.3, 0, -2.2, 0, 2.0, 0.78], held: ""}
seed: 0
interference: [stacked]
description: two boxes
"""
"""A valid scene with every field of the format."""

NUMBERS = ["0", "-1", "1e308", "-1e308", ".inf", "-.inf", ".nan", "1e-320", "-0.0", "0x1F", "0o17", "0777", "1_000"]
NUMBERS += ["1:30", "1:59:59.5", "1e-3", "1.0e-38", "9" * 310, "9" * 5000, "0x" + "f" * 3600, "1" + ":59" * 300]
NUMBERS += [
    "1" + ":59" * 300 + ".5",
    "'1'",
    "0.1e",
    "--1",
    "1e5000",
    "1/2",
    "9223372036854775807",
    "9223372036854775808",
]
WORDS = ["null", "~", "true", "no", "''", "x", "'\\x07'", '"\\u0000"', '"\\U0001F916"', "2020-01-01", "2020-99-99", "@"]
WORDS += ["'" + "x" * 3000 + "'", "!!int abc", "!!float abc", "!!bool abc", "!!binary '!'", "!!set {a, b}", "!!str 1"]
WORDS += ["!!python/object/apply:os.getcwd []", "!!omap [a: 1]", "!!timestamp x", "&a [*a]", "*missing", "<<", "=", "|"]
NESTED = ["[]", "{}", "[[]]", "[1]", "[1, 2]", "[1, 2, 3]", "[a, b, c]", "{a: 1}", "[1, [2], 3]", "[.nan, 0, 0]"]
NESTED += ["[1, 2, 3, 4]", "[null, null, null]", "[1e400, 0, 0]", "[true, false, true]", "[" * 70 + "]" * 70]
NESTED += ["[" * 600 + "]" * 600, "{a: " * 400 + "1" + "}" * 400, "[" + "1, " * 5000 + "1]", "{1: 2}", "{[1]: 2}"]
WRONG = [*NUMBERS, *WORDS, *NESTED]
NAMES = ["on", "and", "not", "object", "panda", "world", "WorldModelInstance", "x" * 99, "x" * 101, "x" * 20_000, "a b"]
NAMES += [
    "",
    "1",
    "-a",
    "a.b",
    "a/b",
    "../a",
    "Ω",
    "a\u202eb",
    "<b>",
    "a'b",
    'a"b',
    "$x$",
    "%s",
    "{value}",
    "\t",
    "a\nb",
]
NAMES += ["TABLE", "Rack", "rack", "table", "null", "true", "~", "__a", "a__b", "a_", "A", "define", "forall", "either"]
TOKENS = ["(", ")", "and", "or", "not", "on", "lying", "red_box", "blue_box", "table", "rack", "panda", ";", "?x", "-"]
TOKENS += [
    "forall",
    "clear",
    "hand-empty",
    "in-hand",
    "'",
    '"',
    "\n",
    "=",
    "0",
    "on on",
    "()",
    "((",
    "))",
    "RED_BOX",
    "Ω",
]
PARTS = [
    "(on red_box rack)",
    "(on blue_box rack)",
    "(on red_box blue_box)",
    "(on blue_box red_box)",
    "(on red_box table)",
]
PARTS += ["(lying red_box rack)", "(on red_box red_box)", "(on rack table)", "(on red_box nothing)"]


def field(rng: Rng) -> str:
    """Return the valid scene with a wrong or odd value in one field, or in one part of a field."""
    scene = yaml.safe_load(BASE)
    *path, last = _pick(rng, list(_paths(scene)))
    _at(scene, path)[last] = "PLACE"
    value = _pick(rng, WRONG) if rng.random() < 0.8 else repr(float(rng.normal() * 10 ** rng.uniform(-40, 40)))
    return json.dumps(scene).replace('"PLACE"', value.replace("\\x07", "\x07"))


def name(rng: Rng) -> str:
    """Return the valid scene with another name of an object or a field."""
    scene = yaml.safe_load(BASE)
    old = _pick(rng, ["red_box", "blue_box", "table", "rack", "mass", "goal", "supports", "position", "kind"])
    chosen = _pick(rng, NAMES) if rng.random() < 0.7 else _text(rng, int(rng.integers(1, 12)))
    text = json.dumps(_renamed(scene, old, chosen), ensure_ascii=bool(rng.random() < 0.5))
    return text.replace(f"{old} ", f"{chosen} ") if rng.random() < 0.5 and chosen.isidentifier() else text


def goal(rng: Rng) -> str:
    """Return the valid scene with another goal."""
    scene = yaml.safe_load(BASE)
    kind = rng.random()
    if kind < 0.4:
        scene["goal"] = " ".join(_pick(rng, TOKENS) for _ in range(rng.integers(0, 12)))
    elif kind < 0.8:
        scene["goal"] = f"(and {' '.join(_pick(rng, PARTS) for _ in range(rng.integers(0, 5)))})"
    else:
        count = int(10 ** rng.uniform(1, 4.5))
        scene["goal"] = _pick(rng, ["(", "(and ", ")", "(on red_box rack) ", "x", "(on ", ";", "\n"]) * count
    return json.dumps(scene)


def geometry(rng: Rng) -> str:
    """Return a scene of a few boxes with random sizes, places, rotations, and sometimes joints and a held box."""
    scene = yaml.safe_load(BASE)
    scene["boxes"] = {f"b{number}": _box(rng) for number in range(rng.integers(1, 7))}
    if rng.random() < 0.3:
        _tower(rng, list(scene["boxes"].values()))
    scene["goal"] = f"({_pick(rng, ['on', 'lying'])} b0 {_pick(rng, ['rack', 'table'])})"
    if rng.random() < 0.3:
        scene["arm"] = {"position": [float(x) for x in rng.uniform(-1, 1, 3)], "yaw": float(rng.uniform(-360, 360))}
    if rng.random() < 0.3:
        scene["supports"]["rack"]["size"] = [float(x) for x in 10 ** rng.uniform(-2, 0.7, 3)]
    if rng.random() < 0.7:
        del scene["start"]
    else:
        scene["start"]["joints"] = [float(x) for x in rng.uniform(-3, 3, 7)]
        scene["start"]["held"] = _pick(rng, ["", "b0"])
    return json.dumps(scene)


def crowd(rng: Rng) -> str:
    """Return a scene of 1 to 60 boxes in a grid, or with more boxes than can be planned for."""
    scene = yaml.safe_load(BASE)
    count = int(rng.integers(1, 61)) if rng.random() < 0.8 else int(rng.integers(61, 3000))
    scene["supports"]["table"] = {"kind": "table", "position": [0.3, 0, 0], "size": [3, 3, 0.05]}
    scene["boxes"] = {
        f"b{number}": {
            "size": [0.05, 0.05, 0.05],
            "position": [round(0.25 + 0.09 * (number % 11), 3), round(0.09 * (number // 11), 3), 0.025],
        }
        for number in range(count)
    }
    scene["goal"] = "(on b0 rack)"
    del scene["start"]
    return json.dumps(scene)


def trick(rng: Rng) -> str | bytes:
    """Return a scene with odd YAML: aliases, tags, merges, encodings, line ends, depth, size."""
    size = int(10 ** rng.uniform(1, 5.3))
    depth = int(rng.integers(2, 12))
    aliases = "\n".join(f" - &a{n + 1} [{', '.join([f'*a{n}'] * 10)}]" for n in range(depth))
    bombs = {
        "aliases": BASE.replace("[stacked]", f"\n - &a0 [x, x]\n{aliases}"),
        "deep lists": BASE.replace("two boxes", "[" * size),
        "deep mappings": BASE.replace("two boxes", "{a: " * min(size, 5000)),
        "dashes": BASE.replace("two boxes", "\n" + "- " * min(size, 20_000) + "x"),
        "a long text": BASE.replace("two boxes", "x " * size),
        "a long line of brackets": BASE.replace("two boxes", "[]," * size),
        "many fields": BASE + "".join(f"f{n}: {n}\n" for n in range(min(size, 20_000))),
        "a list of numbers": BASE.replace("[stacked]", f"[{'0, ' * size}]"),
        "sexagesimal": BASE.replace("seed: 0", f"seed: 1{':59' * size}"),
        "hexadecimal": BASE.replace("seed: 0", f"seed: 0x{'f' * size}"),
        "binary": BASE.replace("seed: 0", f"seed: 0b{'1' * size}"),
        "digits": BASE.replace("seed: 0", f"seed: {'9' * size}"),
        "octal": BASE.replace("seed: 0", f"seed: 0{'7' * size}"),
        "an anchor": BASE.replace("two boxes", f"&{'a' * size} x"),
        "a tag": BASE.replace("two boxes", f"!{'a' * size} x"),
        "a key": BASE + f"? {'k' * size}\n: 1\n",
        "merges": BASE + "all: &all {<<: *all}\n" if rng.random() < 0.5 else BASE + "<<: [{seed: 1}, {seed: 2}]\n",
        "a merge": BASE.replace("mass: 0.1", "<<: {mass: 0.2, friction: 0.5}", 1),
        "documents": f"{BASE}---\n{BASE}" if rng.random() < 0.5 else f"---\n{BASE}...\n",
        "a directive": f"%YAML {rng.integers(0, 4)}.{rng.integers(0, 4)}\n---\n{BASE}",
        "tabs": BASE.replace("  ", "\t"),
        "percent": BASE + "%",
        "windows": BASE.replace("\n", "\r\n"),
        "old macs": BASE.replace("\n", "\r"),
        "a python tag": BASE.replace("seed: 0", "seed: !!python/object/apply:os.system ['true']"),
        "a template": BASE.replace("red_box", "{{ name }}"),
        "nothing": _pick(rng, ["", "\n", "#", "---", "~", "3", "text", "[]", "{}", "? ", "- ", ": ", "&a", "*a", "!"]),
        "a pointer": "version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 3\n",
        "accounts": "root:x:0:0:root:/root:/bin/bash\n" * min(size, 2000),
    }
    text = _pick(rng, list(bombs.values()))
    encodings = ["utf-8"] * 12 + ["utf-8-sig", "utf-16", "utf-32", "utf-16-le"]
    return text.encode(_pick(rng, encodings))


def mutated(rng: Rng) -> str:
    """Return a committed scene with one to three changes of its values."""
    scene = yaml.safe_load(_committed(rng))
    for _ in range(rng.integers(1, 4)):
        *path, last = _pick(rng, list(_paths(scene)))
        parent = _at(scene, path)
        value = parent[last]
        kind = rng.integers(6)
        if kind == 0 or (isinstance(value, int | float) and kind < 4):
            scale = _pick(rng, [-1, 0, 0.5, 0.9, 1.1, 2, 10, 1e3, 1e9])
            parent[last] = (
                value * scale if isinstance(value, int | float) else _pick(rng, [None, [], {}, "x", 1, 0.1, True])
            )
        elif kind == 1:
            del parent[last]
        elif kind in (2, 3):
            *other, end = _pick(rng, list(_paths(scene)))
            parent[last] = deepcopy(_at(scene, other)[end])
        elif kind == 4 and isinstance(parent, list):
            parent.append(deepcopy(value))
        elif isinstance(parent, dict):
            parent[_pick(rng, NAMES)] = deepcopy(value)
    return yaml.safe_dump(scene, allow_unicode=True)


def garbled(rng: Rng) -> bytes:
    """Return a committed scene with bytes changed, cut, repeated or inserted."""
    data = bytearray(_committed(rng).encode())
    for _ in range(rng.integers(1, 6)):
        start = int(rng.integers(len(data) or 1))
        end = start + int(10 ** rng.uniform(0, 2))
        kind = rng.integers(4)
        if kind == 0:
            data[start : start + 1] = rng.bytes(1)
        elif kind == 1:
            del data[start:end]
        elif kind == 2:
            data[start:start] = data[start:end]
        else:
            data[start:start] = rng.bytes(int(rng.integers(1, 9)))
    return bytes(data)


CLASSES: dict[Callable[[Rng], str | bytes], int] = {
    field: 40,
    name: 10,
    goal: 10,
    geometry: 10,
    crowd: 2,
    trick: 10,
    mutated: 12,
    garbled: 6,
}
"""The classes of files, and how many of 100 files are in each."""


def spoiled(seed: int, number: int) -> tuple[str, bytes]:
    """Return the class and the content of a file."""
    order = [kind for kind, share in CLASSES.items() for _ in range(share)]
    kind = order[np.random.default_rng([seed, number // 100]).permutation(100)[number % 100]]
    content = kind(np.random.default_rng([seed, number, 1]))
    return kind.__name__, content if isinstance(content, bytes) else content.encode("utf-8", "surrogatepass")


def _committed(rng: Rng) -> str:
    return _pick(rng, problem_files(_pick(rng, LEVELS), ":")).read_text(encoding="utf-8")


def _pick(rng: Rng, choices: Any) -> Any:
    return choices[rng.integers(len(choices))]


def _paths(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Yield the paths of all values in a tree."""
    keys = value if isinstance(value, dict) else range(len(value)) if isinstance(value, list) else ()
    for key in keys:
        yield (*path, key)
        yield from _paths(value[key], (*path, key))


def _at(value: Any, path: list[Any]) -> Any:
    for key in path:
        value = value[key]
    return value


def _renamed(value: Any, old: str, new: str) -> Any:
    if isinstance(value, dict):
        return {new if key == old else key: _renamed(item, old, new) for key, item in value.items()}
    return value


def _text(rng: Rng, length: int) -> str:
    return "".join(chr(int(rng.choice([rng.integers(32, 127), rng.integers(1, 0x3000)]))) for _ in range(length))


def _box(rng: Rng) -> dict[str, Any]:
    size = [float(x) for x in 10 ** rng.uniform(-2.2, -0.6, 3)]
    turns = [[0, 0, 0], [90, 0, 0], [0, 90, 45], [0, 0, float(rng.uniform(-360, 360))], [180, 0, 0]]
    rotation = _pick(rng, turns) if rng.random() < 0.9 else [float(x) for x in rng.uniform(-360, 360, 3)]
    height = size[{90: 1}.get(rotation[0], 0 if rotation[1] == 90 else 2)] / 2
    z = height if rng.random() < 0.8 else float(rng.uniform(-0.2, 0.5))
    place = [*(float(x) for x in rng.uniform([0.2, -0.05], [0.75, 0.4])), z]
    return {"size": size, "position": place, "rotation": rotation, "mass": float(10 ** rng.uniform(-3, 0.5))}


def _tower(rng: Rng, boxes: list[dict[str, Any]]) -> None:
    """Stack the boxes on the table, each shifted a little."""
    top = 0.0
    for box in boxes:
        box["rotation"] = [0, 0, 0]
        shift = rng.normal(scale=0.01, size=2)
        box["position"] = [0.5 + float(shift[0]), 0.1 + float(shift[1]), top + box["size"][2] / 2]
        top += box["size"][2]
