"""Checks of the files of the models: whether they are there, and whether Drake can read them with their shapes."""

import re
from collections.abc import Iterator
from math import isfinite
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree

from pydrake.multibody.plant import MultibodyPlant
from pydrake.planning import RobotDiagramBuilder

from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.reading import read_text
from ictamp_drake.models.model_text import Shapes
from ictamp_drake.robots.model_files import add_model, find_model
from ictamp_drake.robots.spec import RobotSpec

_READABLE = (".obj", ".vtk", ".gltf")
"""Kinds of meshes that Drake takes for collision."""
_ADVICE = (
    "convert it with python -c \"import trimesh; trimesh.load('x.stl', force='mesh').export('x.obj')\" and name the "
    "new file in the model, or give shapes of the link in {}:"
)
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
    """Find the models of a robot file in a folder.

    Returns:
        Files of the models, None if one of them cannot be read even without its shapes, and the mistakes.
    """
    uris = {"model": spec.model} | ({"gripper.model": spec.gripper.model} if spec.gripper.model else {})
    given = {"model": frozenset(spec.collision), "gripper.model": frozenset(spec.gripper.collision)}
    if len(uris) == 1:
        given["model"] |= given["gripper.model"]
    found: dict[str, Path] = {}
    problems: list[IctampError] = []
    for field, uri in uris.items():
        try:
            path = find_model(uri, folder, field)
            wrong = [*_check_numbers(path, field), *_check_meshes(path, given[field], field)]
            problems += wrong
            if all(each.code == Code.NOT_READABLE for each in wrong):
                add_model(MultibodyPlant(0.0), path, "visible", frozenset(), field)
                found[field] = path
        except IctampError as error:
            problems.append(error)
    if not problems:
        problems += (each for field, path in found.items() for each in _check_readable(path, given[field], field))
    return (Models(found["model"], found.get("gripper.model")) if len(found) == len(uris) else None), problems


def _check_readable(path: Path, given: frozenset[str], field: str) -> Iterator[IctampError]:
    shapes: tuple[Shapes, ...] = ("solid", "visible")
    try:
        for each in shapes:
            add_model(RobotDiagramBuilder(time_step=0.001).plant(), path, each, given, field)
    except IctampError as error:
        yield error


def _read_tree(path: Path) -> ElementTree.Element | None:
    """Return a URDF or SDF file as a tree; None for other kinds, and if it is not XML, which Drake explains."""
    if path.suffix not in (".urdf", ".sdf"):
        return None
    try:
        return ElementTree.fromstring(_PREFIX.sub(r"\1", read_text(path)))
    except ElementTree.ParseError:
        return None


def _check_numbers(path: Path, field: str) -> Iterator[IctampError]:
    """Yield numbers that Drake does not survive."""
    for tag, name, value in _values(_read_tree(path)):
        is_size = (tag in _SIZED and name in _SIZES) or tag == "size"
        if tag not in _ENDLESS and not _is_sound(value, positive=is_size):
            problem = f"expected {'numbers above 0' if is_size else 'finite numbers'} in {tag}, got {{value}}"
            yield IctampError(Code.OUT_OF_RANGE, problem, field=field, value=value)


def _values(root: ElementTree.Element | None) -> Iterator[tuple[str, str, str]]:
    """Yield tag, name and value of all attributes and texts, without repetitions; the name of a text is its tag."""
    elements = () if root is None else root.iter()
    found = ((each.tag, *item) for each in elements for item in (*each.items(), (each.tag, each.text or "")))
    yield from dict.fromkeys(found)


def _is_sound(value: str, *, positive: bool) -> bool:
    """Whether a text is no list of numbers, or one of finite numbers, above 0 if they are lengths."""
    try:
        numbers = [float(word) for word in value.split()]
    except ValueError:
        return True
    return all(isfinite(number) and (number > 0 or not positive) for number in numbers)


def _check_meshes(path: Path, given: frozenset[str], field: str) -> Iterator[IctampError]:
    """Yield each mesh for collision that Drake cannot take, unless the file gives shapes of its link."""
    root = _read_tree(path)
    links = () if root is None else root.iter("link")
    advice = _ADVICE.format("collision" if field == "model" else "gripper.collision")
    for link in (each for each in links if each.get("name") not in given):
        meshes = [mesh for shape in link.iter("collision") for mesh in shape.iter("mesh")]
        for uri in dict.fromkeys((mesh.get("filename") or mesh.findtext("uri") or "").strip() for mesh in meshes):
            name = Path(uri).name
            if Path(uri).suffix.lower() not in _READABLE:
                problem = f"link {link.get('name')}: Drake cannot take {{value}} for collision"
                yield IctampError(Code.NOT_READABLE, problem, field=field, value=name, advice=advice)
                advice = ""  # once is enough
            elif not _is_there(uri, path.parent):
                problem = f"link {link.get('name')}: there is no mesh {{value}}"
                yield IctampError(Code.NOT_FOUND, problem, field=field, value=uri)


def _is_there(uri: str, folder: Path) -> bool:
    """Whether a mesh exists, as far as that is known without looking for packages, which Drake reports itself."""
    scheme, separator, rest = uri.partition("://")
    if not separator:
        return (folder / uri).is_file()
    return scheme != "file" or Path(rest).is_file()
