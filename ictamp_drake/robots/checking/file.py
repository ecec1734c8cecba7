"""All mistakes in the text of a robot file, not only the first one."""

import re
from typing import Any

from ictamp_drake.core.decoding import decode, mapping
from ictamp_drake.core.errors import IctampError
from ictamp_drake.core.reading import parse
from ictamp_drake.robots.spec import RobotSpec

_MOST = 100
"""Maximum number of mistakes that are looked for."""


def decode_all(text: str) -> tuple[RobotSpec | None, list[IctampError]]:
    """Decode a robot file, and after each mistake go on with a valid value in its place.

    Returns:
        Content of the file, None if there are mistakes, and the mistakes.
    """
    problems: list[IctampError] = []
    try:
        raw = dict(mapping(parse(text)))
    except IctampError as error:
        return None, [error]
    while len(problems) < _MOST:
        try:
            spec = decode(RobotSpec, raw)
        except IctampError as error:
            problems.append(error)
            if not _mend(raw, error):
                break
        else:
            return (None if problems else spec), problems
    return None, problems


def _mend(raw: dict[str, Any], error: IctampError) -> bool:
    """Replace what is wrong by something valid, or leave it out, and return whether that was possible."""
    path = re.findall(r"[^.\[\]]+", error.where.field)
    place, valid = raw, _valid(raw)
    for key in path[:-1]:
        if not isinstance(valid.get(key), dict) or not isinstance(place.get(key), dict):
            path = [key]
            break
        place, valid = place[key], valid[key]
    if path and path[-1] in valid:
        place[path[-1]] = valid[path[-1]]
        return True
    return bool(path) and place.pop(path[-1], None) is not None


def _valid(raw: dict[str, Any]) -> dict[str, Any]:
    """Return valid values of all required fields, for as many joints as the file seems to have."""
    count = next((len(raw[name]) for name in ("joints", "home") if isinstance(raw.get(name), list)), 1) or 1
    frame = {"frame": "body"}
    pads = {"first": frame, "second": frame, "size": [0.02, 0.02, 0.02]}
    gripper = {"base": "body", "grasp": frame, "joints": ["joint"], "opening": 0.05, "force": 10, "speed": 0.1}
    return {
        "model": "model.urdf",
        "base": "body",
        "flange": "body",
        "joints": [f"joint {number}" for number in range(count)],
        "home": [0] * count,
        "stiffness": [1],
        "damping": [1],
        "gripper": gripper | {"mount": frame, "pads": pads},
    }
