"""Execute a plan file again: `python -m ictamp_drake.replay PLAN.yaml`."""

import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated

import tyro
from rich.console import Console

from ictamp_drake.core.files import refuse_unwritable
from ictamp_drake.core.reading import in_file
from ictamp_drake.runs.command import BROKEN, COMPLETE, command
from ictamp_drake.tamp.changes import Changes
from ictamp_drake.tamp.expected import StepReport, compare_steps, expected_states
from ictamp_drake.tamp.plan import Plan
from ictamp_drake.world.abstraction import SceneAbstraction
from ictamp_drake.world.config import PhysicsConfig
from ictamp_drake.world.world import World

NAME = "ictamp_drake.replay"


@dataclass(frozen=True)
class ReplayOptions:
    """Execute a plan in a fresh simulator, report step by step whether it goes as expected, and write its page.

    The exit code is 0 when the goal holds at the end, and 1 when it does not.

    Attributes:
        plan: File of the plan, plan.yaml of a run.
        out: File of the page. By default replay.html beside the plan.
        show: Open the page in a browser.
        changes: Differences from the world in which the plan was found.
        physics: Settings of the simulation.
    """

    plan: tyro.conf.Positional[Path]
    out: Path | None = None
    show: bool = False
    changes: Annotated[Changes, tyro.conf.arg(name="")] = Changes()
    physics: PhysicsConfig = PhysicsConfig()


def act(options: ReplayOptions, console: Console) -> int:
    """Execute the plan, report its steps, write its page, and return the exit code.

    Raises:
        IctampError: The file is not a plan, a change is not possible, or the page cannot be written.
    """
    physics = options.changes.physics(options.physics)
    plan = options.changes.apply(Plan.load(options.plan), options.physics)
    world = World(plan.spec)
    with in_file(options.plan):
        states = expected_states(world, plan.c, plan.actions)
    replay = plan.replay(physics)
    _report(compare_steps(replay, SceneAbstraction(world), plan.actions, states), console)
    skills = f"{len(replay.outcomes)} of {len(plan)} skills executed in {replay.seconds:.1f} s"
    console.print(f"{options.plan}: {skills}; the goal {'holds' if replay.holds else 'does not hold'}", soft_wrap=True)
    if plan.torque is not None:
        console.print(str(plan.torque), soft_wrap=True)
    if replay.outcomes or not plan.attempts:
        page = options.out or options.plan.with_name("replay.html")
        with refuse_unwritable(page):
            written = replace(plan, attempts=replay.recorded(plan.attempts)).show(page, browser=options.show)
        console.print(f"Replay: {written}", soft_wrap=True)
    return COMPLETE if replay.holds else BROKEN


def _report(steps: Sequence[StepReport], console: Console) -> None:
    """Print a line for each step, and where the execution first left the plan."""
    width = max((len(str(step.action)) for step in steps), default=0)
    for number, step in enumerate(steps, 1):
        console.print(f"{number:>3}  {step.action!s:<{width}}  {step}", soft_wrap=True)
    first = next((number for number, step in enumerate(steps, 1) if not step.as_expected), None)
    if first is not None:
        console.print(f"First missed: step {first} of {len(steps)}, {steps[first - 1].action}", soft_wrap=True)


def main(arguments: list[str] | None = None) -> int:
    """Run the program and return its exit code: 0 when the goal holds, 1 when it does not."""
    return command(NAME, ReplayOptions, act, "Interrupted.", arguments)


if __name__ == "__main__":
    sys.exit(main())
