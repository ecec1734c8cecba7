"""Cost of boxes that nothing touches: `python benchmarks/bystanders.py`, processor time in one thread.

Plans alternately in two scenes that differ only in the number of boxes: cubes that must go to other tables, with and
without sixteen bystanders. Prints each scene's processor time per simulated second, as the median over the executed
skills, and the ratio of the first scene to the second.
"""

# ruff: noqa: E402

import os
import sys
import time
from dataclasses import dataclass
from pathlib import Path

for _threads in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[_threads] = "1"
time.perf_counter = time.process_time  # before the package imports it, so that it measures processor time only

import numpy as np
import tyro

from ictamp_drake.core.errors import IctampError
from ictamp_drake.tamp.method import Method
from ictamp_drake.tamp.solve import solve
from ictamp_drake.tamp.task import load

SCENES = Path(__file__).with_name("scenes") / "bystanders"


@dataclass(frozen=True)
class Options:
    """Compare the cost of bystanders.

    Attributes:
        scenes: Scene with many boxes, and scene with few.
        rounds: Number of searches in each scene.
        method: Method of the searches.
    """

    scenes: tuple[Path, Path] = (SCENES / "many.yaml", SCENES / "few.yaml")
    rounds: int = 2
    method: Method = Method()


def paces(scene: Path, method: Method) -> tuple[bool, list[float]]:
    """Whether the problem was solved, and the processor time per simulated second of each executed skill."""
    result = solve(load(scene, method), method).result
    attempts = [step.attempt for step in result.tree.steps if step.attempt.successor is not None]
    return result.solved, [attempt.seconds["physics"] / attempt.duration for attempt in attempts]


def main() -> None:
    """Plan alternately and print."""
    options = tyro.cli(Options, description=__doc__)
    found: dict[Path, list[float]] = {scene: [] for scene in options.scenes}
    solved = dict.fromkeys(options.scenes, 0)
    for number in range(options.rounds):
        for scene in options.scenes if number % 2 == 0 else options.scenes[::-1]:
            held, seconds = paces(scene, options.method)
            solved[scene] += held
            found[scene] += seconds
    for scene, seconds in found.items():
        print(f"{scene.stem}: {np.median(seconds):.3f} s a simulated second, {len(seconds)} skills executed, ", end="")
        print(f"solved {solved[scene]} of {options.rounds}")
    many, few = (np.median(found[scene]) for scene in options.scenes)
    print(f"as a multiple: {many / few:.2f}")


if __name__ == "__main__":
    try:
        main()
    except IctampError as error:
        sys.exit(str(error))
