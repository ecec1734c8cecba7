"""The symbolic states that a plan should pass, and where an execution first misses one."""

from collections.abc import Sequence
from typing import NamedTuple

from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.types import Action, Configuration, State
from ictamp_drake.tamp.replay import Replay
from ictamp_drake.tamp.symbols import domain_of
from ictamp_drake.world.abstraction import SceneAbstraction
from ictamp_drake.world.world import World


class StepReport(NamedTuple):
    """One step of an execution compared with what its plan expects.

    Attributes:
        action: Action of the step.
        missing: Atoms that should hold after the step and do not.
        unexpected: Atoms that hold after the step and should not.
        executed: Whether the step was executed at all.
        settled: Whether everything came to rest after it.
    """

    action: Action
    missing: State
    unexpected: State
    executed: bool = True
    settled: bool = True

    @property
    def as_expected(self) -> bool:
        """Whether the expected state was reached and at rest."""
        return self.executed and self.settled and not self.missing and not self.unexpected

    def __str__(self) -> str:
        if self.as_expected:
            return "as expected"
        if not self.executed:
            return "not executed, since the contact solver diverged"
        missing, unexpected = (", ".join(map(str, sorted(atoms))) for atoms in (self.missing, self.unexpected))
        parts = {"missing": missing, "instead": unexpected, "not at rest": "" if self.settled else "the boxes move"}
        return "; ".join(f"{name}: {text}" for name, text in parts.items() if text)


def expected_states(world: World, c: Configuration, actions: Sequence[Action]) -> tuple[State, ...]:
    """Return H(c) and the state that each action promises, one more than there are actions.

    A search accepts a step only when exactly the promised state is reached, so these are also the states of the
    execution in which the plan was found.

    Raises:
        IctampError: An action is not applicable after those before it.
    """
    states = [SceneAbstraction(world)(c)]
    domain = domain_of(world.spec, states[0])
    for number, action in enumerate(actions):
        try:
            states.append(domain.successor(states[-1], action))
        except ValueError as error:
            problem = "{value} is not applicable in the state before it"
            raise IctampError(Code.CONFLICT, problem, field=f"steps[{number}].action", value=str(action)) from error
    return tuple(states)


def compare_steps(
    replay: Replay, abstraction: SceneAbstraction, actions: Sequence[Action], states: Sequence[State]
) -> list[StepReport]:
    """Compare each step of an execution with the state that is expected after it.

    Args:
        replay: Execution of the plan.
        abstraction: Abstraction H of the scene.
        actions: Actions of the plan.
        states: Expected states, from `expected_states`.
    """
    reports = []
    for number, (action, state) in enumerate(zip(actions, states[1:], strict=True)):
        if number >= len(replay.outcomes):
            reports.append(StepReport(action, state, frozenset(), executed=False))
            continue
        outcome = replay.outcomes[number]
        reached = abstraction(outcome.c)
        reports.append(StepReport(action, state - reached, reached - state, settled=outcome.settled))
    return reports
