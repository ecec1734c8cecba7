"""Checks of the files of the models: whether they are there, and whether Drake can read them with their shapes."""

import re
from collections.abc import Iterator, Mapping
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
        if not uri:
            continue
        try:
            found[field] = find_model(uri, folder, field)
        except IctampError as error:
            problems.append(error)
            continue
        given = {**(spec.collision if field == "model" else {}), **spec.gripper.collision}
        problems += list(_check_meshes(found[field], given, field)) or list(_check_readable(found[field], given, field))
    if problems:
        return None, problems
    return Models(found["model"], found.get("gripper.model")), []


def _check_readable(path: Path, given: Mapping[str, object], field: str) -> Iterator[IctampError]:
    try:
        plant = RobotDiagramBuilder(time_step=0.0).plant()
        add_model(plant, path, "solid", frozenset(given), field)
    except IctampError as error:
        yield error


def _check_meshes(path: Path, given: Mapping[str, object], field: str) -> Iterator[IctampError]:
    """Yield a mistake for each mesh for collision that Drake cannot take, unless the file gives shapes of its link."""
    if path.suffix not in (".urdf", ".sdf"):
        return
    try:
        root = ElementTree.fromstring(_PREFIX.sub(r"\1", read_text(path)))
    except ElementTree.ParseError:
        return  # Drake, which is not as strict, says what is wrong
    for link in root.iter("link"):
        name = link.get("name", "")
        meshes = [] if name in given else [mesh for shape in link.iter("collision") for mesh in shape.iter("mesh")]
        for uri in dict.fromkeys((mesh.get("filename") or mesh.findtext("uri") or "").strip() for mesh in meshes):
            kind = Path(uri).suffix.lower()
            if kind not in _READABLE:
                problem = f"link {name}: Drake cannot take {{value}} for collision"
                advice = f"{_how_to_convert(uri, kind)}give shapes of the link in {_section(field)}"
                yield IctampError(Code.NOT_READABLE, problem, field=field, value=uri, advice=advice)
            elif not _is_there(uri, path.parent):
                problem = f"link {name}: there is no mesh {{value}}"
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
