"""Every mistake in a scene file is refused with its code, the file, the line, the field and the value."""

import pickle
from pathlib import Path

import pytest

from ictamp_drake.core import reading
from ictamp_drake.core.decoding import mapping
from ictamp_drake.core.errors import Code, IctampError, Where
from ictamp_drake.core.reading import parse, parse_json, read_text
from ictamp_drake.scenes.spec import SUPPORT_SIZES, load_scene
from tests.refusals import refusal

GOOD = """\
arm: {position: [0, 0, 0], yaw: 0}
supports:
  table: {kind: table, size: [1.2, 0.9, 0.05], position: [0.3, 0, 0], yaw: 0}
  rack: {kind: rack, position: [0.44, -0.33, 0.16], yaw: 90}
boxes:
  red_box: {size: [0.05, 0.05, 0.118], mass: 0.1, friction: 0.6, colour: [0.8, 0.1, 0.1], position: [0.5, 0.1, 0.059]}
goal: (on red_box rack)
seed: 0
interference: [stacked, tipped]
"""
BOX = GOOD.splitlines()[5]
PLACE = "position: [0.5, 0.1, 0.059]"
SIZE = "size: [0.05, 0.05, 0.118]"

MISTAKES = {
    "unknown field in the file": ("seed: 0", "sede: 0", Code.UNKNOWN_FIELD, "sede", 8),
    "unknown field in the arm": ("yaw: 0}\nsupports", "yaw: 0, z: 1}\nsupports", Code.UNKNOWN_FIELD, "arm.z", 1),
    "unknown field in a support": ("kind: rack", "knid: rack", Code.UNKNOWN_FIELD, "supports.rack.knid", 4),
    "unknown field in a box": ("mass", "mas", Code.UNKNOWN_FIELD, "boxes.red_box.mas", 6),
    "missing field": ("kind: rack, ", "", Code.MISSING_FIELD, "supports.rack.kind", 4),
    "missing goal": ("goal: (on red_box rack)\n", "", Code.MISSING_FIELD, "goal", None),
    "text for a number": ("mass: 0.1", "mass: heavy", Code.WRONG_TYPE, "boxes.red_box.mass", 6),
    "nothing for a number": ("mass: 0.1", "mass:", Code.WRONG_TYPE, "boxes.red_box.mass", 6),
    "truth for a number": ("mass: 0.1", "mass: true", Code.WRONG_TYPE, "boxes.red_box.mass", 6),
    "list for a number": ("mass: 0.1", "mass: [1]", Code.WRONG_TYPE, "boxes.red_box.mass", 6),
    "number for a list": (PLACE, "position: 5", Code.WRONG_TYPE, "boxes.red_box.position", 6),
    "text for a list": (PLACE, "position: '123'", Code.WRONG_TYPE, "boxes.red_box.position", 6),
    "text in a list": (PLACE, "position: [a, 0, 0]", Code.WRONG_TYPE, "boxes.red_box.position", 6),
    "too few numbers": (PLACE, "position: [0, 0]", Code.WRONG_LENGTH, "boxes.red_box.position", 6),
    "part of a seed": ("seed: 0", "seed: 0.5", Code.WRONG_TYPE, "seed", 8),
    "negative seed": ("seed: 0", "seed: -1", Code.OUT_OF_RANGE, "seed", 8),
    "number for a goal": ("(on red_box rack)", "5", Code.WRONG_TYPE, "goal", 7),
    "empty goal": ("(on red_box rack)", "''", Code.EMPTY, "goal", 7),
    "list for a mapping": (BOX, "  [red_box]", Code.WRONG_TYPE, "boxes", 5),
    "number for a box": (BOX, "  red_box: 1", Code.WRONG_TYPE, "boxes.red_box", 6),
    "wrong kind": ("kind: rack", "kind: shelf", Code.UNKNOWN_CHOICE, "supports.rack.kind", 4),
    "wrong interference": ("tipped", "upside", Code.UNKNOWN_CHOICE, "interference", 9),
    "zero size": (SIZE, "size: [0.05, 0, 0.118]", Code.OUT_OF_RANGE, "boxes.red_box.size", 6),
    "huge size": (SIZE, "size: [0.05, 0.05, 118]", Code.OUT_OF_RANGE, "boxes.red_box.size", 6),
    "flat table": ("[1.2, 0.9, 0.05]", "[1.2, 0.9, 0]", Code.OUT_OF_RANGE, "supports.table.size", 3),
    "flat rack": (
        "position: [0.44, -0.33, 0.16]",
        "position: [0.44, -0.33, 0.02], size: [0.2, 0.2, 0.02]",
        Code.OUT_OF_RANGE,
        "supports.rack.size",
        4,
    ),
    "negative mass": ("mass: 0.1", "mass: -0.1", Code.OUT_OF_RANGE, "boxes.red_box.mass", 6),
    "huge mass": ("mass: 0.1", "mass: 100", Code.OUT_OF_RANGE, "boxes.red_box.mass", 6),
    "no friction": ("friction: 0.6", "friction: 0", Code.OUT_OF_RANGE, "boxes.red_box.friction", 6),
    "not a number": ("friction: 0.6", "friction: .nan", Code.OUT_OF_RANGE, "boxes.red_box.friction", 6),
    "endless": (PLACE, "position: [.inf, 0, 0]", Code.OUT_OF_RANGE, "boxes.red_box.position", 6),
    "color of 255": ("[0.8, 0.1, 0.1]", "[255, 0, 0]", Code.OUT_OF_RANGE, "boxes.red_box.color", 6),
    "too wide": (SIZE, "size: [0.09, 0.08, 0.05]", Code.TOO_WIDE, "boxes.red_box.size", 6),
    "one name twice": ("  red_box:", "  rack:", Code.REPEATED, "boxes.rack", 6),
    "names that differ in case": ("  red_box:", "  Rack:", Code.REPEATED, "boxes.Rack", 6),
    "a key twice": (BOX, f"{BOX}\n{BOX}", Code.REPEATED, "", 7),
    "a field twice": ("mass: 0.1", "mass: 0.1, mass: 0.2", Code.REPEATED, "", 6),
    "no boxes": (BOX, "  {}", Code.EMPTY, "boxes", 5),
    "name with a space": ("  red_box:", "  red box:", Code.BAD_NAME, "boxes.red box", 6),
    "name of digits": ("  red_box:", "  12:", Code.BAD_NAME, "boxes", 5),
    "name on": ("  red_box:", "  on:", Code.BAD_NAME, "boxes", 5),
    "word of PDDL": ("  red_box:", "  and:", Code.BAD_NAME, "boxes.and", 6),
    "name of the robot": ("  red_box:", "  robot:", Code.BAD_NAME, "boxes.robot", 6),
    "unknown held box": ("seed: 0", "start: {held: blue_box}", Code.UNKNOWN_CHOICE, "start.held", 8),
    "syntax": ("seed: 0", "seed: [0", Code.NOT_YAML, "", 9),
    "bad character": ("seed: 0", "seed: \x07", Code.NOT_YAML, "", None),
    "unrendered template": ("  red_box:", "  {{name}}:", Code.NOT_YAML, "", 6),
    "list for a name": ("  red_box:", "  [1, 2]:", Code.NOT_YAML, "", 6),
    "impossible date": ("seed: 0", "seed: 2020-99-99", Code.NOT_YAML, "", 8),
    "text tagged as a number": ("seed: 0", "seed: !!int abc", Code.NOT_YAML, "", 8),
    "text tagged as a float": ("mass: 0.1", "mass: !!float abc", Code.NOT_YAML, "", 6),
    "text tagged as a truth": ("seed: 0", "seed: !!bool abc", Code.NOT_YAML, "", 8),
    "text tagged as a date": ("seed: 0", "seed: !!timestamp abc", Code.NOT_YAML, "", 8),
    "unknown tag": ("seed: 0", "seed: !odd 0", Code.NOT_YAML, "", 8),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_mistake_is_refused_with_its_place(mistake: str, tmp_path: Path) -> None:
    good, bad, code, field, line = MISTAKES[mistake]
    assert GOOD.count(good) >= 1
    path = tmp_path / "scene.yaml"
    path.write_text(GOOD.replace(good, bad, 1))
    with refusal(code, field, file=path, line=line):
        load_scene(path)


@pytest.mark.parametrize(
    ("good", "bad", "value", "choices"),
    [
        ("kind: rack", "kind: shelf", "shelf", tuple(SUPPORT_SIZES)),
        ("tipped", "upside", "upside", ("stacked", "behind", "tipped")),
        ("mass: 0.1", "mass: heavy", "heavy", ()),
        ("mass: 0.1", "mass: 100", 100.0, ()),
        ("yaw: 0}\nsupports", "yaw: 0, z: 1}\nsupports", None, ("position", "yaw")),
    ],
)
def test_an_error_has_the_value_and_the_choices(
    good: str, bad: str, value: object, choices: tuple[str, ...], tmp_path: Path
) -> None:
    path = tmp_path / "scene.yaml"
    path.write_text(GOOD.replace(good, bad, 1))
    with pytest.raises(IctampError) as caught:
        load_scene(path)
    assert (caught.value.value, caught.value.choices) == (value, choices)


def test_the_file_without_mistakes_is_read(tmp_path: Path) -> None:
    path = tmp_path / "scene.yaml"
    path.write_text(GOOD)
    assert load_scene(path).interference == ("stacked", "tipped")


def test_what_was_merged_can_be_merged_again() -> None:
    first, second = "first: &first {mass: 1, yaw: 1}", "second: &second {<<: *first, mass: 2}"
    text = f"shared: {{{first}, {second}}}\nred_box: {{<<: *second, mass: 3}}"
    assert mapping(parse(text))["red_box"] == {"mass": 3, "yaw": 1}


def test_numbers_in_scientific_notation_are_numbers(tmp_path: Path) -> None:
    path = tmp_path / "scene.yaml"
    path.write_text(GOOD.replace("mass: 0.1", "mass: 1e-1"))
    assert load_scene(path).boxes["red_box"].mass == 0.1


@pytest.mark.parametrize(("content", "code"), [(b"", Code.WRONG_TYPE), (b"\xff\xfe\x00", Code.NOT_TEXT)])
def test_a_file_that_is_no_scene(content: bytes, code: Code, tmp_path: Path) -> None:
    path = tmp_path / "scene.yaml"
    path.write_bytes(content)
    with refusal(code, file=path):
        load_scene(path)


def test_a_missing_file_and_a_folder(tmp_path: Path) -> None:
    for path in (tmp_path / "none.yaml", tmp_path):
        with refusal(Code.NOT_READABLE, file=path):
            load_scene(path)


# limits


def test_a_large_file_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "scene.yaml"
    path.write_text(GOOD)
    monkeypatch.setattr(reading, "MAX_BYTES", len(GOOD))
    assert read_text(path) == GOOD
    monkeypatch.setattr(reading, "MAX_BYTES", len(GOOD) - 1)
    with refusal(Code.TOO_LARGE, file=path):
        read_text(path)


def test_many_values_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reading, "MAX_NODES", 1000)
    assert len(parse(f"[{'0,' * 900}]")) == 900  # type: ignore[arg-type]
    with refusal(Code.TOO_LARGE, line=1):
        parse(f"[{'0,' * 1000}]")


DEEP = {
    "brackets": "[" * 30_000,
    "dashes": "- " * 30_000 + "x",
    "mappings": "\n".join(f"{' ' * level}a:" for level in range(100)),
    "aliases": "\n".join(["a0: &a0 [x]", *(f"a{level + 1}: &a{level + 1} [*a{level}]" for level in range(100))]),
    "an alias to what it is in": "a: &a [*a]",
}


@pytest.mark.parametrize("text", DEEP.values(), ids=DEEP)
def test_deep_nesting_is_refused(text: str) -> None:
    with refusal(Code.TOO_DEEP):
        parse(text)


def test_aliases_of_aliases_are_counted_as_what_they_stand_for() -> None:
    levels = [f"a{level + 1}: &a{level + 1} [{', '.join([f'*a{level}'] * 10)}]" for level in range(9)]
    with refusal(Code.TOO_LARGE):
        parse("\n".join(["a0: &a0 [x, x, x]", *levels]))
    assert parse("\n".join(["a0: &a0 [x, x, x]", *levels[:3]]))


def test_deep_json_is_refused() -> None:
    with refusal(Code.TOO_DEEP):
        parse_json("[" * 100_000)


@pytest.mark.parametrize(
    "value", ["x" * 100_000, ["x"] * 100_000, {str(n): n for n in range(10_000)}, [[["x"] * 99] * 99] * 99]
)
def test_a_sentence_is_short_whatever_the_value(value: object) -> None:
    assert len(str(IctampError(Code.WRONG_TYPE, "expected a number, got {value}", value=value))) < 1000


# errors


def test_an_error_gathers_its_place_on_the_way_up() -> None:
    error = IctampError(Code.OUT_OF_RANGE, "expected less", field="size")
    error.add_field("boxes.red_box")
    error.add_file("scene.yaml", 7)
    error.add_file("other.yaml", 8)
    assert error.where == Where("scene.yaml", 7, "boxes.red_box.size")


def test_an_error_survives_the_way_from_another_process() -> None:
    error = IctampError(Code.UNKNOWN_CHOICE, "{value} is not valid", field="a", value=3, choices="xy", advice="give x")
    error.add_file("scene.yaml", 2)
    copy = pickle.loads(pickle.dumps(error))
    assert vars(copy) == vars(error)
    assert str(copy) == str(error)


def test_a_path_with_nul_is_refused() -> None:
    with refusal(Code.NOT_READABLE):
        load_scene("a\0b.yaml")
