"""Verdict on an executed skill: success or the cause of failure."""

from ictamp_drake.core.failures import Failure
from ictamp_drake.core.types import Action, Atom, State
from ictamp_drake.world.outcome import Outcome


def judge(reached: State, promised: State, action: Action, outcome: Outcome) -> tuple[Failure | None, str]:
    """None when the promised state is reached and at rest, else the likeliest cause and the atoms that differ."""
    if outcome.stopped_after == "grasp":
        return Failure.NOT_GRASPED, f"the fingers closed without {action.args[0]} between them"
    if outcome.stopped_after is not None:
        return Failure.SLIPPED, f"{action.args[0]} was lost: {outcome.stopped_after}"
    if not outcome.settled:
        return Failure.NOT_SETTLED, ""
    if reached == promised:
        return None, ""
    return _cause(reached, promised, action), _difference(reached, promised)


def _cause(reached: State, promised: State, action: Action) -> Failure:
    box = action.args[0]
    if any(Atom(p, (box,)) in promised - reached for p in ("upright", "tipped")):
        return Failure.TOPPLED
    if any(atom.predicate in {"on", "lying"} and atom.args[0] != box for atom in promised - reached):
        return Failure.OTHER_MOVED
    if action.name == "pick" and Atom("in-hand", (box,)) not in reached:
        return Failure.SLIPPED
    return Failure.WRONG_STATE


def _difference(reached: State, promised: State) -> str:
    missing = ", ".join(str(atom) for atom in sorted(promised - reached))
    unexpected = ", ".join(str(atom) for atom in sorted(reached - promised))
    return f"missing: {missing or 'nothing'}; unexpected: {unexpected or 'nothing'}"
