"""A small arm of boxes with two fingers, as files: an example that is quick to load, to be spoiled by tests."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import yaml

HEIGHT = {"waist": 0.1, "shoulder": 0.2, "elbow": 0.3, "turn": 0.15, "bend": 0.15, "wrist": 0.08}
"""Joints with their distances from the joints before them, along the stretched arm [m]."""
AXES = {"waist": "0 0 1", "shoulder": "0 1 0", "elbow": "0 1 0", "turn": "0 0 1", "bend": "0 1 0", "wrist": "0 0 1"}
LENGTHS = (0.12, 0.22, 0.08, 0.08, 0.03, 0.03)
"""Lengths of the links behind the joints [m]."""


def link(name: str, size: Sequence[float], z: float = 0.0, mass: float = 0.5) -> str:
    """A box as a link, with its center at a height in its frame [m]."""
    x, y, height = size
    box = f'<origin xyz="0 0 {z}"/><geometry><box size="{x} {y} {height}"/></geometry>'
    inertia = f'<mass value="{mass}"/><inertia ixx="0.002" iyy="0.002" izz="0.002" ixy="0" ixz="0" iyz="0"/>'
    inertial = f'<inertial><origin xyz="0 0 {z}"/>{inertia}</inertial>'
    return f'<link name="{name}">{inertial}<visual>{box}</visual><collision>{box}</collision></link>\n'


def joint(name: str, links: tuple[str, str], origin: str, axis: str, *, limit: str, kind: str = "revolute") -> str:
    """A joint between two links."""
    parent, child = links
    ends = f'<parent link="{parent}"/><child link="{child}"/><origin xyz="{origin}"/><axis xyz="{axis}"/>'
    return f'<joint name="{name}" type="{kind}">{ends}<limit {limit}/></joint>\n'


def urdf() -> str:
    """The model: six joints, and a hand whose fingers move along y."""
    text, parent = link("base", (0.12, 0.12, 0.08), 0.04), "base"
    for (name, height), length in zip(HEIGHT.items(), LENGTHS, strict=True):
        text += link(f"{name}_link", (0.05, 0.05, length), length / 2)
        limit = 'lower="-2.9" upper="2.9" velocity="2" effort="80"'
        text += joint(name, (parent, f"{name}_link"), f"0 0 {height}", AXES[name], limit=limit)
        parent = f"{name}_link"
    text += link("hand", (0.06, 0.16, 0.04), 0.02)
    text += '<joint name="mount" type="fixed"><parent link="wrist_link"/><child link="hand"/>'
    text += '<origin xyz="0 0 0.03"/></joint>'
    for name, sign in (("left", 1), ("right", -1)):
        text += link(f"{name}_finger", (0.02, 0.012, 0.06), 0.03, 0.05)
        limit = 'lower="0" upper="0.04" velocity="0.2" effort="60"'
        origin, axis = f"0 {0.006 * sign} 0.045", f"0 {sign} 0"
        text += joint(f"{name}_joint", ("hand", f"{name}_finger"), origin, axis, limit=limit, kind="prismatic")
    return f'<robot name="small">\n{text}</robot>\n'


def mjcf() -> str:
    """The same robot in MJCF, which has no limits of velocity, nor of effort without actuators."""

    def body(name: str, z: float, size: Sequence[float], middle: float, joint: str = "") -> str:
        x, y, height = size
        shape = f'<geom type="box" size="{x / 2} {y / 2} {height / 2}" pos="0 0 {middle}" mass="0.5"/>'
        return f'<body name="{name}" pos="0 0 {z}">{joint}{shape}'

    text = body("base", 0.0, (0.12, 0.12, 0.08), 0.04)
    for (name, height), length in zip(HEIGHT.items(), LENGTHS, strict=True):
        hinge = f'<joint name="{name}" type="hinge" axis="{AXES[name]}" limited="true" range="-2.9 2.9"/>'
        text += body(f"{name}_link", height, (0.05, 0.05, length), length / 2, hinge)
    text += body("hand", 0.03, (0.06, 0.16, 0.04), 0.02)
    for name, sign in (("left", 1), ("right", -1)):
        slide = f'<joint name="{name}_joint" type="slide" axis="0 {sign} 0" limited="true" range="0 0.04"/>'
        finger = body(f"{name}_finger", 0.045, (0.02, 0.012, 0.06), 0.03, slide)
        text += finger.replace('pos="0 0', f'pos="0 {0.006 * sign}', 1) + "</body>"
    text += "</body>" * (len(HEIGHT) + 2)
    compiler = '<compiler angle="radian"/>'
    return f'<mujoco model="small">{compiler}<worldbody>{text}</worldbody></mujoco>'


def content() -> dict[str, Any]:
    """Content of the robot file."""
    pads = {
        "first": {"frame": "left_finger", "position": [0, -0.006, 0.05]},
        "second": {"frame": "right_finger", "position": [0, 0.006, 0.05], "rotation": [0, 0, 180]},
        "size": [0.02, 0.012, 0.02],
    }
    gripper = {
        "base": "hand",
        "grasp": {"frame": "hand", "position": [0, 0, 0.095]},
        "joints": ["left_joint", "right_joint"],
        "opening": 0.08,
        "force": 40,
        "speed": 0.05,
        "pads": pads,
    }
    return {
        "description": "small arm of boxes",
        "model": "small.urdf",
        "base": "base",
        "flange": "wrist_link",
        "joints": list(HEIGHT),
        "home": [0.0, 0.0, 1.6, 0.0, 1.5415926535897931, 0.0],
        "acceleration": [10],
        "jerk": 1000,
        "stiffness": [2000],
        "damping": [100],
        "gripper": gripper,
    }


def write(folder: Path, changed: dict[str, Any] | None = None, model: str | None = None) -> Path:
    """Write the files of the robot, or of one with another content or model, and return the robot file."""
    (folder / "small.urdf").write_text(model or urdf(), encoding="utf-8")
    file = folder / "small.yaml"
    file.write_text(yaml.safe_dump(changed or content(), sort_keys=False), encoding="utf-8")
    return file


def write_coupled(folder: Path) -> Path:
    """Write the files of the robot with one driven finger, which the other one follows; see `write`."""
    model, changed = urdf(), content()
    start = model.index('<joint name="right_joint"')
    mimic = '<mimic joint="left_joint" multiplier="1" offset="0"/></joint>'
    changed["gripper"]["joints"] = ["left_joint"]
    return write(folder, changed, model[:start] + model[start:].replace("</joint>", mimic, 1))
