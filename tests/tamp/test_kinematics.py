from dataclasses import replace

import pytest

from ictamp_drake.core.types import KinematicsKind
from ictamp_drake.motion.config import KinematicsConfig, MotionConfig
from ictamp_drake.scenes.levels import problem_files
from ictamp_drake.skills.config import SkillsConfig
from ictamp_drake.tamp.method import Method
from ictamp_drake.tamp.solve import solve
from ictamp_drake.tamp.task import load


@pytest.mark.parametrize("kind", ["auto", "closed-form", "analytic", "numeric"])
def test_a_packing_problem_is_solved_with_each_kind_of_inverse_kinematics(kind: KinematicsKind) -> None:
    skills = replace(SkillsConfig(), motion=MotionConfig(kinematics=KinematicsConfig(kind=kind)))
    method = Method(skills=skills, time_limit=250)
    (path,) = problem_files("easy", "0")
    assert solve(load(path, method), method).result.solved
