"""plan.yaml: numbers are read back exactly, what is written is described, and what is no sound plan is refused."""

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from jsonschema import Draft202012Validator
from scipy.spatial.transform import Rotation

from ictamp_drake.core.decoding import decode
from ictamp_drake.core.errors import Code
from ictamp_drake.core.reading import parse
from ictamp_drake.core.types import Action, Attempt, Configuration, FloatArray, GripperCommand, Segment
from ictamp_drake.models.panda import ARM_LIMITS
from ictamp_drake.motion.splines import knots, paces
from ictamp_drake.scenes.spec import SceneSpec
from ictamp_drake.tamp import plan_file
from ictamp_drake.tamp.method import Method
from ictamp_drake.tamp.plan import Plan, read_plan, write_plan
from ictamp_drake.tamp.plan_origin import Origin
from ictamp_drake.world.abstraction import SceneAbstraction
from ictamp_drake.world.world import World
from tests.panda import HOME
from tests.refusals import refusal
from tests.runs.programs import SCENE
from tests.tamp.spoiling import judge, spoil

CASES = Path(__file__).parent / "cases"
PLAN = CASES / "plan.yaml"
"""A plan of today's format with two skills."""
SPEC = decode(SceneSpec, parse(SCENE))
SCHEMA = json.loads(Path(plan_file.__file__).with_name("plan.schema.json").read_text())
PAGE = (Path(__file__).parents[2] / "docs" / "plan_file.md").read_text(encoding="utf-8")

LOWER, UPPER = ([getattr(limits, end) for limits in ARM_LIMITS] for end in ("lower", "upper"))
numbers = st.floats(-10, 10)
goals = st.tuples(*(st.floats(low, high) for low, high in zip(LOWER, UPPER, strict=True))).map(np.array)
commands = st.builds(GripperCommand, st.floats(0, 0.08), st.floats(0, 70))
touching = st.none() | st.frozensets(st.sampled_from(["red_box", "rack"]))


def move(start: FloatArray, goal: FloatArray, duration: float, gripper: GripperCommand, **touches: Any) -> Segment:
    """Motion from rest to rest."""
    points = start + paces(9, 5)[0][:, None] * (goal - start)
    points[-3:] = goal
    return Segment("go", duration, gripper, 5, knots(9, 5) * duration, points, **touches)


@settings(max_examples=10)
@given(
    k=arrays(float, 4, elements=numbers),
    ways=st.lists(st.tuples(goals, st.floats(30, 100), commands, touching), min_size=1, max_size=3),
    lag=arrays(float, 7, elements=st.floats(-1e-3, 1e-3)),
)
def test_a_plan_survives_bit_for_bit(
    k: FloatArray,
    ways: list[tuple[FloatArray, float, GripperCommand, frozenset[str] | None]],
    lag: FloatArray,
    tmp_path_factory: pytest.TempPathFactory,
) -> None:
    path = tmp_path_factory.mktemp("plan") / "plan.yaml"
    poses = {name: box.X_WO for name, box in SPEC.boxes.items()}
    c = Configuration(HOME + lag, np.array([0.04, 0.04]), poses, commanded=HOME)
    motion: list[Segment] = []
    for goal, duration, gripper, touches in ways:
        start = motion[-1].control_points[-1] if motion else HOME
        motion.append(move(start, goal, duration, gripper, touches=touches))
    action = Action("pick", ("red_box", "table"))
    write_plan(Plan(SPEC, c, (Attempt(action, None, k=k, motion=tuple(motion)),)), path)
    plan = read_plan(path)
    assert plan.spec == SPEC
    assert plan.c == c
    (attempt,) = plan.attempts
    assert attempt.action == action
    assert attempt.successor is None
    assert attempt.k is not None
    assert attempt.k.tobytes() == k.tobytes()
    for read, written in zip(attempt.motion, motion, strict=True):
        assert (read.label, read.duration, read.order) == (written.label, written.duration, written.order)
        assert (read.gripper, read.touches) == (written.gripper, written.touches)
        assert read.knots.tobytes() == written.knots.tobytes()
        assert read.control_points.tobytes() == written.control_points.tobytes()


Spoil = Callable[[dict[str, Any]], object]


def at(path: str, value: Any) -> Spoil:
    """A change of one value; keys of lists are numbers."""

    def change(content: Any) -> None:
        *parents, last = (int(key) if key.lstrip("-").isdigit() else key for key in path.split("."))
        for key in parents:
            content = content[key]
        content[last] = value(content[last]) if callable(value) else value

    return change


def without(path: str) -> Spoil:
    """A change that removes an entry."""
    *parents, last = path.split(".")

    def remove(value: Any) -> Any:
        return {key: item for key, item in value.items() if key != last}

    return at(".".join(parents), remove) if parents else lambda content: content.pop(last)


# the file of a plan that was found


@pytest.fixture(scope="module")
def content() -> dict[str, Any]:
    """Content of the file."""
    return yaml.safe_load(PLAN.read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def plan() -> Plan:
    return Plan.load(PLAN)


def test_a_plan_that_was_read_is_written_as_it_was(plan: Plan, tmp_path: Path) -> None:
    plan.save(tmp_path / "plan.yaml")
    assert (tmp_path / "plan.yaml").read_text() == PLAN.read_text()


def test_the_plan_is_executed_as_it_says(plan: Plan) -> None:
    replay = plan.replay()
    assert replay.reached
    for outcome, attempt in zip(replay.outcomes, plan.attempts, strict=True):
        assert attempt.successor is not None
        np.testing.assert_allclose(outcome.c.q, attempt.successor.q, atol=1e-6)
        np.testing.assert_allclose(outcome.c.fingers, attempt.successor.fingers, atol=1e-6)
        for name, pose in attempt.successor.poses.items():
            np.testing.assert_allclose(outcome.c.poses[name], pose, atol=1e-6)


def test_an_empty_plan_is_read(plan: Plan, tmp_path: Path) -> None:
    path = tmp_path / "plan.yaml"
    replace(plan, attempts=()).save(path)
    empty = Plan.load(path)
    assert (len(empty), empty.duration, empty.c) == (0, 0, plan.c)
    with refusal(Code.EMPTY):
        empty.trajectory()


def test_the_rest_of_a_plan_is_a_plan_that_starts_with_a_held_box(plan: Plan, tmp_path: Path) -> None:
    path = tmp_path / "plan.yaml"
    first, *rest = plan.attempts
    assert first.successor is not None
    replace(plan, c=first.successor, attempts=tuple(rest)).save(path)
    read = Plan.load(path)
    assert (read.c.held, str(read)) == ("red_box", "place(red_box, rack)")
    assert read.replay().reached


def without_surroundings(content: dict[str, Any], version: int) -> dict[str, Any]:
    """The content as an earlier format had it."""
    initial = {"q", "poses", "held", "gripper", *(("commanded", "x") if version == 2 else ())}
    segment = {"label", "start", "duration", "gripper", "order", "knots", "control_points"}
    segment |= {"touches"} if version == 2 else set()
    return {
        "format": version,
        "scene": content["scene"],
        "initial": {key: value for key, value in content["initial"].items() if key in initial},
        "skeleton": content["skeleton"],
        "steps": [
            {
                "action": step["action"],
                "k": step["k"],
                "segments": [{key: each[key] for key in segment} for each in step["segments"]],
            }
            for step in content["steps"]
        ],
    }


@pytest.mark.parametrize("version", [1, 2])
def test_older_formats_become_todays(version: int, content: dict[str, Any], plan: Plan, tmp_path: Path) -> None:
    path = tmp_path / "plan.yaml"
    path.write_text(yaml.safe_dump(without_surroundings(content, version)))
    old = Plan.load(path)
    assert (old.spec, old.actions, old.origin) == (plan.spec, plan.actions, None)
    assert old.c == (plan.c if version == 2 else replace(plan.c, commanded=old.c.q, x=None))
    assert all(attempt.successor is None for attempt in old.attempts)
    assert old.replay().reached
    old.save(path)
    written = yaml.safe_load(path.read_text())
    Draft202012Validator(SCHEMA).validate(written)
    assert [step["expected"] for step in written["steps"]] == [None, None]
    assert Plan.load(path).c == old.c


@pytest.mark.parametrize(
    ("change", "code", "field"),
    [
        (at("steps.0.action", "pick(red_box, rack)"), Code.CONFLICT, "steps[0].action"),
        (at("steps.0.segments.1.start", 3), Code.CONFLICT, "steps[0].segments[1].start"),
        (at("initial.poses.blue_box", [1, 0, 0, 0, 0.46, 0.12, 0.04]), Code.OVERLAP, "initial.poses"),
        (at("initial.poses.red_box.6", 0.5), Code.BAD_STATE, "initial.poses.red_box"),
    ],
)
def test_older_formats_are_checked_too(
    change: Spoil, code: Code, field: str, content: dict[str, Any], tmp_path: Path
) -> None:
    spoiled = json.loads(json.dumps(without_surroundings(content, 1)))
    change(spoiled)
    path = tmp_path / "plan.yaml"
    path.write_text(yaml.safe_dump(spoiled))
    with refusal(code, field, file=path):
        read_plan(path)


def test_the_file_follows_the_schema(content: dict[str, Any]) -> None:
    Draft202012Validator.check_schema(SCHEMA)
    Draft202012Validator(SCHEMA).validate(content)


def test_the_schema_knows_other_arms(content: dict[str, Any]) -> None:
    """Six joints, a sphere, and a hand without fingers."""
    other = json.loads(json.dumps(content))
    del other["robot"]["joints"][-1], other["robot"]["gripper"]["pads"]
    other["robot"]["gripper"] |= {"type": "suction", "joints": []}
    other["bodies"]["red_box"]["shapes"] = [{"kind": "sphere", "size": [0.03], "pose": [1, 0, 0, 0, 0, 0, 0]}]
    for place in (other["initial"], *(step["expected"] for step in other["steps"])):
        place["q"] = place["q"][:6]
    for step in other["steps"]:
        for segment in step["segments"]:
            segment["control_points"] = [q[:6] for q in segment["control_points"]]
    Draft202012Validator(SCHEMA).validate(other)


def _fields(schema: dict[str, Any]) -> set[str]:
    names = set(schema.get("properties", ()))
    for part in schema.values():
        for each in part if isinstance(part, list) else [part]:
            names |= _fields(each) if isinstance(each, dict) else set()
    return names


def test_the_page_explains_every_field() -> None:
    missing = {name for name in _fields(SCHEMA) if name not in PAGE}
    assert not missing


def test_the_file_tells_what_is_seen_after_every_step(plan: Plan, content: dict[str, Any]) -> None:
    abstraction = SceneAbstraction(World(plan.spec))
    for attempt, step in zip(plan.attempts, content["steps"], strict=True):
        assert attempt.successor is not None
        expected = step["expected"]
        assert set(expected["atoms"]) == set(map(str, abstraction(attempt.successor)))
        assert expected["poses"].keys() == plan.spec.boxes.keys()
    picked, placed = (step["expected"] for step in content["steps"])
    assert picked["held"] == picked["load"]["body"] == "red_box"
    assert picked["load"]["mass"] == plan.spec.boxes["red_box"].mass
    assert picked["width"] == pytest.approx(0.05, abs=2e-3)
    assert (placed["held"], placed["load"]) == (None, None)
    assert "on(red_box, rack)" in placed["atoms"]


def transform(pose: list[float]) -> FloatArray:
    X = np.eye(4)
    X[:3, :3] = Rotation.from_quat(pose[:4], scalar_first=True).as_matrix()
    X[:3, 3] = pose[4:]
    return X


def test_frames_fit_together(content: dict[str, Any]) -> None:
    """World, base, and the flange with the load, by the Denavit-Hartenberg parameters of Franka."""
    X_WB = transform(content["robot"]["base"])
    moment = content["steps"][0]["expected"]
    for name, pose in moment["poses"].items():
        np.testing.assert_allclose(X_WB @ transform(moment["poses_in_base"][name]), transform(pose), atol=1e-9)
    rack = content["bodies"]["rack"]
    np.testing.assert_allclose(X_WB @ transform(rack["pose_in_base"]), transform(rack["pose"]), atol=1e-9)
    X_BF = np.eye(4)
    half = np.pi / 2
    rows = [(0, 0.333, 0), (0, 0, -half), (0, 0.316, half), (0.0825, 0, half), (-0.0825, 0.384, -half), (0, 0, half)]
    for (a, d, alpha), q in zip([*rows, (0.088, 0.107, half)], moment["q"], strict=False):
        turn = Rotation.from_euler("x", alpha) * Rotation.from_euler("z", q)
        step = np.eye(4)
        step[:3, :3] = turn.as_matrix()
        step[:3, 3] = Rotation.from_euler("x", alpha).apply([a, 0, d])
        X_BF = X_BF @ step
    X_BO = X_BF @ transform(moment["load"]["pose_in_flange"])
    np.testing.assert_allclose(X_BO, transform(moment["poses_in_base"]["red_box"]), atol=1e-9)
    p_GO = np.linalg.inv(transform(content["robot"]["gripper"]["grasp_frame"])) @ np.linalg.inv(X_BF) @ X_BO[:, 3]
    assert np.linalg.norm(p_GO[:3]) < 0.06, "the load is between the fingers"


def test_the_origin_is_that_of_the_search(plan: Plan) -> None:
    assert plan.origin is not None
    assert plan.origin.seed == 0
    assert plan.origin.options["planner"]
    made = Origin.of(Method(seed=5))
    assert (made.seed, made.timing.velocity) == (5, 0.7)


# what is no plan


@pytest.mark.parametrize(
    ("text", "code", "field"),
    [
        ("- 1", Code.WRONG_TYPE, ""),
        ("format: 1", Code.MISSING_FIELD, "scene"),
        ("format: [", Code.NOT_YAML, ""),
        ("format: 9", Code.OTHER_VERSION, "format"),
        ("format: true", Code.OTHER_VERSION, "format"),
        ("format: " + "[" * 30_000, Code.TOO_DEEP, ""),
    ],
)
def test_what_is_no_plan_is_refused(text: str, code: Code, field: str, tmp_path: Path) -> None:
    path = tmp_path / "plan.yaml"
    path.write_text(text)
    with refusal(code, field, file=path):
        read_plan(path)


@pytest.mark.parametrize(
    ("name", "code"),
    [
        ("plan-action-null.yaml", Code.MISSING_FIELD),
        ("plan-nested.yaml", Code.TOO_DEEP),
        ("plan-poses-null.yaml", Code.MISSING_FIELD),
    ],
)
def test_files_that_once_ended_the_process_are_refused(name: str, code: Code) -> None:
    with refusal(code, file=CASES / name):
        read_plan(CASES / name)


def test_a_missing_plan_is_named(tmp_path: Path) -> None:
    with refusal(Code.NOT_READABLE, file=tmp_path / "plan.yaml"):
        read_plan(tmp_path / "plan.yaml")


NAN, FIRST = float("nan"), "steps.0.segments.0"
SPOILED: list[tuple[Spoil, Code, str]] = [
    (at("initial.poses", None), Code.WRONG_TYPE, "initial.poses"),
    (at("initial.q", [0.0] * 7), Code.WRONG_LENGTH, "initial.q"),
    (at("initial.q.1", NAN), Code.OUT_OF_RANGE, "initial.q"),
    (at("initial.q.1", 9.0), Code.OUT_OF_RANGE, "initial.q"),
    (at("initial.q.7", 0.4), Code.OUT_OF_RANGE, "initial.q"),
    (at("initial.commanded.0", 0.5), Code.CONFLICT, "initial.commanded"),
    (at("initial.poses.red_box", [0.0] * 7), Code.OUT_OF_RANGE, "initial.poses.red_box"),
    (at("initial.poses.red_box.6", float("inf")), Code.OUT_OF_RANGE, "initial.poses.red_box"),
    (without("initial.poses.red_box"), Code.MISSING_FIELD, "initial.poses.red_box"),
    (at("initial.poses.ghost", [1.0, 0, 0, 0, 0, 0, 0]), Code.UNKNOWN_CHOICE, "initial.poses.ghost"),
    (at("initial.held", "ghost"), Code.UNKNOWN_CHOICE, "initial.held"),
    (at("initial.x", lambda x: x[1:]), Code.WRONG_LENGTH, "initial.x"),
    (at("initial.x.0", lambda x: x + 1e-9), Code.CONFLICT, "initial.x"),
    (at("initial.x.-1", NAN), Code.OUT_OF_RANGE, "initial.x"),
    (at("initial.gripper.width", "wide"), Code.WRONG_TYPE, "initial.gripper.width"),
    (at("initial.gripper.grip", 3), Code.UNKNOWN_FIELD, "initial.gripper.grip"),
    (at("initial.atoms", []), Code.CONFLICT, "initial.atoms"),
    (without("initial.width"), Code.MISSING_FIELD, "initial.width"),
    (at("skeleton", ["pick(red_box, table)"]), Code.CONFLICT, "skeleton"),
    (at("steps", None), Code.WRONG_TYPE, "steps"),
    (at("steps.0.action", None), Code.WRONG_TYPE, "steps[0].action"),
    (at("steps.0.action", "go"), Code.UNKNOWN_CHOICE, "steps[0].action"),
    (at("steps.0.action", "pick(ghost, table)"), Code.UNKNOWN_CHOICE, "steps[0].action"),
    (at("steps.0.action", "pick(red_box, red_box)"), Code.UNKNOWN_CHOICE, "steps[0].action"),
    (at("steps.0.action", "pick(red_box, rack)"), Code.CONFLICT, "steps[0].action"),
    (at("steps", lambda steps: steps[1:]), Code.CONFLICT, "steps[0].segments[0].control_points[0]"),
    (at("steps.0.k", None), Code.WRONG_TYPE, "steps[0].k"),
    (at("steps.0.k", [1, 2, 3]), Code.WRONG_LENGTH, "steps[0].k"),
    (at("steps.0.k.0", NAN), Code.OUT_OF_RANGE, "steps[0].k"),
    (at("steps.0.segments", []), Code.EMPTY, "steps[0].segments"),
    (at(f"{FIRST}.start", 99), Code.CONFLICT, "steps[0].segments[0].start"),
    (at(f"{FIRST}.duration", -1), Code.OUT_OF_RANGE, "steps[0].segments[0].duration"),
    (at(f"{FIRST}.duration", lambda duration: duration + 1), Code.CONFLICT, "steps[0].segments[0].knots"),
    (at(f"{FIRST}.gripper.width", 0.3), Code.OUT_OF_RANGE, "steps[0].segments[0].gripper.width"),
    (at(f"{FIRST}.gripper.force", NAN), Code.OUT_OF_RANGE, "steps[0].segments[0].gripper.force"),
    (at(f"{FIRST}.order", 0), Code.OUT_OF_RANGE, "steps[0].segments[0].order"),
    (at(f"{FIRST}.order", "x"), Code.WRONG_TYPE, "steps[0].segments[0].order"),
    (at(f"{FIRST}.knots", lambda knots: knots[1:]), Code.WRONG_LENGTH, "steps[0].segments[0].knots"),
    (at(f"{FIRST}.knots", lambda knots: knots[::-1]), Code.CONFLICT, "steps[0].segments[0].knots"),
    (at(f"{FIRST}.knots", {}), Code.WRONG_TYPE, "steps[0].segments[0].knots"),
    (at(f"{FIRST}.knots.7", NAN), Code.OUT_OF_RANGE, "steps[0].segments[0].knots"),
    (at(f"{FIRST}.control_points", []), Code.EMPTY, "steps[0].segments[0].control_points"),
    (at(f"{FIRST}.control_points.3", [0] * 6), Code.WRONG_LENGTH, "steps[0].segments[0].control_points[3]"),
    (at(f"{FIRST}.control_points.3.0", 9), Code.OUT_OF_RANGE, "steps[0].segments[0].control_points[3]"),
    (at(f"{FIRST}.control_points.5.0", lambda q: q + 1), Code.OUT_OF_RANGE, "steps[0].segments[0].control_points"),
    (at(f"{FIRST}.control_points.0.0", lambda q: q + 0.1), Code.CONFLICT, "steps[0].segments[0].control_points"),
    (at(f"{FIRST}.touches", ["ghost"]), Code.UNKNOWN_CHOICE, "steps[0].segments[0].touches[0]"),
    (at("steps.0.expected.atoms.0", "on(red_box, rack)"), Code.CONFLICT, "steps[0].expected.atoms[0]"),
    (at("steps.0.expected.width", 0.01), Code.CONFLICT, "steps[0].expected.width"),
    (at("steps.0.expected.load.mass", 3), Code.CONFLICT, "steps[0].expected.load.mass"),
    (at("steps.0.expected.poses.red_box", [1, 0, 0, 0, 0.5, 0.3, 0.3]), Code.CONFLICT, "steps[0].expected"),
    (at("robot.joints.0.name", "joint"), Code.CONFLICT, "robot.joints[0].name"),
    (at("robot.gripper.type", "suction"), Code.CONFLICT, "robot.gripper.type"),
    (without("robot.gripper.pads"), Code.MISSING_FIELD, "robot.gripper.pads"),
    (at("contact.friction.pads", 0.1), Code.CONFLICT, "contact.friction.pads"),
    (at("bodies.rack.shapes", []), Code.CONFLICT, "bodies.rack.shapes"),
    (at("units.angle", "deg"), Code.CONFLICT, "units.angle"),
    (without("bodies"), Code.MISSING_FIELD, "bodies"),
    (at("origin.timing.velocity", 2), Code.OUT_OF_RANGE, "origin.timing.velocity"),
    (at("scene.boxes.red_box.mass", 99), Code.OUT_OF_RANGE, "scene.boxes.red_box.mass"),
    (at("scene.goal", "(on ghost rack)"), Code.UNKNOWN_CHOICE, "scene.goal"),
    (at("scene.goal", "(" * 498), Code.NOT_PDDL, "scene.goal"),
]


@pytest.mark.parametrize(("change", "code", "field"), SPOILED)
def test_a_plan_with_one_fault_is_refused(
    change: Spoil, code: Code, field: str, content: dict[str, Any], tmp_path: Path
) -> None:
    spoiled = json.loads(json.dumps(content))
    change(spoiled)
    path = tmp_path / "plan.yaml"
    path.write_text(yaml.safe_dump(spoiled))
    with refusal(code, field, file=path):
        read_plan(path)


@pytest.mark.slow
@pytest.mark.timeout(600)
@pytest.mark.parametrize("part", range(10))
def test_a_spoiled_plan_is_refused_or_executed(part: int, tmp_path: Path) -> None:
    """With 30 of 300 seeds each. `python -m tests.tamp.spoiling` does the same with any number."""
    path, text = tmp_path / "plan.yaml", PLAN.read_text(encoding="utf-8")
    for seed in range(30 * part, 30 * part + 30):
        path.write_text(spoil(text, Random(seed)), encoding="utf-8")
        judge(path)
