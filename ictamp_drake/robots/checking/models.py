"""Checks of the files of the models: whether they are there, and whether Drake can read them with their shapes."""

import re
from collections.abc import Iterator, Mapping
from math import isfinite
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree

from pydrake.planning import RobotDiagramBuilder

from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.reading import read_text
from ictamp_drake.robots.model_files import add_model, find_model
from ictamp_drake.robots.spec import RobotSpec

_READABLE = (".obj", ".vtk", ".gltf")
"""Kinds of meshes that Drake takes for collision."""
_SIZED = frozenset({"box", "cylinder", "capsule", "sphere"})
_SIZES = frozenset({"size", "radius", "length"})
"""Shapes and the names of their measures."""
_ENDLESS = frozenset({"limit", "lower", "upper", "velocity", "effort"})
"""Limits, which may be infinite."""
_PREFIX = re.compile(r"(</?|\s)\w+:(?=\w)")
"""Prefix of a name such as drake:mimic, which models use without declaring it."""


class Models(NamedTuple):
    """Files of the models.

    Attributes:
        arm: The arm's.
        gripper: The gripper's; None if the arm's model contains the gripper.
    """

    arm: Path
    gripper: Path | None


def find_models(spec: RobotSpec, folder: Path) -> tuple[Models | None, list[IctampError]]:
    """Find the models of a robot file in a folder; None if one of them cannot be used."""
    uris = {"model": spec.model, "gripper.model": spec.gripper.model}
    found: dict[str, Path] = {}
    problems: list[IctampError] = []
    for field, uri in uris.items():
        if not uri and field == "gripper.model":
            continue
        try:
            found[field] = find_model(uri, folder, field)
        except IctampError as error:
            problems.append(error)
            continue
        given = {**(spec.collision if field == "model" else {}), **spec.gripper.collision}
        problems += list(_check_text(found[field], given, field)) or list(_check_readable(found[field], given, field))
    if problems:
        return None, problems
    return Models(found["model"], found.get("gripper.model")), []


def _check_readable(path: Path, given: Mapping[str, object], field: str) -> Iterator[IctampError]:
    try:
        plant = RobotDiagramBuilder(time_step=0.0).plant()
        add_model(plant, path, "solid", frozenset(given), field)
    except IctampError as error:
        yield error


def _check_text(path: Path, given: Mapping[str, object], field: str) -> Iterator[IctampError]:
    """Yield what Drake would not explain, or not survive, in a URDF or SDF file."""
    if path.suffix not in (".urdf", ".sdf"):
        return
    try:
        root = ElementTree.fromstring(_PREFIX.sub(r"\1", read_text(path)))
    except ElementTree.ParseError:
        return  # Drake, which is not as strict, says what is wrong
    for tag, name, value in _values(root):
        is_size = (tag in _SIZED and name in _SIZES) or tag == "size"
        if tag not in _ENDLESS and not _is_sound(value, positive=is_size):
            problem = f"expected {'numbers above 0' if is_size else 'finite numbers'} in {tag}, got {{value}}"
            yield IctampError(Code.OUT_OF_RANGE, problem, field=field, value=value)
    for link in root.iter("link"):
        if link.get("name") not in given:
            yield from _check_meshes(link, path.parent, field)


def _values(root: ElementTree.Element) -> Iterator[tuple[str, str, str]]:
    """Yield tag, name and value of all attributes and texts, without repetitions; the name of a text is its tag."""
    found = ((each.tag, *item) for each in root.iter() for item in (*each.items(), (each.tag, each.text or "")))
    yield from dict.fromkeys(found)


def _is_sound(value: str, *, positive: bool) -> bool:
    """Whether a text is no list of numbers, or one of finite numbers, above 0 if they are lengths."""
    try:
        numbers = [float(word) for word in value.split()]
    except ValueError:
        return True
    return all(isfinite(number) and (number > 0 or not positive) for number in numbers)


def _check_meshes(link: ElementTree.Element, folder: Path, field: str) -> Iterator[IctampError]:
    """Yield a mistake for each mesh for collision that Drake cannot take."""
    meshes = [mesh for shape in link.iter("collision") for mesh in shape.iter("mesh")]
    for uri in dict.fromkeys((mesh.get("filename") or mesh.findtext("uri") or "").strip() for mesh in meshes):
        kind = Path(uri).suffix.lower()
        if kind not in _READABLE:
            problem = f"link {link.get('name')}: Drake cannot take {{value}} for collision"
            advice = f"{_how_to_convert(uri, kind)}give shapes of the link in {_section(field)}"
            yield IctampError(Code.NOT_READABLE, problem, field=field, value=uri, advice=advice)
        elif not _is_there(uri, folder):
            problem = f"link {link.get('name')}: there is no mesh {{value}}"
            yield IctampError(Code.NOT_FOUND, problem, field=field, value=uri)


def _how_to_convert(uri: str, kind: str) -> str:
    name = Path(uri).name
    if kind not in (".stl", ".dae", ".ply"):
        return ""
    script = f"import trimesh; trimesh.load('{name}', force='mesh').export('{Path(name).stem}.obj')"
    return f'convert it with python -c "{script}" and name the new file in the model, or '


def _section(field: str) -> str:
    return "collision:" if field == "model" else "gripper.collision:"


def _is_there(uri: str, folder: Path) -> bool:
    """Whether a mesh exists, as far as that is known without looking for packages, which Drake reports itself."""
    scheme, separator, rest = uri.partition("://")
    if not separator:
        return (folder / uri).is_file()
    return scheme != "file" or Path(rest).is_file()
