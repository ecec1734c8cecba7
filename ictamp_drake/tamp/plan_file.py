"""Content of plan.yaml, format 3, which docs/plan_file.md describes field by field."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import yaml

from ictamp_drake.core.files import write_whole
from ictamp_drake.core.types import Attempt, Configuration, Segment
from ictamp_drake.scenes.spec import SceneSpec, to_dict
from ictamp_drake.tamp.plan_origin import Origin
from ictamp_drake.tamp.plan_surroundings import (
    UNITS,
    describe_bodies,
    describe_command,
    describe_configuration,
    describe_contact,
    describe_robot,
)
from ictamp_drake.world.abstraction import SceneAbstraction
from ictamp_drake.world.config import PredicateConfig

FORMAT = 3
"""Format of the written files."""

HEADER = """\
# A plan for a robot arm, found and executed in simulation by ictamp_drake. docs/plan_file.md describes every field.
#
# Units are in `units`: angles are in radians, but yaw and rotation in `scene` are in DEGREES. A pose is a unit
# quaternion w, x, y, z, then a position x, y, z, in the world frame unless its name says otherwise. Execution starts
# from `initial` and not from the positions in `scene`. The arm is at rest at both ends of every segment and may pause
# there as long as it likes, e.g. until the hand has obeyed; without pauses the plan takes the time that `start` tells.
"""


def plan_content(
    spec: SceneSpec,
    c: Configuration,
    attempts: Sequence[Attempt[Configuration]],
    origin: Origin | None,
    abstraction: SceneAbstraction,
) -> dict[str, Any]:
    """Return the content of the file in the types of YAML and JSON.

    Args:
        spec: Scene of the plan.
        c: Initial configuration.
        attempts: Skills with their parameters and motions.
        origin: Origin of the plan; None if unknown.
        abstraction: H of the scene.
    """
    start = describe_configuration(spec, c, abstraction(c))
    return {
        "format": FORMAT,
        "units": dict(UNITS),
        "origin": None if origin is None else asdict(origin),
        "robot": describe_robot(spec, None if origin is None else origin.timing),
        "contact": describe_contact(),
        "bodies": describe_bodies(spec),
        "scene": to_dict(spec),
        "initial": {
            **start,
            "commanded": c.commanded.tolist(),
            "gripper": describe_command(c.gripper),
            "x": None if c.x is None else c.x.tolist(),
        },
        "skeleton": [str(attempt.action) for attempt in attempts],
        "steps": _steps(spec, attempts, abstraction),
    }


def predicates_of(origin: Origin | None) -> PredicateConfig:
    """Return the tolerances of H with which a plan was found; the default ones if its origin is unknown."""
    return PredicateConfig() if origin is None else origin.predicates


def write_content(content: Mapping[str, Any], path: Path) -> None:
    """Write the file, which appears whole or not at all. Numbers are read back exactly."""
    text = yaml.dump(content, Dumper=_Dumper, sort_keys=False, default_flow_style=None, width=120)
    write_whole(path, HEADER + text)


class _Dumper(getattr(yaml, "CSafeDumper", yaml.SafeDumper)):  # type: ignore[misc]
    """Writer of plain values that uses no aliases."""

    def ignore_aliases(self, _: object) -> bool:
        return True


def _steps(
    spec: SceneSpec, attempts: Sequence[Attempt[Configuration]], abstraction: SceneAbstraction
) -> list[dict[str, Any]]:
    steps = []
    start = 0.0
    for attempt in attempts:
        segments = []
        for segment in attempt.motion:
            segments.append(_segment(segment, start))
            start += segment.duration
        k = None if attempt.k is None else attempt.k.tolist()
        end = attempt.successor
        expected = None if end is None else describe_configuration(spec, end, abstraction(end))
        steps.append({"action": str(attempt.action), "k": k, "segments": segments, "expected": expected})
    return steps


def _segment(segment: Segment, start: float) -> dict[str, Any]:
    return {
        "label": segment.label,
        "start": start,
        "duration": float(segment.duration),
        "gripper": describe_command(segment.gripper),
        "order": segment.order,
        "knots": segment.knots.tolist(),
        "control_points": segment.control_points.tolist(),
        "touches": None if segment.touches is None else sorted(segment.touches),
    }
