"""H of boxes that stand, lie, lean, overhang, bridge, or hang in the hand."""

import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydrake.math import RigidTransform, RotationMatrix

from ictamp_drake.core.types import Atom, Configuration, FloatArray, State
from ictamp_drake.scenes.spec import ArmSpec, BoxSpec, SceneSpec
from ictamp_drake.symbolic.atoms import held_box, supporters
from ictamp_drake.symbolic.domain import Domain
from ictamp_drake.world.abstraction import SceneAbstraction
from ictamp_drake.world.config import PredicateConfig
from ictamp_drake.world.poses import to_pose, to_transform
from ictamp_drake.world.world import World
from tests.world.scenes import RACK_TOP, SIZES, arrange, far_boxes, hold_box, pose, scene

NAMES = sorted(SIZES)
CONTACT = PredicateConfig().contact
SPOTS = {"table": [(0.6, y, 0.0) for y in (0.0, 0.12, 0.24, 0.36)], "rack": [(0.44, -0.33, RACK_TOP)]}


@pytest.fixture(scope="module")
def world() -> World:
    return World(scene(far_boxes()))


@pytest.fixture(scope="module")
def abstraction(world: World) -> SceneAbstraction:
    return SceneAbstraction(world)


def atoms_about(state: State, box: str) -> set[str]:
    return {str(atom) for atom in state if box in atom.args and atom.args[0] == box}


# hand-made configurations


def test_boxes_alone_on_the_table(world: World, abstraction: SceneAbstraction) -> None:
    state = abstraction(world.initial_configuration())
    expected = {Atom("hand-empty", ())}
    expected |= {Atom(p, (n,)) for n in NAMES for p in ("clear", "upright")}
    assert state == expected | {Atom("on", (n, "table")) for n in NAMES}


@pytest.mark.parametrize(("offset", "carried"), [(0.0285, True), (0.0295, False), (-0.0285, True), (-0.0295, False)])
@pytest.mark.parametrize("axis", [0, 1])
def test_the_centre_of_mass_must_be_above_the_outline(
    world: World, abstraction: SceneAbstraction, offset: float, carried: bool, axis: int
) -> None:
    shift = np.eye(2)[axis] * offset
    c = arrange(
        world, {"cyan_box": pose(0.4, 0.1, 0.035), "red_box": pose(0.4 + shift[0], 0.1 + shift[1], 0.07 + 0.059)}
    )
    state = abstraction(c)
    assert (Atom("on", ("red_box", "cyan_box")) in state) == carried
    assert Atom("clear", ("cyan_box",)) not in state
    assert Atom("on", ("red_box", "table")) not in state


def test_the_outline_turns_with_the_lower_box(world: World, abstraction: SceneAbstraction) -> None:
    """0.035 m along the diagonal is inside the lower box's outline; along its side it is not."""
    for yaw, carried in ((0.0, False), (45.0, True)):
        c = arrange(world, {"cyan_box": pose(0.4, 0.1, 0.035, yaw=yaw), "red_box": pose(0.435, 0.1, 0.129)})
        assert (Atom("on", ("red_box", "cyan_box")) in abstraction(c)) == carried


@pytest.mark.parametrize(
    ("gap", "carried"), [(-0.0005, True), (0.0, True), (CONTACT - 1e-4, True), (CONTACT + 1e-4, False)]
)
def test_a_gap_above_the_tolerance_is_no_contact(
    world: World, abstraction: SceneAbstraction, gap: float, carried: bool
) -> None:
    c = arrange(world, {"cyan_box": pose(0.4, 0.1, 0.035), "red_box": pose(0.4, 0.1, 0.129 + gap)})
    assert (Atom("on", ("red_box", "cyan_box")) in abstraction(c)) == carried
    assert (Atom("clear", ("cyan_box",)) in abstraction(c)) != carried


@pytest.mark.parametrize(("roll", "pitch"), [(90, 0), (-90, 0), (0, 90)])
def test_a_box_on_its_side_lies(world: World, abstraction: SceneAbstraction, roll: float, pitch: float) -> None:
    c = arrange(world, {"red_box": pose(0.4, 0.1, 0.025, roll=roll, pitch=pitch, yaw=30.0)})
    assert atoms_about(abstraction(c), "red_box") == {"lying(red_box, table)", "tipped(red_box)", "clear(red_box)"}


@pytest.mark.parametrize(("roll", "pitch"), [(180, 0), (0, -180)])
def test_a_box_on_its_head_stands(world: World, abstraction: SceneAbstraction, roll: float, pitch: float) -> None:
    c = arrange(world, {"red_box": pose(0.4, 0.1, 0.059, roll=roll, pitch=pitch, yaw=30.0)})
    assert atoms_about(abstraction(c), "red_box") == {"on(red_box, table)", "upright(red_box)", "clear(red_box)"}


@pytest.mark.parametrize("pitch", [12.0, 25.0, 40.0])
def test_a_leaning_box_is_neither_on_nor_lying(world: World, abstraction: SceneAbstraction, pitch: float) -> None:
    """Its lower edge stands on the table, and its upper edge leans against the side of another box."""
    angle = math.radians(pitch)
    height = 0.059 * math.cos(angle) + 0.025 * math.sin(angle)
    reach = 0.059 * math.sin(angle) + 0.025 * math.cos(angle)
    c = arrange(world, {"cyan_box": pose(0.4, 0.1, 0.035), "red_box": pose(0.371 - reach, 0.1, height, pitch=pitch)})
    assert atoms_about(abstraction(c), "red_box") == {"upright(red_box)", "clear(red_box)"}


@pytest.mark.parametrize(("x", "below"), [(0.36, "left"), (0.44, "right"), (0.40, None)])
def test_a_bridge_is_carried_by_the_box_under_its_centre(x: float, below: str | None) -> None:
    bridge = BoxSpec((0.05, 0.05, 0.14), (0.6, 0.3, 0.07))
    boxes = {n: BoxSpec((0.05, 0.05, 0.05), (y, 0.1, 0.025)) for n, y in (("left", 0.36), ("right", 0.44))}
    world = World(scene({"bridge": bridge, **boxes}))
    state = SceneAbstraction(world)(arrange(world, {"bridge": pose(x, 0.1, 0.075, pitch=90.0)}))
    assert supporters(state).get("bridge") == below
    assert not {Atom("clear", ("left",)), Atom("clear", ("right",))} & state


def test_on_the_rack_and_under_it(world: World, abstraction: SceneAbstraction) -> None:
    on = arrange(world, {"red_box": pose(0.44, -0.33, RACK_TOP + 0.059)})
    assert atoms_about(abstraction(on), "red_box") == {"on(red_box, rack)", "upright(red_box)", "clear(red_box)"}
    under = arrange(world, {"red_box": pose(0.44, -0.33, 0.059)})
    assert atoms_about(abstraction(under), "red_box") == {"on(red_box, table)", "upright(red_box)", "clear(red_box)"}


@pytest.mark.parametrize(("roll", "posture"), [(0.0, "upright"), (90.0, "tipped"), (180.0, "upright")])
def test_a_box_in_the_hand(world: World, abstraction: SceneAbstraction, roll: float, posture: str) -> None:
    box = "red_box" if roll % 180 == 0 else "yellow_box"
    state = abstraction(hold_box(world, box, roll))
    assert atoms_about(state, box) == {f"in-hand({box})", f"{posture}({box})"}
    assert Atom("hand-empty", ()) not in state


def test_a_box_between_open_fingers_is_not_in_the_hand(world: World, abstraction: SceneAbstraction) -> None:
    c = hold_box(world, "red_box")
    open_hand = Configuration(c.q, np.array([0.04, 0.04]), c.poses, None)
    state = abstraction(open_hand)
    assert Atom("hand-empty", ()) in state
    assert Atom("in-hand", ("red_box",)) not in state


def test_a_gripped_box_that_something_carries_is_not_in_the_hand(world: World, abstraction: SceneAbstraction) -> None:
    c = hold_box(world, "red_box")
    below = to_transform(c.poses["red_box"]).translation() - [0.0, 0.0, 0.059 + 0.035]
    state = abstraction(Configuration(c.q, c.fingers, {**c.poses, "cyan_box": pose(*below)}, "red_box"))
    assert Atom("in-hand", ("red_box",)) not in state
    assert Atom("clear", ("cyan_box",)) not in state


def test_boxes_may_have_the_names_of_the_robots_parts() -> None:
    names = ("arm", "left_finger", "panda_hand", "grasp")
    boxes = {name: BoxSpec((0.05, 0.05, 0.05), (0.5, 0.12 * i, 0.025)) for i, name in enumerate(names)}
    world = World(scene(boxes))
    state = SceneAbstraction(world)(world.initial_configuration())
    assert supporters(state) == dict.fromkeys(names, "table")
    assert Atom("hand-empty", ()) in state


# laws


@st.composite
def arrangements(draw: st.DrawFn) -> tuple[dict[str, FloatArray], State]:
    """Poses of boxes in towers, and their state."""
    order = draw(st.permutations(NAMES))
    spots = [("rack", spot) for spot in SPOTS["rack"]] + [("table", spot) for spot in SPOTS["table"]]
    towers = [(support, spot, [support], spot[2]) for support, spot in spots]
    poses, atoms = {}, {Atom("hand-empty", ())}
    for name in order:
        index = draw(st.integers(0, len(towers) - 1))
        support, (x, y, _), names, top = towers[index]
        roll = draw(st.sampled_from([0.0, 0.0, 0.0, 90.0, -90.0, 180.0]))
        height = SIZES[name][2] if roll in (0.0, 180.0) else SIZES[name][1]
        dx, dy, yaw = draw(st.floats(-0.01, 0.01)), draw(st.floats(-0.01, 0.01)), draw(st.floats(-180, 180))
        poses[name] = pose(x + dx, y + dy, top + height / 2, roll=roll, yaw=yaw)
        atoms.add(Atom("lying" if roll % 180 else "on", (name, names[-1])))
        atoms.add(Atom("tipped" if roll % 180 else "upright", (name,)))
        towers[index] = (support, (x, y, 0.0), [*names, name], top + height)
    covered = {atom.args[1] for atom in atoms if len(atom.args) == 2}
    atoms |= {Atom("clear", (name,)) for name in NAMES if name not in covered}
    return poses, frozenset(atoms)


@given(arrangement=arrangements())
@settings(max_examples=60)
def test_h_says_what_stands_and_lies_where(
    world: World, abstraction: SceneAbstraction, arrangement: tuple[dict[str, FloatArray], State]
) -> None:
    poses, expected = arrangement
    assert abstraction(arrange(world, poses)) == expected


@given(arrangement=arrangements(), held=st.sampled_from([None, *NAMES]))
@settings(max_examples=30)
def test_h_is_complete_and_agrees_with_eval(
    world: World, abstraction: SceneAbstraction, arrangement: tuple[dict[str, FloatArray], State], held: str | None
) -> None:
    """H has exactly the atoms that `symbolic.atoms` demands."""
    poses, _ = arrangement
    c = arrange(world, poses)
    if held is not None:
        gripping = hold_box(world, held)
        c = Configuration(gripping.q, gripping.fingers, {**c.poses, held: gripping.poses[held]}, held)
    state = abstraction(c)
    carried = supporters(state)
    assert held_box(state) == held
    assert (held is None) == (Atom("hand-empty", ()) in state)
    assert held not in carried
    for name in NAMES:
        assert (Atom("upright", (name,)) in state) != (Atom("tipped", (name,)) in state)
        if name in carried:
            where = "on" if Atom("upright", (name,)) in state else "lying"
            assert Atom(where, (name, carried[name])) in state
        bare = name != held and name not in carried.values()
        assert (Atom("clear", (name,)) in state) == bare


def _move_scene(spec: SceneSpec, x: float, y: float, yaw: float) -> SceneSpec:
    """The whole scene, turned about the origin [deg] and moved [m]."""
    s, c = math.sin(math.radians(yaw)), math.cos(math.radians(yaw))

    def place(position: tuple[float, float, float]) -> tuple[float, float, float]:
        return x + c * position[0] - s * position[1], y + s * position[0] + c * position[1], position[2]

    return dataclasses.replace(
        spec,
        arm=ArmSpec(place(spec.arm.position), yaw),
        supports={
            n: dataclasses.replace(each, position=place(each.position), yaw=each.yaw + yaw)
            for n, each in spec.supports.items()
        },
        boxes={
            n: dataclasses.replace(
                each, position=place(each.position), rotation=(*each.rotation[:2], each.rotation[2] + yaw)
            )
            for n, each in spec.boxes.items()
        },
    )


@given(
    arrangement=arrangements(),
    move=st.tuples(st.floats(-2, 2), st.floats(-2, 2), st.floats(-180, 180)),
    held=st.sampled_from([None, "red_box"]),
)
@settings(max_examples=6)
def test_h_is_the_same_when_the_whole_scene_is_elsewhere(
    world: World,
    abstraction: SceneAbstraction,
    arrangement: tuple[dict[str, FloatArray], State],
    move: tuple[float, float, float],
    held: str | None,
) -> None:
    x, y, yaw = move
    c = arrange(world, arrangement[0])
    if held is not None:
        gripping = hold_box(world, held)
        c = Configuration(gripping.q, gripping.fingers, {**c.poses, held: gripping.poses[held]}, held)
    X = RigidTransform(RotationMatrix.MakeZRotation(math.radians(yaw)), [x, y, 0.0])
    poses = {name: to_pose(X @ to_transform(p)) for name, p in c.poses.items()}
    elsewhere = World(_move_scene(world.spec, x, y, yaw))
    assert SceneAbstraction(elsewhere)(Configuration(c.q, c.fingers, poses, c.held)) == abstraction(c)


# knocking things over


def _knock_over(c: Configuration) -> dict[str, Configuration]:
    """Possible result of clumsily picking yellow_box off cyan_box beside red_box."""
    X_WO = to_transform(c.poses["red_box"]).translation()
    tumbled = {
        "red lies": {"red_box": pose(X_WO[0], X_WO[1], 0.025, roll=90.0)},
        "red leans": {"red_box": pose(X_WO[0], X_WO[1], 0.0636, pitch=20.0)},
        "red hangs in the air": {"red_box": pose(X_WO[0], X_WO[1], 0.3)},
        "red is on cyan": {"red_box": pose(0.4, 0.1, 0.07 + 0.059)},
        "cyan lies": {"cyan_box": pose(0.4, 0.1, 0.029, roll=90.0)},
        "red lies on cyan": {"red_box": pose(0.4, 0.1, 0.07 + 0.025, roll=90.0)},
        "red left the table": {"red_box": pose(X_WO[0], X_WO[1], -1.0)},
    }
    return {what: Configuration(c.q, c.fingers, {**c.poses, **poses}, c.held) for what, poses in tumbled.items()}


def test_knocking_things_over_is_never_the_promised_state(world: World, abstraction: SceneAbstraction) -> None:
    tower = {"cyan_box": pose(0.4, 0.1, 0.035), "yellow_box": pose(0.4, 0.1, 0.103)}
    before = abstraction(arrange(world, tower))
    domain = Domain.create(NAMES, ["rack", "table"], before)
    picked = next(a for a, _ in domain.successors(before) if a.name == "pick" and a.args[0] == "yellow_box")
    promised = domain.successor(before, picked)
    gripping = hold_box(world, "yellow_box")
    done = Configuration(gripping.q, gripping.fingers, {**gripping.poses, "cyan_box": tower["cyan_box"]}, "yellow_box")
    assert abstraction(done) == promised
    for what, c in _knock_over(done).items():
        assert abstraction(c) != promised, what
    dropped = {**done.poses, "yellow_box": pose(0.45, 0.3, 0.033)}
    assert abstraction(Configuration(done.q, done.fingers, dropped)) != promised


def test_a_box_that_lies_where_the_goal_wants_it_does_not_reach_the_goal(
    world: World, abstraction: SceneAbstraction
) -> None:
    for roll in (90.0, -90.0):
        c = arrange(world, {"red_box": pose(0.44, -0.33, RACK_TOP + 0.025, roll=roll)})
        assert Atom("on", ("red_box", "rack")) not in abstraction(c)
        assert Atom("lying", ("red_box", "rack")) in abstraction(c)
