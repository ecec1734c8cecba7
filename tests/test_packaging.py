"""The pins hold, and the built wheel is complete: it is installed alone and used far from the checkout."""

import os
import re
import subprocess
import sys
import tomllib
import zipfile
from collections.abc import Iterable, Iterator
from importlib.metadata import distribution, version
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).parents[1]
PACKAGE = ROOT / "ictamp_drake"
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
PIN = re.compile(r"([A-Za-z0-9._-]+)==([0-9A-Za-z.]+)")


def pins() -> dict[str, str]:
    lines = (ROOT / "constraints.txt").read_text().splitlines()
    matches = [(line, PIN.fullmatch(line)) for line in lines]
    assert [line for line, match in matches if match is None] == [], "lines that are not NAME==VERSION"
    return {canonicalize_name(match[1]): match[2] for _, match in matches if match}


def needed_packages(requirements: Iterable[str], seen: set[str]) -> Iterator[str]:
    """Names of the requirements that apply here and of their dependencies, except those that only torch needs."""
    for requirement in map(Requirement, requirements):
        name = canonicalize_name(requirement.name)
        if name in seen or (requirement.marker and not requirement.marker.evaluate({"extra": ""})):
            continue
        seen.add(name)
        yield name
        if name != "torch":
            yield from needed_packages(distribution(name).requires or [], seen)


@pytest.mark.parametrize("group", ["main", "test"])
def test_everything_needed_is_pinned_at_the_version_that_is_installed(group: str) -> None:
    declared = PROJECT["dependencies"] if group == "main" else PROJECT["optional-dependencies"]["test"]
    installed = {name: version(name).partition("+")[0] for name in needed_packages(declared, set())}
    assert {name: pins().get(name) for name in installed} == installed


@pytest.mark.parametrize("name", ["drake", "torch"])
def test_pins_chosen_by_hand(name: str) -> None:
    assert pins()[name] == {"drake": "1.51.1", "torch": "2.13.0"}[name]


def run(*command: str | Path, cwd: Path, **environment: str) -> str:
    done = subprocess.run(
        [sys.executable, *command], cwd=cwd, env=os.environ | environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Wheel that was built from the source distribution."""
    out = tmp_path_factory.mktemp("dist")
    run("-m", "build", "--no-isolation", "--outdir", out, ROOT, cwd=out)
    return next(out.glob("*.whl"))


@pytest.fixture(scope="module")
def site(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder that holds only the installed wheel."""
    site = tmp_path_factory.mktemp("site")
    run("-m", "pip", "install", "--quiet", "--no-deps", "--no-index", "--target", site, wheel, cwd=site)
    return site


@pytest.fixture
def elsewhere(tmp_path: Path, site: Path) -> "Elsewhere":
    return Elsewhere(tmp_path, site)


class Elsewhere:
    """Runs Python in an empty folder, with the installed wheel instead of the checkout."""

    def __init__(self, folder: Path, site: Path) -> None:
        self.folder, self.site = folder, site

    def python(self, *arguments: str) -> str:
        return run(*arguments, cwd=self.folder, PYTHONPATH=str(self.site))


@pytest.mark.wheel
def test_wheel_holds_every_file_of_the_package_and_the_licence(wheel: Path) -> None:
    files = {str(path.relative_to(ROOT)) for path in PACKAGE.rglob("*") if path.is_file() and path.suffix != ".pyc"}
    names = set(zipfile.ZipFile(wheel).namelist())
    assert files - names == set()
    assert {name for name in names if name.startswith("ictamp_drake/")} - files == set()
    assert any(name.endswith("licenses/LICENSE") for name in names)


@pytest.mark.wheel
def test_every_room_can_be_imported(elsewhere: Elsewhere) -> None:
    code = """
import importlib, pkgutil, ictamp_drake
print(ictamp_drake.__file__)
for module in pkgutil.walk_packages(ictamp_drake.__path__, "ictamp_drake."):
    if not module.name.endswith("__main__"):
        importlib.import_module(module.name)
"""
    assert Path(elsewhere.python("-c", code).strip()) == elsewhere.site / "ictamp_drake" / "__init__.py"


@pytest.mark.wheel
def test_models_are_found(elsewhere: Elsewhere) -> None:
    code = """
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant
from ictamp_drake.models.package import PACKAGE_FILE, add_package
for path in PACKAGE_FILE.parent.rglob("*.sdf"):
    plant = MultibodyPlant(0.001)
    parser = Parser(plant)
    add_package(parser)
    parser.AddModels(str(path))
    print(path.name)
"""
    assert set(elsewhere.python("-c", code).split()) == {path.name for path in PACKAGE.rglob("*.sdf")}


@pytest.mark.wheel
def test_problems_are_found(elsewhere: Elsewhere) -> None:
    code = """
from ictamp_drake.scenes.levels import problem_files
from ictamp_drake.scenes.spec import load_scene
for level in ("easy", "medium", "hard", "extreme", "varied"):
    print(len([load_scene(path) for path in problem_files(level)]))
"""
    assert elsewhere.python("-c", code).split() == ["55", "37", "17", "30", "40"]


@pytest.mark.wheel
@pytest.mark.parametrize(
    "program",
    [
        "experiments.packing",
        "experiments.collect",
        "experiments.train_skill",
        "experiments.train_estimator",
        "plan",
        "scenes.packing",
    ],
)
def test_programs_start(elsewhere: Elsewhere, program: str) -> None:
    assert "usage:" in elsewhere.python("-m", f"ictamp_drake.{program}", "--help")
