"""The console command `ictamp`: all programs of the package under one name."""

import runpy
import sys
from collections.abc import Sequence

PROGRAMS = {
    "plan": ("ictamp_drake.plan", "plan in a scene of your own"),
    "replay": ("ictamp_drake.replay", "execute a plan file again and show it"),
    "export": ("ictamp_drake.export", "write a plan file as joint trajectories"),
    "robot": ("ictamp_drake.robot", "check the file of a robot"),
    "packing": ("ictamp_drake.experiments.packing", "solve the packing problems of the paper"),
    "compare": ("ictamp_drake.experiments.runner", "run several strategies on the same problems"),
    "report": ("ictamp_drake.experiments.report", "write tables, figures and a page of results of such runs"),
    "collect": ("ictamp_drake.experiments.collect", "collect attempts to learn from"),
    "train-skill": ("ictamp_drake.experiments.train_skill", "train policies and critics"),
    "train-dynamics": ("ictamp_drake.experiments.train_dynamics", "train the dynamics of skills"),
    "train-estimator": ("ictamp_drake.experiments.train_estimator", "train P"),
    "accuracy": ("ictamp_drake.experiments.estimator_accuracy", "compare estimates with the counted success rate"),
}
"""Module and purpose of each program. `python -m MODULE` runs the same program."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a program by its short name and return its exit code."""
    name, *rest = (sys.argv[1:] if arguments is None else list(arguments)) or ["--help"]
    if name in ("-h", "--help"):
        print(usage())
        return 0
    if name not in PROGRAMS:
        print(f"ictamp: '{name}' is not a command; expected one of: {', '.join(PROGRAMS)}", file=sys.stderr)
        return 2
    sys.argv = [f"ictamp {name}", *rest]
    try:
        runpy.run_module(PROGRAMS[name][0], run_name="__main__")
    except SystemExit as end:
        return end.code if isinstance(end.code, int) else int(end.code is not None)
    return 0


def usage() -> str:
    """Return the help text."""
    width = max(map(len, PROGRAMS))
    lines = (f"  {name:<{width}}  {purpose}" for name, (_, purpose) in PROGRAMS.items())
    return "\n".join(["usage: ictamp COMMAND [OPTIONS]", "", *lines, "", "ictamp COMMAND --help lists its options."])
