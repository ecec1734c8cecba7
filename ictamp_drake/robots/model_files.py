"""Model files of robots: found by path or package, and read with some of their shapes left out."""

import importlib.util
import re
from collections.abc import Iterator, Mapping
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

from pydrake.multibody.parsing import PackageMap, Parser
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import ModelInstanceIndex, WeldJoint

from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.models.model_text import Shapes, keep_shapes
from ictamp_drake.models.package import PACKAGE_FILE, add_package
from ictamp_drake.robots.files import read_once

_PACKAGE = re.compile(r"package://([^/\"<\s]+)")
_URI = re.compile(r"""(filename=["']|<uri>\s*)(?!\w+://)([^"'<]*[^"'<\s])""")
_MIMIC = re.compile(r"<(?:drake:)?mimic\b[^>]*/>")
_TEXTS = {".sdf": "sdf", ".urdf": "urdf"}
"""Formats whose shapes are left out by changing the text; in an MJCF file they stay."""
_MIMIC_DEFAULTS = (("multiplier", "1"), ("offset", "0"))


class Mimic(NamedTuple):
    """A joint that follows another one: position = multiplier * leader + offset."""

    leader: str
    multiplier: float
    offset: float


def find_model(uri: str, folder: Path, field: str) -> Path:
    """Return the file of a model.

    Args:
        uri: Path relative to the folder, or package://NAME/….
        folder: Folder of the robot file.
        field: Field of the robot file, for errors.

    Raises:
        IctampError: There is no such file or package.
    """
    if uri.startswith("package://"):
        packages = PackageMap()
        packages.AddPackageXml(filename=PACKAGE_FILE)
        _add_installed(packages, uri, field)
        try:
            path = Path(packages.ResolveUrl(uri))
        except RuntimeError as error:
            problem = f"{{value}} cannot be found: {str(error).partition(chr(10))[0]}"
            raise IctampError(Code.NOT_FOUND, problem, field=field, value=uri) from error
    else:
        path = folder / uri
    if not path.is_file():
        raise IctampError(Code.NOT_FOUND, "there is no file {value}", field=field, value=uri)
    return path.resolve()


def _add_installed(packages: PackageMap, text: str, field: str) -> None:
    """Add the installed Python packages that a text names, unless Drake knows a package of that name."""
    for name in sorted(_list_packages(text)):
        if packages.Contains(name):
            continue
        found = importlib.util.find_spec(name) if name.isidentifier() else None
        if found is None or not found.submodule_search_locations:
            advice = f"run pip install {name.replace('_', '-')}"
            problem = "there is no package {value}"
            raise IctampError(Code.NOT_INSTALLED, problem, field=field, value=name, advice=advice)
        packages.Add(name, str(found.submodule_search_locations[0]))


@lru_cache(maxsize=64)
def _list_packages(text: str) -> frozenset[str]:
    return frozenset(_PACKAGE.findall(text))


def add_model(
    plant: MultibodyPlant, path: Path, shapes: Shapes, without: frozenset[str], field: str
) -> ModelInstanceIndex:
    """Add the model of a file to a plant that is not finalized.

    Args:
        plant: Plant.
        path: SDF, URDF or MJCF file.
        shapes: Shapes that the bodies get.
        without: Names of links whose collision shapes are left out.
        field: Field of the robot file, for errors.

    Raises:
        IctampError: Drake cannot read the file.
    """
    parser = Parser(plant, "robot")  # no box can have the name of its models
    add_package(parser)
    parser.SetAutoRenaming(True)
    kind = _TEXTS.get(path.suffix)
    text = read_once(path)
    if kind:
        text = _prepare(text, path.parent, shapes, without)
    if not plant.time_step():
        text = _leave_out_mimics(text)
    _add_installed(parser.package_map(), text, field)
    try:
        instances = parser.AddModelsFromString(text, kind) if kind else parser.AddModels(path)
    except (RuntimeError, ValueError) as error:
        problem = f"Drake cannot read {{value}}: {str(error).strip().partition(chr(10))[0]}"
        raise IctampError(Code.NOT_READABLE, problem, field=field, value=path.name) from error
    if len(instances) != 1:
        problem = f"expected one model in {{value}}, got {len(instances)}"
        raise IctampError(Code.WRONG_LENGTH, problem, field=field, value=path.name)
    _release(plant, instances[0], path, field)
    return instances[0]


def _release(plant: MultibodyPlant, instance: ModelInstanceIndex, path: Path, field: str) -> None:
    """Remove what fixes a model to the world, as all models in MJCF and some in URDF are: the scene says where it is.

    Raises:
        IctampError: Drake removes no joints beside the constraints of the model.
    """
    for joint in map(plant.get_joint, plant.GetJointIndices(instance)):
        if isinstance(joint, WeldJoint) and joint.parent_body() == plant.world_body():
            try:
                plant.RemoveJoint(joint)
            except RuntimeError as error:
                problem = "expected a model that is not fixed to the world, got {value}"
                raise IctampError(Code.CONFLICT, problem, field=field, value=path.name) from error


@lru_cache(maxsize=32)
def _prepare(text: str, folder: Path, shapes: Shapes, without: frozenset[str]) -> str:
    """Return a model of a folder with absolute paths and some shapes: Drake parses a file 0.03 s slower than a text."""
    for link in without:
        text = re.sub(_block_of(link), lambda found: keep_shapes(found[0], "visible"), text, flags=re.DOTALL)
    text = _URI.sub(lambda found: f"{found[1]}file://{(folder / found[2]).resolve()}", text)
    return keep_shapes(text, shapes)


@lru_cache(maxsize=32)
def _leave_out_mimics(text: str) -> str:
    """Return a model for a continuous plant, which has no constraints; Drake would warn of each."""
    return _MIMIC.sub("", text)


def brings_pad(path: Path, link: str) -> bool:
    """Whether a link of an SDF or URDF file has a collision shape with the name pad."""
    return _brings_pad(read_once(path), link)


@lru_cache(maxsize=32)
def _brings_pad(text: str, link: str) -> bool:
    return 'collision name="pad"' in "".join(re.findall(_block_of(link), text, re.DOTALL))


def _block_of(link: str) -> str:
    return rf'<link\s[^>]*name="{re.escape(link)}".*?</link>'


def read_mimics(path: Path) -> Mapping[str, Mimic]:
    """Return the joints of an SDF or URDF file that follow others, by name.

    Raises:
        IctampError: A multiplier or an offset is not a number.
    """
    found = {}
    for name, block in _joints_of(path):
        if mimic := re.search(r"<(?:drake:)?mimic\b.*", block, re.DOTALL):
            values = dict(re.findall(r'(joint|multiplier|offset)\s*(?:="|>)\s*([^"<]+)', mimic[0]))
            if "joint" in values:
                multiplier, offset = (_to_number(values.get(key, default), path) for key, default in _MIMIC_DEFAULTS)
                found[name] = Mimic(values["joint"], multiplier, offset)
    return found


def read_efforts(path: Path) -> Mapping[str, float]:
    """Return the limits of effort of a URDF file by joint. Drake takes only those of joints with a transmission."""
    if path.suffix != ".urdf":
        return {}
    found = ((name, re.search(r'<limit\b[^>]*\beffort="([^"]+)"', block)) for name, block in _joints_of(path))
    efforts = {name: _to_number(limit[1], path) for name, limit in found if limit}
    return {name: effort for name, effort in efforts.items() if effort > 0}


def _joints_of(path: Path) -> Iterator[tuple[str, str]]:
    """Yield names and texts of the joints of an SDF or URDF file."""
    text = re.sub(r"<!--.*?-->", "", read_once(path), flags=re.DOTALL)
    for block in re.findall(r"<joint\s.*?</joint>", text, re.DOTALL):
        if name := re.search(r'name="([^"]+)"', block):
            yield name[1], block


def _to_number(text: str, path: Path) -> float:
    try:
        return float(text)
    except ValueError as error:
        problem = f"expected a number in {path.name}, got {{value}}"
        raise IctampError(Code.NOT_READABLE, problem, field="model", value=text) from error
