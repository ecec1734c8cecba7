"""The names that authors of parts are promised, and parts of packages that are installed beside this one."""

import os
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import pytest
import yaml

import ictamp_drake as ict
from ictamp_drake import plugins
from ictamp_drake.core.errors import Code
from ictamp_drake.estimators.constant import ConstantConfig
from ictamp_drake.planning.round_robin import RoundRobinConfig
from ictamp_drake.tamp.method import Method
from tests.refusals import refusal
from tests.runs.programs import SCENE, environment

PARTS = """
from dataclasses import dataclass

from ictamp_drake.plugins import SamplerContext


@dataclass(frozen=True)
class Careful:
    restarts: int = 6

    def create(self, context: SamplerContext):
        from ictamp_drake.skills.config import OptimizationConfig

        return OptimizationConfig(restarts=self.restarts).create(context)
"""
POINTS = """
[ictamp_drake.samplers]
careful = own_parts:Careful
broken = own_broken_parts:Sampler

[ictamp_drake.planners]
missing = own_parts:Nothing
"""


@dataclass(frozen=True)
class OwnConfig:
    """A configuration of one's own, of whatever."""

    depth: float = 0.1

    def create(self, _: object) -> object:
        return self


class NoPart:
    """Makes nothing."""


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder in which a package is installed that offers parts."""
    site = tmp_path_factory.mktemp("site")
    (site / "own_parts.py").write_text(PARTS)
    (site / "own_broken_parts.py").write_text("import a_package_that_is_not_there\n")
    about = site / "own_parts-1.0.dist-info"
    about.mkdir()
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: own_parts\nVersion: 1.0\n")
    (about / "entry_points.txt").write_text(POINTS)
    return site


def run(site: Path, folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    variables: Mapping[str, str] = environment()
    path = os.pathsep.join(filter(None, [str(site), variables.get("PYTHONPATH")]))
    return subprocess.run(
        [sys.executable, "-m", *arguments],
        cwd=folder,
        env={**variables, "PYTHONPATH": path},
        capture_output=True,
        text=True,
        check=False,
    )


def test_every_promised_name_is_there() -> None:
    assert {name: getattr(plugins, name) for name in plugins.__all__}.keys() <= set(dir(plugins))
    with pytest.raises(AttributeError):
        _ = plugins.nothing


def test_the_promises_are_made_without_drake_and_torch() -> None:
    code = "import sys, ictamp_drake.plugins; print({'pydrake', 'torch', 'numpy'} & set(sys.modules))"
    assert subprocess.check_output([sys.executable, "-c", code], env=environment(), text=True).strip() == "set()"


def test_a_part_is_an_object_or_a_text_that_names_its_class() -> None:
    name = f"{__name__}:OwnConfig"
    method = Method(sampler=OwnConfig(0.3), planner=name, estimator=f"{name}(depth=0.2)")
    assert method.sampler_config == OwnConfig(0.3)
    assert method.rule_config == OwnConfig()
    assert method.estimator_config == OwnConfig(0.2)
    assert method.decisive["sampler"] == name
    assert method.decisive["samplers"] == {name: {"depth": 0.3}}
    assert method.decisive["planners"] == {name: {"depth": 0.1}}
    assert method.decisive["estimator"] == f"{name}(depth=0.2)"
    assert method.learned == []


def test_a_skill_of_ones_own_decides() -> None:
    method = Method(skills=plugins.SkillsConfig(pick=OwnConfig(0.3)))  # type: ignore[arg-type]
    assert method.decisive["skills"]["pick"] == {"class": f"{__name__}:OwnConfig", "depth": 0.3}
    assert method.decisive["skills"]["place"] == Method().decisive["skills"]["place"]


def test_parts_of_the_package_are_objects_too() -> None:
    method = Method(planner=RoundRobinConfig(), estimator=ConstantConfig(0.5))
    assert method.rule_config == RoundRobinConfig()
    assert method.estimator_config == ConstantConfig(0.5)


@pytest.mark.parametrize(
    ("sampler", "code"),
    [
        ("no_such_module:Sampler", Code.NOT_FOUND),
        (f"{__name__}:Nothing", Code.NOT_FOUND),
        (f"{__name__}:NoPart", Code.WRONG_TYPE),
        (f"{__name__}:OwnConfig(height=1)", Code.UNKNOWN_FIELD),
        (f"{__name__}:OwnConfig(0.3)", Code.NOT_READABLE),
        (f"{__name__}:OwnConfig(depth=print(1))", Code.NOT_READABLE),
        ("uniform(max_height=0.1)", Code.NOT_READABLE),
        ("best", Code.UNKNOWN_CHOICE),
        (NoPart(), Code.WRONG_TYPE),
    ],
)
def test_what_is_not_a_part_is_refused(sampler: object, code: Code) -> None:
    with refusal(code, "sampler"):
        Method(sampler=sampler)  # type: ignore[arg-type]


def test_installed_parts_are_in_the_help_and_broken_ones_are_named_once(installed: Path, tmp_path: Path) -> None:
    done = run(installed, tmp_path, "ictamp_drake.plan", "--help")
    assert done.returncode == 0, done.stderr
    assert "careful" in done.stdout
    assert "broken" not in done.stdout
    lines = done.stderr.splitlines()
    assert [sum(name in line for line in lines) for name in ("broken", "missing")] == [1, 1]
    assert len(lines) == 2


def test_an_installed_part_solves_and_is_recorded(installed: Path, tmp_path: Path) -> None:
    (tmp_path / "scene.yaml").write_text(SCENE)
    options = ("--sampler", "careful(restarts=7)", "--estimator", "constant", "--time-limit", "250")
    done = run(installed, tmp_path, "ictamp_drake.plan", "scene.yaml", "--out", "run", *options)
    assert done.returncode == 0, done.stderr
    config = yaml.safe_load((tmp_path / "run" / "config.yaml").read_text())["options"]
    assert config["sampler"] == "careful(restarts=7)"
    assert config["samplers"] == {"careful(restarts=7)": {"restarts": 7}}
    assert ict.Plan.load(tmp_path / "run" / "scene" / "plan.yaml").actions


def test_an_installed_part_is_compared(installed: Path, tmp_path: Path) -> None:
    (tmp_path / "scene.yaml").write_text(SCENE)
    strategies = ("mine=--sampler careful --estimator constant", "optimization-constant")
    done = run(
        installed, tmp_path, "ictamp_drake.experiments.runner", "--out", "run", "--scenes", "scene.yaml",
        "--regime", "default", "--strategies", *strategies,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert len(done.stderr.splitlines()) == 2, "workers keep quiet about what cannot be imported"
    config = yaml.safe_load((tmp_path / "run" / "config.yaml").read_text())["strategies"]
    assert config["mine"]["samplers"] == {"careful": {"restarts": 6}}
    assert "mine" in done.stdout
