"""The sentences of errors, all in `wording.yml`, with at least one for each code.

No other test asserts on a sentence. After a change of words, run `pytest tests/core/test_wording.py --force-regen`,
read the new file, and commit it.
"""

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest
import yaml
from pytest_regressions.file_regression import FileRegressionFixture

from ictamp_drake.core.checks import FINITE, POSITIVE, check_count, check_different, check_interval, check_range
from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.files import make_folder, read_json
from ictamp_drake.estimators.q_value import QValueConfig
from ictamp_drake.experiments.strategies import methods
from ictamp_drake.learning.batches import split
from ictamp_drake.learning.checkpoint import load as load_checkpoint
from ictamp_drake.learning.dataset import load as load_attempts
from ictamp_drake.learning.dataset import write
from ictamp_drake.planning.estimates import ask_estimator
from ictamp_drake.reports.regime import read_regime
from ictamp_drake.runs.conduct import Conduct
from ictamp_drake.runs.folder import open_run_folder
from ictamp_drake.runs.records import read_records
from ictamp_drake.scenes.levels import parse_selection
from ictamp_drake.scenes.spec import load_scene
from ictamp_drake.symbolic.domain import Domain
from ictamp_drake.symbolic.pddl import read_domain
from ictamp_drake.tamp.method import Method
from ictamp_drake.tamp.plan import read_plan
from ictamp_drake.tamp.task import load
from tests.core.test_reading import GOOD

WITHOUT_EXAMPLE = {Code.NOT_INSTALLED, Code.NOT_REACHABLE}
"""These need Ray, or that it is not there."""

RED_BOX, BLUE_BOX = GOOD.splitlines()[5], "  blue_box: {size: [0.05, 0.05, 0.1], position: [0.5, -0.1, 0.05]}"
PLAN = (Path(__file__).parents[1] / "tamp" / "cases" / "plan.yaml").read_text(encoding="utf-8")
RUN = {"program": "packing", "options": {"seed": 0}}


def load_changed(changes: Sequence[tuple[str, str]]) -> None:
    """Load the scene `GOOD` with changes, from a file in the working directory."""
    text = GOOD
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    load(write_file("scene.yaml", text))


def write_file(name: str, content: bytes | str) -> Path:
    """Write a file in the working directory."""
    path = Path(name)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return path


def open_run(work: dict[str, object], conduct: Conduct) -> None:
    """Start or continue a run, and leave it."""
    with open_run_folder("packing", work, conduct):
        pass


def refuse_other_options() -> None:
    open_run(RUN, Conduct(out=Path("out")))
    open_run({**RUN, "options": {"seed": 3}}, Conduct(out=Path("out")))


def refuse_a_folder_in_use() -> None:
    with open_run_folder("packing", RUN, Conduct(out=Path("out"))):
        open_run(RUN, Conduct(out=Path("out")))


def refuse_no_attempts() -> None:
    Path("data").mkdir()
    write([], Path("data/none.parquet"))
    split(load_attempts(Path("data")))


def refuse_a_missing_column() -> None:
    Path("data").mkdir()
    write([], Path("data/none.parquet"))
    pq.write_table(pq.read_table("data/none.parquet").drop_columns(["k"]), "data/none.parquet")
    load_attempts(Path("data"))


def read_changed(change: tuple[str, str]) -> None:
    """Read a plan with a change, from a file in the working directory."""
    assert change[0] in PLAN
    read_plan(write_file("plan.yaml", PLAN.replace(*change, 1)))


class Certain:
    """An estimator with a P above 1."""

    def estimate(self, options: Sequence[object]) -> list[float]:
        return [1.7 for _ in options]


SCENES: dict[str, list[tuple[str, str]]] = {
    "an unknown field": [("mass: 0.1", "mas: 0.1")],
    "a missing field": [("kind: rack, ", "")],
    "a number that is text": [("mass: 0.1", "mass: heavy")],
    "two numbers of three": [("[0.05, 0.05, 0.118]", "[1, 2]")],
    "a number out of range": [("mass: 0.1", "mass: 100")],
    "numbers out of range": [("[0.8, 0.1, 0.1]", "[255, 0, 0]")],
    "an unknown choice": [("kind: rack", "kind: shelf")],
    "a key twice": [("mass: 0.1", "mass: 0.1, mass: 0.2")],
    "a name twice": [("  red_box:", "  Rack:")],
    "a name that is a word of PDDL": [("  red_box:", "  and:")],
    "a name of the robot": [("  red_box:", "  robot:")],
    "a name with a space": [("  red_box:", "  red box:")],
    "a name that YAML takes for a truth value": [("  red_box:", "  on:")],
    "no boxes": [(RED_BOX, "  {}")],
    "no goal": [("(on red_box rack)", "''")],
    "a box that is too heavy": [("mass: 0.1, friction: 0.6", "mass: 3, friction: 0.2")],
    "a box that is too wide": [("[0.05, 0.05, 0.118]", "[0.09, 0.08, 0.05]")],
    "brackets that are open": [("seed: 0", "seed: [0")],
    "a tag that is wrong": [("seed: 0", "seed: !!int abc")],
    "a goal with an unknown object": [("(on red_box rack)", "(on red_box shelf)")],
    "a goal with an unknown predicate": [("(on red_box rack)", "(free red_box)")],
    "a goal with one object": [("(on red_box rack)", "(on red_box)")],
    "a goal without brackets": [("(on red_box rack)", "on red_box rack")],
    "a goal with a construct that is not served": [("(on red_box rack)", "(preference (on red_box rack))")],
    "a goal with an effect in it": [("(on red_box rack)", "(when (clear red_box) (on red_box rack))")],
    "a goal whose alternatives all contradict themselves": [
        ("(on red_box rack)", "(or (on red_box red_box) (and (clear red_box) (in-hand red_box)))")
    ],
    "a goal that is false": [("(on red_box rack)", "(exists (?x - box) (and (not (= ?x red_box)) (on ?x rack)))")],
    "a region on nothing": [("goal", "regions: {near: {on: shelf, size: [0.1, 0.1]}}\ngoal")],
    "a region that is too wide": [("goal", "regions: {near: {on: rack, size: [0.1, 0.5]}}\ngoal")],
    "regions that overlap": [
        ("goal", "regions: {a: {on: rack, size: [0.1, 0.1]}}\nposes: {b: {on: rack, position: [0, 0.05]}}\ngoal")
    ],
    "a pose for two boxes": [
        ("(on red_box rack)", "(exists (?x - box) (and (at ?x b) (at blue_box b) (not (= ?x blue_box))))"),
        ("goal", "  cyan_box: {size: [0.05, 0.05, 0.05], position: [0.6, 0.1, 0.025]}\ngoal"),
        ("goal", f"{BLUE_BOX}\nposes: {{b: {{on: rack, position: [0, 0]}}}}\ngoal"),
    ],
    "a goal that contradicts itself": [("(on red_box rack)", "(and (on red_box rack) (on red_box table))")],
    "a goal that moves a support": [("(on red_box rack)", "(on rack table)")],
    "a goal that stands a box up": [
        ("position: [0.5, 0.1, 0.059]", "position: [0.5, 0.1, 0.025], rotation: [90, 0, 0]")
    ],
    "a number of many digits": [("seed: 0", f"seed: {'9' * 5000}")],
    "a number beyond all numbers": [("yaw: 90", f"yaw: 1{'0' * 310}")],
    "a seed that is too large": [("seed: 0", f"seed: {2**63}")],
    "a name that is too long": [("  red_box:", f"  {'x' * 200}:")],
    "a field that is too long": [("seed: 0", f"{'x' * 200}: 0")],
    "too many boxes": [(RED_BOX, "\n".join(RED_BOX.replace("red_box", f"b{number}") for number in range(51)))],
    "boxes in each other": [(RED_BOX, f"{RED_BOX}\n{BLUE_BOX.replace('-0.1', '0.13')}")],
    "a box in the air": [("[0.5, 0.1, 0.059]", "[0.5, 0.1, 0.2]")],
    "a box beyond an edge": [("[0.5, 0.1, 0.059]", "[0.5, 0.452, 0.059]")],
    "a box that leans": [("[0.5, 0.1, 0.059]", "[0.5, 0.1, 0.063], rotation: [12, 0, 0]")],
    "a box beside everything": [("[0.5, 0.1, 0.059]", "[0.5, 1.1, 0.059]")],
    "a box that nobody holds": [("seed: 0", "start: {held: red_box}")],
    "joints beyond their limits": [("seed: 0", "start: {joints: [0, 0, 0, 1, 0, 0, 0]}")],
    "too few joints": [("seed: 0", "start: {joints: [0, 0]}")],
    "a tower that falls": [
        (RED_BOX, f"{RED_BOX}\n{BLUE_BOX.replace('[0.5, -0.1, 0.05]', '[0.524, 0.1, 0.168]')}"),
        ("goal", "  cyan_box: {size: [0.05, 0.05, 0.05], position: [0.548, 0.1, 0.243], mass: 2}\ngoal"),
    ],
}
PLANS: dict[str, tuple[str, str]] = {
    "a plan whose joints are beyond their limits": ("  q: [0.0, -0.78", "  q: [0.0, -9.78"),
    "a plan whose quaternion is none": ("    red_box: [1.0, 0.0", "    red_box: [1.0, 1.0"),
    "a plan without a box": ("    blue_box: [1.0", "    green_box: [1.0"),
    "a plan of another state of the simulator": ("  x: [0.0,", "  x: [0.1,"),
    "a plan with an unknown action": ("action: pick(red_box", "action: grab(red_box"),
    "a plan with an impossible action": ("action: pick(red_box, table", "action: pick(red_box, rack"),
    "a plan with other actions in its skeleton": ("skeleton: ['pick(red_box", "skeleton: ['pick(blue_box"),
    "a plan with a spline of another order": ("    order: 5", "    order: 6"),
    "a plan with a spline of no order": ("    order: 5", "    order: 0"),
    "a plan with a duration that its knots do not have": ("    duration: ", "    duration: 1"),
    "a plan that grips too hard": ("force: 0.0", "force: 700.0"),
    "a plan with another pad": ("friction: {pads: 1.0", "friction: {pads: 0.1"),
}
EXAMPLES: dict[str, Callable[[], object]] = {
    "an option out of range": lambda: check_range("planners.els.floor", 2.0, POSITIVE, 1),
    "an option that is infinite": lambda: check_range("planners.adaptive.beliefs.effort", np.inf, POSITIVE, FINITE),
    "an option that is negative": lambda: check_range("planners.els.p-w", -1.0, 0, np.inf),
    "an interval that is the wrong way round": lambda: check_interval("samplers.uniform.yaw", (2.0, 1.0), -10, 10),
    "too few values": lambda: check_count("seeds", (), 1, 1000),
    "a value twice": lambda: check_different("seeds", (3, 3)),
    "options that contradict each other": lambda: QValueConfig(refinements=1),
    "a selection that is none": lambda: parse_selection("a:b", 17),
    "a selection of nothing": lambda: parse_selection("40:", 17, of=" of hard"),
    "a scene that is not there": lambda: load_scene("nowhere.yaml"),
    "a scene in another encoding": lambda: load_scene(write_file("scene.yaml", b"\xff\xfe\x00")),
    "a scene of brackets": lambda: load_scene(write_file("scene.yaml", "[" * 1000)),
    "aliases of aliases": lambda: load_scene(
        write_file("scene.yaml", "\n".join(["a0: &a0 x", *(f"a{n}: &a{n} [{f'*a{n - 1},' * 9}]" for n in range(1, 9))]))
    ),
    "a plan of another format": lambda: read_plan(write_file("plan.yaml", "format: 9")),
    "a folder below a file": lambda: make_folder(write_file("file", "") / "out"),
    "a line that is not JSON": lambda: read_records(write_file("results.jsonl", "no json\n")),
    "a record with a wrong value": lambda: read_records(write_file("results.jsonl", '{"problem": 3}\n')),
    "a list for an object": lambda: read_json(write_file("tree.json", "[1]")),
    "a checkpoint that is not there": lambda: load_checkpoint(Path("networks"), "policy", "pick"),
    "a checkpoint that is damaged": lambda: load_checkpoint(
        write_file("networks/pick_policy.safetensors", "x").parent, "policy", "pick"
    ),
    "attempts that are not there": lambda: load_attempts(Path("nowhere")),
    "too few attempts": refuse_no_attempts,
    "attempts that are no Parquet": lambda: load_attempts(
        write_file("data/a.parquet", b"version https://git-lfs").parent
    ),
    "attempts without a column": refuse_a_missing_column,
    "a seed in a strategy": lambda: methods("paper", ["mine=--seed 5"], [0]),
    "a folder of something else": lambda: open_run(RUN, Conduct(out=write_file("thesis/thesis.tex", "").parent)),
    "no run to resume": lambda: open_run(RUN, Conduct(out=Path("out"), resume=True)),
    "other options": refuse_other_options,
    "a folder in use": refuse_a_folder_in_use,
    "a folder without records": lambda: read_regime(Path("runs/nowhere")),
    "an estimator that is wrong": lambda: ask_estimator(Certain(), [(None, None)]),  # type: ignore[list-item]
    "a state without a place": lambda: Domain.create(("red",), ("table",), frozenset()),
    "a domain that is wrong": lambda: read_domain("(define (domain d)\n(:action a :precondition dark))", "d.pddl"),
    "an unknown option": lambda: Method(planner="best"),
}


def caught(act: Callable[[], object]) -> IctampError:
    """Error that an example raises."""
    with pytest.raises(IctampError) as error:
        act()
    return error.value


def test_the_wording_of_all_errors(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, file_regression: FileRegressionFixture
) -> None:
    scenes = {name: partial(load_changed, changes) for name, changes in SCENES.items()}
    plans = {name: partial(read_changed, change) for name, change in PLANS.items()}
    wording: dict[str, dict[str, str]] = {}
    for number, (name, act) in enumerate({**scenes, **plans, **EXAMPLES}.items()):
        folder = tmp_path / str(number)
        folder.mkdir()
        monkeypatch.chdir(folder)
        error = caught(act)
        wording.setdefault(str(error.code), {})[name] = str(error)
    assert {Code(code) for code in wording} == set(Code) - WITHOUT_EXAMPLE
    text = yaml.safe_dump(dict(sorted(wording.items())), sort_keys=False, width=10_000)
    file_regression.check(text, fullpath=Path(__file__).with_name("wording.yml"), encoding="utf-8")
