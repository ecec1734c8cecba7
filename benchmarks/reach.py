"""Measure how often towers on far tables are planned for, with and without looking ahead.

Every scene is a tower of 4 to 6 cubes on a table whose far part is out of reach for the upper ones.

    python benchmarks/reach.py
    python benchmarks/reach.py --scenes my_scene.yaml --seeds 20 --look-ahead 64
"""

from dataclasses import dataclass, replace
from itertools import pairwise, product
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory

import numpy as np
import tyro

import ictamp_drake as ict
from ictamp_drake.tamp.method import SCENE_METHOD


@dataclass(frozen=True)
class Options:
    """Options of the measurement.

    Attributes:
        scenes: Scene files; without any, towers are generated.
        towers: Number of generated towers of each height.
        distance: Least and greatest distance of the tower's table from the arm's base [m].
        seeds: Number of searches for each scene.
        look_ahead: Values of `skills.look-ahead` to compare.
        planner: Rule that chooses the next computational action.
        cpu_limit: Limit of the processor time of one search [s].
    """

    scenes: tuple[Path, ...] = ()
    towers: int = 4
    distance: tuple[float, float] = (0.55, 0.72)
    seeds: int = 1
    look_ahead: tuple[int, ...] = (0, 64)
    planner: str = SCENE_METHOD.planner if isinstance(SCENE_METHOD.planner, str) else "completion-tree"
    cpu_limit: float = 30.0


def tower(count: int, distance: float, rng: np.random.Generator) -> str:
    """Scene with `count` equal cubes on one table, to be stacked on a table at a distance [m] from the arm's base."""
    height, side, heading = rng.uniform(0.2, 0.4), round(rng.uniform(0.035, 0.055), 3), rng.uniform(-180, 180)
    near = heading + rng.choice([-100, 100])
    lines = ["supports:"]
    for name, yaw, radius in (("far", heading, distance), ("near", near, 0.55)):
        x, y = radius * np.cos(np.deg2rad(yaw)), radius * np.sin(np.deg2rad(yaw))
        place = f"position: [{x:.3f}, {y:.3f}, {height:.3f}], yaw: {yaw:.1f}"
        lines.append(f"  {name}: {{kind: table, size: [0.4, 0.7, 0.025], {place}}}")
    lines.append("boxes:")
    names, angle = "abcdef"[:count], np.deg2rad(near)
    spots = rng.permutation([*product((-0.1, 0.1), (-0.2, 0.0, 0.2))])
    for name, spot in zip(names, spots, strict=False):
        u, v = spot + [0.55, 0.0] + rng.uniform(-0.03, 0.03, 2)
        x, y = u * np.cos(angle) - v * np.sin(angle), u * np.sin(angle) + v * np.cos(angle)
        place = f"position: [{x:.3f}, {y:.3f}, {height + side / 2:.4f}], rotation: [0, 0, {rng.uniform(-90, 90):.0f}]"
        lines.append(f"  {name}: {{size: [{side}, {side}, {side}], {place}, mass: 0.05}}")
    stacked = " ".join(f"(on {upper} {lower})" for lower, upper in pairwise(names))
    return "\n".join([*lines, f"goal: (and (on a far) {stacked})", ""])


def generate(folder: Path, options: Options) -> list[Path]:
    """Write the generated towers and return their files."""
    files = []
    for count in (4, 5, 6):
        for number in range(options.towers):
            rng = np.random.default_rng([25, count, number])
            files.append(folder / f"{count}-cubes-{number}.yaml")
            files[-1].write_text(tower(count, rng.uniform(*options.distance), rng), encoding="utf-8")
    return files


def measure(file: Path, look_ahead: int, options: Options) -> str:
    """Row of the table: searches solved, and the medians of their processor time and steps."""
    method = replace(SCENE_METHOD, planner=options.planner, skills=replace(SCENE_METHOD.skills, look_ahead=look_ahead))
    task, times, steps = ict.load(file, method), [], []
    for seed in range(options.seeds):
        solution = ict.solve(task, method, seed=seed, cpu_limit=options.cpu_limit, time_limit=1e5)
        if solution.plan is not None:
            times.append(solution.cpu_time_s)
            steps.append(solution.result.low_level_steps)
    middle = f"{median(times):.1f} | {max(times):.1f} | {median(steps):.0f}" if times else "- | - | -"
    return f"| {file.stem} | {look_ahead} | {len(times)} of {options.seeds} | {middle} |"


def main(options: Options) -> None:
    """Print the table."""
    print(
        "| scene | look-ahead | solved | median CPU s | longest | median steps |", "|---|---|---|---|---|---|", sep="\n"
    )
    with TemporaryDirectory() as folder:
        for file in options.scenes or generate(Path(folder), options):
            for look_ahead in options.look_ahead:
                print(measure(file, look_ahead, options), flush=True)


if __name__ == "__main__":
    main(tyro.cli(Options, description=__doc__))
