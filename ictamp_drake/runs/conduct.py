"""Options of a run, shared by all programs that solve problems."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import tyro

from ictamp_drake.core.checks import check_range
from ictamp_drake.runs.engine import EngineConfig


@dataclass(frozen=True)
class Conduct:
    """Options of a run. They do not affect the way in which its problems are solved.

    Attributes:
        out: Folder for the results of the run. By default a new one in runs/, named after the program and the time. The
            folder of an unfinished run is continued.
        resume: Continue the run in --out, or by default the latest run of this program in runs/.
        artefacts: Files to keep for each problem: all of them (all), only scene.yaml and plan.yaml (plan), or only the
            record (none).
        meshcat: Show the planning live in a browser on this machine, with a single worker.
        grace: Extra time after the time limit of a problem to finish a step, verify the plan and write the results,
            before its process is ended [s].
        engine: Processes that solve problems, each one problem at a time.
    """

    out: Path | None = None
    resume: bool = False
    artefacts: Literal["all", "plan", "none"] = "all"
    meshcat: bool = False
    grace: float = 120.0
    engine: Annotated[EngineConfig, tyro.conf.arg(name="")] = EngineConfig()

    def __post_init__(self) -> None:
        check_range("grace", self.grace, 0, 1e6, " s")
        if self.meshcat:
            object.__setattr__(self, "engine", EngineConfig(workers=1))
