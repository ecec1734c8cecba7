"""How a run is carried out: options of all programs that solve problems."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import tyro

from ictamp_drake.core.checks import check_range
from ictamp_drake.runs.engine import EngineConfig


@dataclass(frozen=True)
class Conduct:
    """How a run is carried out, which changes nothing in how its problems are solved.

    Attributes:
        out: folder for what the run leaves; by default a new one in runs/, named by program and time. Naming the
            folder of an unfinished run continues it.
        resume: continue a run, without --out the latest of this program in runs/.
        artefacts: what is kept of each problem: all; plan, only scene.yaml and plan.yaml; none, only its record.
        meshcat: show what is planned live in a browser on this machine, with one worker of its own.
        grace: how long a problem may take beyond its time limit, to finish a step, to verify and to write what it
            leaves, before its process is ended [s].
        engine: where problems are solved, one by each process at a time.
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
