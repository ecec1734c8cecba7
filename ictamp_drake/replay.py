"""Execute a plan file again: `python -m ictamp_drake.replay PLAN.yaml`."""

import sys
from dataclasses import dataclass, replace
from pathlib import Path

import tyro
from rich.console import Console

from ictamp_drake.runs.command import BROKEN, COMPLETE, command
from ictamp_drake.tamp.plan import Plan
from ictamp_drake.world.config import PhysicsConfig

NAME = "ictamp_drake.replay"


@dataclass(frozen=True)
class ReplayOptions:
    """Execute a plan in a fresh simulator, report whether it reaches its goal, and write a page that shows it.

    Attributes:
        plan: File of the plan, plan.yaml of a run.
        out: File of the page. By default replay.html beside the plan.
        show: Open the page in a browser.
        physics: Settings of the simulation.
    """

    plan: tyro.conf.Positional[Path]
    out: Path | None = None
    show: bool = False
    physics: PhysicsConfig = PhysicsConfig()


def act(options: ReplayOptions, console: Console) -> int:
    """Execute the plan, write its page, and return the exit code.

    Raises:
        IctampError: The file is not a plan, or the page cannot be written.
    """
    plan = Plan.load(options.plan)
    replay = plan.replay(options.physics)
    skills = f"{len(replay.outcomes)} of {len(plan)} skills executed in {replay.seconds:.1f} s"
    console.print(
        f"{options.plan}: {skills}; the goal {'holds' if replay.reached else 'does not hold'}", soft_wrap=True
    )
    if replay.outcomes or not plan.attempts:
        page = options.out or options.plan.with_name("replay.html")
        written = replace(plan, attempts=replay.recorded(plan.attempts)).show(page, browser=options.show)
        console.print(f"Replay: {written}", soft_wrap=True)
    return COMPLETE if replay.reached else BROKEN


def main(arguments: list[str] | None = None) -> int:
    """Run the program and return its exit code: 0 when the goal holds, 1 when it does not."""
    return command(NAME, ReplayOptions, act, "Interrupted.", arguments)


if __name__ == "__main__":
    sys.exit(main())
