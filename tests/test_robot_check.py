"""The program `robot`: each mistake in a robot file or its model is found, with its field, and sound ones pass."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from ictamp_drake import robot
from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.robots.checking.report import Report, check_robot
from ictamp_drake.robots.robot import find_robot
from ictamp_drake.runs.command import BAD_INPUT, COMPLETE
from ictamp_drake.scenes.spec import BoxSpec, SceneSpec, SupportSpec
from ictamp_drake.tamp.holding import check_holding
from ictamp_drake.viz.robot import LENGTHS, open_robot
from ictamp_drake.world.world import World
from tests.robots import small

Content = dict[str, Any]
Found = tuple[Code, str]


def find(file: Path | str) -> set[Found]:
    """Codes and fields of the mistakes."""
    return {(problem.code, problem.where.field) for problem in check_robot(str(file)).problems}


def spoiled(change: Callable[[Content], object]) -> Content:
    """Content of the small robot's file after a change."""
    content = small.content()
    change(content)
    return content


@pytest.mark.parametrize("name", ["panda", "small"])
def test_a_sound_robot_passes(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = str(small.write(tmp_path)) if name == "small" else name
    assert robot.main(["check", file]) == COMPLETE
    printed = capsys.readouterr().out
    found = check_robot(file).robot
    assert found is not None
    assert all(joint in printed for joint in found.joints)


def gripper(**changes: object) -> Callable[[Content], object]:
    return lambda content: content["gripper"].update(changes)


def pad(name: str, **changes: object) -> Callable[[Content], object]:
    return lambda content: content["gripper"]["pads"][name].update(changes)


TABLE = SupportSpec(kind="table", position=(0.4, 0.0, 0.0))
BOX = BoxSpec(size=(0.04, 0.04, 0.04), position=(0.4, 0.0, 0.02))
TILTED = [0.0, 0.0, 1.6, 0.0, 1.0, 0.0]
FOLDED = [0.0, 0.0, 2.85, 0.0, 0.2915926535897931, 0.0]

MISTAKES: dict[str, tuple[Callable[[Content], object], set[Found]]] = {
    "no such field": (lambda c: c.update(tool=1), {(Code.UNKNOWN_FIELD, "tool")}),
    "no flange": (lambda c: c.pop("flange"), {(Code.MISSING_FIELD, "flange")}),
    "text for a number": (gripper(opening="wide"), {(Code.WRONG_TYPE, "gripper.opening")}),
    "home too short": (lambda c: c.update(home=[0, 0]), {(Code.WRONG_LENGTH, "home")}),
    "several": (
        lambda c: (c.update(tool=1, kinematics="best", stiffness=[1, 2]), c["gripper"].pop("force"), c.pop("base")),
        {
            (Code.UNKNOWN_FIELD, "tool"),
            (Code.UNKNOWN_CHOICE, "kinematics"),
            (Code.WRONG_LENGTH, "stiffness"),
            (Code.MISSING_FIELD, "gripper.force"),
            (Code.MISSING_FIELD, "base"),
        },
    ),
    "no model": (lambda c: c.update(model="other.urdf"), {(Code.NOT_FOUND, "model")}),
    "no package": (
        lambda c: (c.update(model="package://no_such_package/a.urdf"), gripper(model="b.sdf", mount={"frame": "a"})(c)),
        {(Code.NOT_INSTALLED, "model"), (Code.NOT_FOUND, "gripper.model")},
    ),
    "names": (
        lambda c: (
            c.update(base="a", flange="b", touching=[["base", "c"]], collision={"d": []}),
            c["joints"].__setitem__(1, "e"),
            gripper(base="f", joints=["g", "right_joint"])(c),
            pad("second", frame="h")(c),
        ),
        {
            (Code.UNKNOWN_CHOICE, field)
            for field in (
                *("base", "flange", "touching[0]", "collision.d", "joints[1]"),
                *("gripper.base", "gripper.joints[0]", "gripper.pads.second"),
            )
        },
    ),
    "order of joints": (
        lambda c: c.update(joints=["shoulder", "waist", *list(small.HEIGHT)[2:]]),
        {(Code.CONFLICT, "joints[0]")},
    ),
    "joint left out": (
        lambda c: c.update(joints=list(small.HEIGHT)[:5], home=c["home"][:5]),
        {(Code.MISSING_FIELD, "joints")},
    ),
    "joint of a finger": (
        lambda c: c["joints"].__setitem__(5, "left_joint"),
        {(Code.REPEATED, "gripper.joints[0]")},
    ),
    "joint that slides": (
        lambda c: (c["joints"].__setitem__(5, "left_joint"), gripper(joints=["right_joint"])(c)),
        {(Code.WRONG_TYPE, "joints[5]"), (Code.CONFLICT, "joints[5]"), (Code.MISSING_FIELD, "joints")},
    ),
    "joint that nothing moves": (gripper(joints=["left_joint"]), {(Code.CONFLICT, "gripper.joints")}),
    "limits": (
        lambda c: [c.pop(name) for name in ("acceleration", "jerk")],
        {(Code.MISSING_FIELD, "acceleration"), (Code.MISSING_FIELD, "jerk")},
    ),
    "home beyond a limit": (lambda c: c["home"].__setitem__(0, 3.0), {(Code.OUT_OF_RANGE, "home[0]")}),
    "home that does not point down": (lambda c: c.update(home=TILTED), {(Code.CONFLICT, "home")}),
    "home in collision": (lambda c: c.update(home=FOLDED), {(Code.OVERLAP, "home")}),
    "base of the hand on a finger": (gripper(base="left_finger"), {(Code.CONFLICT, "gripper.base")}),
    "pad on the hand": (pad("first", frame="hand"), {(Code.CONFLICT, "gripper.pads.first")}),
    "opening": (gripper(opening=0.2), {(Code.OUT_OF_RANGE, "gripper.opening")}),
    "pads that do not close": (pad("first", position=[0, 0.006, 0.05]), {(Code.CONFLICT, "gripper.pads")}),
    "neither open nor close": (
        lambda c: (gripper(opening=0.2)(c), pad("first", position=[0, 0.006, 0.05])(c)),
        {(Code.OUT_OF_RANGE, "gripper.opening"), (Code.CONFLICT, "gripper.pads")},
    ),
    "pads that are not opposite": (pad("first", position=[0.005, -0.006, 0.05]), {(Code.CONFLICT, "gripper.pads")}),
    "pad turned": (pad("second", rotation=[0, 0, 0]), {(Code.CONFLICT, "gripper.pads.second")}),
    "grasp frame elsewhere": (
        gripper(grasp={"frame": "hand", "position": [0, 0, 0.2]}),
        {(Code.CONFLICT, "gripper.grasp")},
    ),
    "grasp frame upside down": (
        gripper(grasp={"frame": "hand", "position": [0, 0, 0.095], "rotation": [180, 0, 0]}),
        {(Code.CONFLICT, "gripper.grasp"), (Code.CONFLICT, "home")},
    ),
    "kinematics": (lambda c: c.update(kinematics="closed-form"), {(Code.CONFLICT, "kinematics")}),
}


@pytest.mark.parametrize("name", MISTAKES)
def test_a_mistake_in_the_file_is_found(name: str, tmp_path: Path) -> None:
    change, expected = MISTAKES[name]
    assert find(small.write(tmp_path, spoiled(change))) == expected


MODELS: dict[str, tuple[Callable[[str], str], set[Found]]] = {
    "not XML": (lambda text: text[:200], {(Code.NOT_READABLE, "model")}),
    "velocity": (lambda text: text.replace('velocity="2"', ""), {(Code.MISSING_FIELD, "velocity")}),
    "effort": (lambda text: text.replace('effort="80"', ""), {(Code.MISSING_FIELD, "effort")}),
    "effort of 0": (lambda text: text.replace('effort="80"', 'effort="0"'), {(Code.MISSING_FIELD, "effort")}),
    "velocity of 0": (lambda text: text.replace('velocity="2"', 'velocity="0"'), {(Code.MISSING_FIELD, "velocity")}),
    "fixed to the world": (
        lambda text: text.replace(
            "</robot>", '<joint name="w" type="fixed"><parent link="world"/><child link="base"/></joint></robot>'
        ),
        set(),
    ),
    "two roots": (
        lambda text: text.replace("</robot>", small.link("loose", (1, 1, 1)) + "</robot>"),
        {(Code.CONFLICT, "base")},
    ),
    "no number": (lambda text: text.replace('effort="80"', 'effort="much"'), {(Code.NOT_READABLE, "model")}),
    "mass": (
        lambda text: re.sub(r'(<link name="wrist_link">.*?)<mass.*?/>.*?</inertial>', r"\1</inertial>", text),
        set(),
    ),
    "mass of a finger": (
        lambda text: re.sub(r'(<link name="left_finger">)<inertial>.*?</inertial>', r"\1", text),
        {(Code.OUT_OF_RANGE, "model")},
    ),
    "no shapes": (
        lambda text: re.sub(r'(<link name="elbow_link">.*?)<collision>.*?</collision>', r"\1", text),
        {(Code.EMPTY, "model")},
    ),
    "mesh": (
        lambda text: text.replace('<box size="0.06 0.16 0.04"/>', '<mesh filename="hand.stl"/>'),
        {(Code.NOT_READABLE, "model")},
    ),
    "size": (lambda text: text.replace("0.06 0.16 0.04", "0.06 0 0.04"), {(Code.OUT_OF_RANGE, "model")}),
    "not a number": (lambda text: text.replace('xyz="0 0 0.3"', 'xyz="0 0 nan"'), {(Code.OUT_OF_RANGE, "model")}),
    "table out of reach": (
        lambda text: text.replace('xyz="0 0 0.3"', 'xyz="0 0 0.06"').replace('xyz="0 0 0.15"', 'xyz="0 0 0.06"'),
        {(Code.NOT_REACHABLE, "base")},
    ),
    "no mesh": (
        lambda text: text.replace('<box size="0.06 0.16 0.04"/>', '<mesh filename="hand.obj"/>'),
        {(Code.NOT_FOUND, "model")},
    ),
}


@pytest.mark.parametrize("name", MODELS)
def test_a_mistake_in_the_model_is_found(name: str, tmp_path: Path) -> None:
    change, expected = MODELS[name]
    text = small.urdf()
    assert change(text) != text
    assert find(small.write(tmp_path, model=change(text))) == expected


def test_shapes_of_the_file_replace_a_mesh_that_drake_cannot_take(tmp_path: Path) -> None:
    text = re.sub(r'(<collision>.{,40})<box size="0.06 0.16 0.04"/>', r'\1<mesh filename="hand.stl"/>', small.urdf())
    assert text != small.urdf()
    content = small.content()
    content["gripper"]["collision"] = {"hand": [{"kind": "box", "size": [0.06, 0.16, 0.04], "position": [0, 0, 0.02]}]}
    assert find(small.write(tmp_path, content, text)) == set()


def test_a_model_in_mjcf_is_the_same_robot(tmp_path: Path) -> None:
    (tmp_path / "small.xml").write_text(small.mjcf(), encoding="utf-8")
    file = small.write(tmp_path, spoiled(lambda c: c.update(model="small.xml")))
    assert find(file) == {(Code.MISSING_FIELD, "velocity"), (Code.MISSING_FIELD, "effort")}
    content = spoiled(lambda c: c.update(model="small.xml", velocity=[2], effort=[80]))
    found = check_robot(str(small.write(tmp_path, content)))
    assert found.problems == ()
    assert found.reach == check_robot(str(small.write(tmp_path))).reach


def test_mistakes_name_file_and_line_and_the_program_ends_with_2(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = small.write(tmp_path, spoiled(lambda c: c["home"].__setitem__(0, 3.0)))
    line = next(n for n, text in enumerate(file.read_text().splitlines(), 1) if text.startswith("home:")) + 1
    (problem,) = check_robot(str(file)).problems
    assert (problem.where.file, problem.where.line) == (str(file), line)
    assert robot.main(["check", str(file)]) == BAD_INPUT
    assert str(problem) in capsys.readouterr().out


@pytest.mark.parametrize(
    ("name", "code"), [("hal", Code.UNKNOWN_CHOICE), ("no/such.yaml", Code.NOT_READABLE), (".yaml", Code.NOT_READABLE)]
)
def test_a_robot_that_is_not_there_is_a_mistake(name: str, code: Code) -> None:
    assert [problem.code for problem in check_robot(name).problems] == [code]
    assert robot.main(["check", name]) == BAD_INPUT


def test_a_file_that_is_not_a_mapping_is_a_mistake(tmp_path: Path) -> None:
    for number, text in enumerate(("", "- a", "a: [", "model: {1: 2}\nx: &x [*x]", "\0")):
        file = tmp_path / f"{number}.yaml"
        file.write_text(text)
        assert check_robot(str(file)).problems


def test_a_weak_hand_does_not_hold_a_box(tmp_path: Path) -> None:
    file = small.write(tmp_path, spoiled(gripper(stiffness=1, damping=0, force=1)))
    report = check_robot(str(file))
    assert report.robot is not None
    assert report.problems == ()
    assert [problem.code for problem in check_holding(report.robot)] == [Code.NOT_HELD]


def test_efforts_are_those_of_the_model_or_else_those_of_the_file(tmp_path: Path) -> None:
    found = [find_robot(str(small.write(tmp_path, spoiled(change)))) for change in (lambda _: 0, effort_of_30)]
    assert [set(each.effort) for each in found] == [{80.0}, {30.0}]


@pytest.mark.parametrize("name", ["not XML", "velocity", "no mesh"])
def test_a_scene_with_a_broken_model_is_refused(name: str, tmp_path: Path) -> None:
    file = small.write(tmp_path, model=MODELS[name][0](small.urdf()))
    with pytest.raises(IctampError) as caught:
        World(SceneSpec(robot=str(file), supports={"table": TABLE}, boxes={"a": BOX}, goal="(on a table)"))
    assert caught.value.where.file == str(file)


def effort_of_30(content: Content) -> None:
    content["effort"] = [30]


JUNK = (None, "x", -1, [], {"a": 1}, float("nan"), 1e9, "hand")


@pytest.mark.parametrize("field", [*small.content(), *(f"gripper.{name}" for name in small.content()["gripper"])])
def test_no_value_of_a_field_breaks_the_check(field: str, tmp_path: Path) -> None:
    *section, name = field.split(".")
    for junk in JUNK:
        content = small.content()
        (content["gripper"] if section else content)[name] = junk
        assert isinstance(check_robot(str(small.write(tmp_path, content))), Report)


def test_the_robot_is_shown_with_its_frames(tmp_path: Path) -> None:
    found = check_robot(str(small.write(tmp_path))).robot
    assert found is not None
    meshcat = open_robot(found)
    assert all(meshcat.HasPath(f"frames/{name}") for name in LENGTHS)
