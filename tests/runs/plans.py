"""The plan of the small scene, found once per process."""

from dataclasses import replace
from functools import cache

from ictamp_drake.core.decoding import decode
from ictamp_drake.core.reading import parse
from ictamp_drake.scenes.spec import SceneSpec
from ictamp_drake.tamp.method import SCENE_METHOD
from ictamp_drake.tamp.plan import Plan
from ictamp_drake.tamp.solve import solve
from ictamp_drake.tamp.task import load
from tests.runs.programs import SCENE


@cache
def small_plan() -> Plan:
    """Plan of two skills."""
    method = replace(SCENE_METHOD, time_limit=250)
    plan = solve(load(decode(SceneSpec, parse(SCENE)), method), method).plan
    assert plan is not None
    return plan
