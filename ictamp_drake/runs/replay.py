"""The judge of a whole plan: it is executed once more from c_0, in a fresh simulator and in one go."""

from collections.abc import Sequence
from dataclasses import dataclass
from time import perf_counter

from ictamp_drake.core.types import Atom, Attempt, Configuration
from ictamp_drake.scenes.spec import SceneSpec
from ictamp_drake.world.abstraction import Abstraction
from ictamp_drake.world.simulate import Frame, PhysicsConfig


@dataclass(frozen=True, eq=False)
class Replay:
    """One execution of a plan.

    Attributes:
        frames: the recording.
        c: where it ended.
        reached: whether all came to rest and H(c) holds the goal.
        seconds: computing time of the simulation; building the simulator is not in it [s].
    """

    frames: tuple[Frame, ...]
    c: Configuration
    reached: bool
    seconds: float


def replay(
    spec: SceneSpec,
    physics: PhysicsConfig,
    *,
    abstraction: Abstraction,
    goal: frozenset[Atom],
    c: Configuration,
    attempts: Sequence[Attempt[Configuration]],
) -> Replay:
    """Execute the motions of a plan from c, one right after the other."""
    simulator = physics.create(spec)
    motion = [segment for attempt in attempts for segment in attempt.motion]
    frames: list[Frame] = []
    start = perf_counter()
    outcome = simulator.run(c, motion, record=frames.append)
    seconds = perf_counter() - start
    return Replay(tuple(frames), outcome.c, outcome.settled and goal <= abstraction(outcome.c), seconds)


def starts(attempts: Sequence[Attempt[Configuration]]) -> list[float]:
    """When each skill begins in a replay [s]."""
    return [duration(attempts[:number]) for number in range(len(attempts))]


def duration(attempts: Sequence[Attempt[Configuration]]) -> float:
    """How long the motions of a plan take, one right after the other [s]."""
    return sum(attempt.duration for attempt in attempts)
