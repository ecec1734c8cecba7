"""Computing time of the search's operations in recorded runs: `python benchmarks/effort.py`, half a minute.

Prints for each strategy the time per parameter k (sampling and motion planning; most refused k take far less than the
others) and per simulated second of motion. Adaptive allocation ran on a slower machine than the others. Then prints the
time per expansion until the first plan of each level, measured here. The constants of `planning.beliefs` and
`planning.adaptive` are of this size.
"""

import time
from pathlib import Path
from statistics import median

from ictamp_drake.experiments.strategies import methods
from ictamp_drake.runs.records import Record, read_records
from ictamp_drake.scenes.levels import problem_files
from ictamp_drake.symbolic.context import GeneratorContext
from ictamp_drake.tamp.task import load

RESULTS = Path(__file__).parent / "results"
REGIMES = ("paper", "default")
LEVELS = ("easy", "medium", "hard", "extreme")


def of_k(records: list[Record]) -> float:
    """Mean computing time per parameter k [s]."""
    seconds = sum(record.seconds_by_stage.get(stage, 0.0) for record in records for stage in ("sampling", "motion"))
    return seconds / sum(record.low_level_steps + sum(record.rejections.values()) for record in records)


def of_motion(records: list[Record]) -> float:
    """Median computing time per simulated second [s]."""
    return median(
        record.replay_time_s / record.plan_duration_s
        for record in records
        if record.replay_time_s and record.plan_duration_s
    )


def of_expansion(level: str) -> float:
    """Mean computing time per expansion until the first plan [s]."""
    ((method,),) = methods("default", ["p-score"], [0]).values()
    task = load(problem_files(level)[0], method)
    generator = method.generator_config.create(GeneratorContext(task.domain, task.abstraction(task.c), task.goal))
    start = time.perf_counter()
    generator.next_plan(100_000)
    return (time.perf_counter() - start) / generator.expanded


def main() -> None:
    """Print the table."""
    print(f"{'regime':8} {'strategy':22} {'a k [s]':>10} {'a second of motion [s]':>24}")
    for regime in REGIMES:
        records = list(read_records(RESULTS / regime / "results.jsonl").values())
        for strategy in dict.fromkeys(record.strategy for record in records):
            of = [record for record in records if record.strategy == strategy]
            print(f"{regime:8} {strategy:22} {of_k(of):10.3f} {of_motion(of):24.3f}")
    for level in LEVELS:
        print(f"an expansion, {level}: {of_expansion(level):.1e} s")


if __name__ == "__main__":
    main()
