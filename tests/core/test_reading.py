"""Every mistake in a scene file gives one sentence that names file, field, value and the valid choices."""

from pathlib import Path

import pytest

from ictamp_drake.core.errors import IctampError
from ictamp_drake.core.reading import mapping, parse
from ictamp_drake.scenes.spec import load_scene

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

MISTAKES = {
    "unknown field in the file": ("seed: 0", "sede: 0", "unknown field 'sede'; valid are: arm, supports, boxes, goal"),
    "unknown field in the arm": (
        "yaw: 0}\nsupports",
        "yaw: 0, z: 1}\nsupports",
        "unknown field 'arm.z'; valid are: pos",
    ),
    "unknown field in a support": ("kind: rack", "knid: rack", "unknown field 'supports.rack.knid'; valid are: kind, "),
    "unknown field in a box": ("mass", "mas", "unknown field 'boxes.red_box.mas'; valid are: size, position, rotation"),
    "missing field": ("kind: rack, ", "", "'supports.rack.kind' is missing; needed are: kind, position"),
    "missing goal": ("goal: (on red_box rack)\n", "", "'goal' is missing; needed are: supports, boxes, goal"),
    "text for a number": ("mass: 0.1", "mass: heavy", "boxes.red_box.mass is 'heavy', but must be a number"),
    "nothing for a number": ("mass: 0.1", "mass:", "boxes.red_box.mass is None, but must be a number"),
    "truth for a number": ("mass: 0.1", "mass: true", "boxes.red_box.mass is True, but must be a number"),
    "list for a number": ("mass: 0.1", "mass: [1]", "boxes.red_box.mass is [1], but must be a number"),
    "number for a list": (PLACE, "position: 5", "boxes.red_box.position is 5, but must be a list of three numbers"),
    "text for a list": (PLACE, "position: '123'", "position is '123', but must be a list of three numbers"),
    "text in a list": (PLACE, "position: [a, 0, 0]", "position is ['a', 0, 0], but must be a list of three numbers"),
    "too few numbers": (PLACE, "position: [0, 0]", "position is [0.0, 0.0], but must be three numbers"),
    "part of a seed": ("seed: 0", "seed: 0.5", "seed is 0.5, but must be a whole number"),
    "negative seed": ("seed: 0", "seed: -1", "seed is -1, but must be between 0 and"),
    "number for a goal": ("(on red_box rack)", "5", "goal is 5, but must be text"),
    "empty goal": ("(on red_box rack)", "''", "goal is empty, but must be a PDDL formula"),
    "list for a mapping": (BOX, "  [red_box]", "boxes is ['red_box'], but must be a mapping"),
    "number for a box": (BOX, "  red_box: 1", "boxes.red_box is 1, but must be a mapping"),
    "wrong kind": ("kind: rack", "kind: shelf", "supports.rack.kind is 'shelf', but must be one of: table, rack"),
    "wrong interference": ("tipped", "upside", "interference is 'upside', but must be one of: stacked, behind, tipped"),
    "zero size": (
        "[0.05, 0.05, 0.118]",
        "[0.05, 0, 0.118]",
        "boxes.red_box.size is [0.05, 0.0, 0.118], but each number",
    ),
    "huge size": ("[0.05, 0.05, 0.118]", "[0.05, 0.05, 118]", "each number must be between 0.008 and 1 m"),
    "flat table": ("[1.2, 0.9, 0.05]", "[1.2, 0.9, 0]", "supports.table.size is [1.2, 0.9, 0.0], but each number"),
    "flat rack": (
        "position: [0.44, -0.33, 0.16]",
        "position: [0.44, -0.33, 0.02], size: [0.2, 0.2, 0.02]",
        "supports.rack.size is [0.2, 0.2, 0.02], but each number must be between 0.03 and 5 m",
    ),
    "negative mass": ("mass: 0.1", "mass: -0.1", "mass is -0.1 kg, but must be between 0.001 and 3 kg"),
    "huge mass": ("mass: 0.1", "mass: 100", "boxes.red_box.mass is 100 kg, but must be between 0.001 and 3 kg"),
    "no friction": ("friction: 0.6", "friction: 0", "friction is 0, but must be between 0.05 and 2"),
    "not a number": ("friction: 0.6", "friction: .nan", "friction is nan, but must be between 0.05 and 2"),
    "endless": (
        PLACE,
        "position: [.inf, 0, 0]",
        "position is [inf, 0.0, 0.0], but each number must be between -10 and",
    ),
    "colour of 255": (
        "[0.8, 0.1, 0.1]",
        "[255, 0, 0]",
        "colour is [255.0, 0.0, 0.0], but each number must be between 0 and 1",
    ),
    "too wide": (
        "[0.05, 0.05, 0.118]",
        "[0.09, 0.08, 0.05]",
        "boxes.red_box.size is [0.09, 0.08, 0.05]: too wide for the",
    ),
    "one name twice": ("  red_box:", "  rack:", "the name 'rack' is used twice"),
    "names that differ in case": ("  red_box:", "  Rack:", "the name 'Rack' is used twice (case does not count)"),
    "a key twice": (BOX, f"{BOX}\n{BOX}", "line 7: 'red_box' is used twice"),
    "a field twice": ("mass: 0.1", "mass: 0.1, mass: 0.2", "line 6: 'mass' is used twice"),
    "no boxes": (BOX, "  {}", "boxes is empty, but must name at least one"),
    "name with a space": ("  red_box:", "  red box:", "the name 'red box' is not valid; use letters, digits, _ and -"),
    "name of digits": ("  red_box:", "  12:", "boxes has the key 12, but names must be text"),
    "name on": (
        "  red_box:",
        "  on:",
        "boxes has the key True, but names must be text; YAML reads on, off, yes and no",
    ),
    "word of PDDL": ("  red_box:", "  and:", "the name 'and' is a word of PDDL; choose another"),
    "name of the robot": ("  red_box:", "  panda:", "the name 'panda' is taken by the world or the robot"),
    "syntax": ("seed: 0", "seed: [0", "line 9: not valid YAML: "),
    "bad character": ("seed: 0", "seed: \x07", "not valid YAML: unacceptable character"),
    "unrendered template": ("  red_box:", "  {{name}}:", "line 6: not valid YAML: found unhashable key"),
    "list for a name": ("  red_box:", "  [1, 2]:", "line 6: not valid YAML: found unhashable key"),
    "impossible date": ("seed: 0", "seed: 2020-99-99", "line 8: not valid YAML: '2020-99-99' is no timestamp"),
    "text tagged as a number": ("seed: 0", "seed: !!int abc", "line 8: not valid YAML: 'abc' is no int"),
    "text tagged as a float": ("mass: 0.1", "mass: !!float abc", "line 6: not valid YAML: 'abc' is no float"),
    "text tagged as a truth": ("seed: 0", "seed: !!bool abc", "line 8: not valid YAML: 'abc' is no bool"),
    "text tagged as a date": ("seed: 0", "seed: !!timestamp abc", "line 8: not valid YAML: 'abc' is no timestamp"),
    "unknown tag": ("seed: 0", "seed: !odd 0", "line 8: not valid YAML: could not determine a constructor"),
}


@pytest.mark.parametrize(("good", "bad", "sentence"), MISTAKES.values(), ids=MISTAKES)
def test_a_mistake_gives_one_sentence(good: str, bad: str, sentence: str, tmp_path: Path) -> None:
    assert GOOD.count(good) >= 1
    path = tmp_path / "scene.yaml"
    path.write_text(GOOD.replace(good, bad, 1))
    with pytest.raises(IctampError) as error:
        load_scene(path)
    assert str(error.value).startswith(f"{path}: ")
    assert sentence in str(error.value)
    assert "\n" not in str(error.value)


def test_the_file_without_mistakes_is_read(tmp_path: Path) -> None:
    path = tmp_path / "scene.yaml"
    path.write_text(GOOD)
    assert load_scene(path).interference == ("stacked", "tipped")


def test_what_was_merged_can_be_merged_again() -> None:
    first, second = "first: &first {mass: 1, yaw: 1}", "second: &second {<<: *first, mass: 2}"
    text = f"shared: {{{first}, {second}}}\nred_box: {{<<: *second, mass: 3}}"
    assert mapping(parse(text), "")["red_box"] == {"mass": 3, "yaw": 1}


def test_numbers_in_scientific_notation_are_numbers(tmp_path: Path) -> None:
    path = tmp_path / "scene.yaml"
    path.write_text(GOOD.replace("mass: 0.1", "mass: 1e-1"))
    assert load_scene(path).boxes["red_box"].mass == 0.1


@pytest.mark.parametrize(("content", "sentence"), [(b"", "the file is None"), (b"\xff\xfe\x00", "not a text file")])
def test_a_file_that_is_no_scene(content: bytes, sentence: str, tmp_path: Path) -> None:
    path = tmp_path / "scene.yaml"
    path.write_bytes(content)
    with pytest.raises(IctampError, match=sentence):
        load_scene(path)


def test_a_missing_file_and_a_folder(tmp_path: Path) -> None:
    with pytest.raises(IctampError, match=r"none\.yaml: cannot be read: No such file"):
        load_scene(tmp_path / "none.yaml")
    with pytest.raises(IctampError, match="cannot be read: Is a directory"):
        load_scene(tmp_path)
