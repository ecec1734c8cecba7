"""Times of strategies that ran on machines of different speeds, or on a machine whose speed varied."""

from collections.abc import Mapping

import pandas as pd

from ictamp_drake.reports.comparison import compare_strategies


def scale_to_equal_pace(runs: pd.DataFrame, reference: str) -> pd.DataFrame:
    """Scale times as if the machine had been as fast as when the reference ran, level by level.

    Times are divided by `Comparison.pace`, and stay as measured where it is not known. The time limit of an unsolved
    run is not scaled.

    Args:
        runs: Table of the runs, see `regime.tabulate_runs`.
        reference: Name of the reference strategy.
    """
    scale = pd.Series(1.0, runs.index)
    for strategy in runs["strategy"].cat.categories.drop(reference):
        for each in compare_strategies(runs, strategy, reference):
            if each.pace is not None:
                scale[(runs["strategy"] == strategy) & (runs["level"] == each.level)] = 1 / each.pace.value
    return runs.assign(
        seconds=runs["seconds"] * scale,
        counted=runs["counted"].where(~runs["solved"], runs["seconds"] * scale),
        replay=runs["replay"] * scale,
        stages=runs["stages"].combine(scale, _scale_stages),
    )


def _scale_stages(stages: Mapping[str, float], scale: float) -> dict[str, float]:
    return {stage: scale * seconds for stage, seconds in stages.items()}
