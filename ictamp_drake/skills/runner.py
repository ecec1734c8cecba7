"""One low-level step: draw k, plan the motion, execute it in physics, and judge the outcome."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from ictamp_drake.core.failures import Failure
from ictamp_drake.core.protocols import Sampler, Skill
from ictamp_drake.core.stopwatch import Stopwatch
from ictamp_drake.core.types import Action, Attempt, Configuration, Motion, Parameter, Segment, Skeleton, State
from ictamp_drake.motion.planner import Refusal
from ictamp_drake.skills.judge import judge
from ictamp_drake.skills.lookahead import Lookahead
from ictamp_drake.world.abstraction import SceneAbstraction
from ictamp_drake.world.outcome import Outcome
from ictamp_drake.world.poses import to_pose
from ictamp_drake.world.simulate import Physics


@dataclass(frozen=True, eq=False)
class Skills:
    """All skills of a scene, the planner's `SkillRunner`.

    Attributes:
        draws: Maximum number of parameters drawn in one attempt until one has a motion.
        abstraction: H.
        physics: Simulation of the scene.
        sampler: Source of k.
        skills: Skills by the name of their action.
        lookahead: Order of the parameters drawn that looks at the rest of the plan; None for the sampler's own order.
        promises: Whether an attempt ends where its skill promises, instead of where physics ends. `execute` runs
            physics later.
    """

    draws: int
    abstraction: SceneAbstraction
    physics: Physics
    sampler: Sampler[Configuration]
    skills: Mapping[str, Skill[Refusal]]
    lookahead: Lookahead | None = None
    promises: bool = False

    def attempt(
        self,
        c: Configuration,
        plan: Skeleton,
        rng: np.random.Generator,
        k: Parameter | None = None,
    ) -> Attempt[Configuration]:
        """Run ψ_a once from c; the attempt succeeds when H(c') is as promised (paper, Problem Formulation).

        Args:
            c: Configuration to start from.
            plan: Plan whose first action is a, followed by the state that a promises.
            rng: Random numbers of the sampler and of motion planning.
            k: The only parameter to try. If None, the sampler draws parameters.
        """
        stopwatch, action, promised = Stopwatch(), plan.actions[0], plan.states[1]
        drawing = iter((k,)) if k is not None else self._draw(c, plan, rng)
        k, motion, refusals = self._plan(c, action, drawing, rng, stopwatch)
        rejections = tuple(refusal.failure for refusal in refusals)
        if isinstance(motion, Refusal):
            every = (*refusals, motion)
            return Attempt(
                action,
                motion.failure,
                k=k,
                rejections=rejections,
                seconds=stopwatch.seconds,
                detail=motion.detail,
                obstacles=tuple(refusal.obstacle for refusal in every if refusal.obstacle),
                unreached=tuple(to_pose(refusal.unreached) for refusal in every if refusal.unreached is not None),
            )
        attempt = Attempt[Configuration](action, None, None, k, motion, rejections)
        if not self.promises or k is None:
            return self._run_motion(c, attempt, promised, stopwatch)
        with stopwatch.stage("abstraction"):
            outcome = Outcome(self.skills[action.name].promise(c, action, k, motion), True, None, motion, None)
        return self._judge_outcome(attempt, outcome, promised, stopwatch)

    def execute(self, c: Configuration, attempt: Attempt[Configuration], promised: State) -> Attempt[Configuration]:
        """Run the motion of an attempt in physics from c. It was planned from a promised configuration."""
        return self._run_motion(c, attempt, promised, Stopwatch(seconds=attempt.seconds))

    def _run_motion(
        self, c: Configuration, attempt: Attempt[Configuration], promised: State, stopwatch: Stopwatch
    ) -> Attempt[Configuration]:
        try:
            with stopwatch.stage("physics"):
                outcome = execute(self.physics, c, attempt.action, attempt.motion)
        except RuntimeError as error:
            sentence = str(error).partition(".")[0]
            seconds = stopwatch.seconds
            return replace(attempt, failure=Failure.NOT_SETTLED, successor=None, seconds=seconds, detail=sentence)
        return self._judge_outcome(attempt, outcome, promised, stopwatch)

    def _judge_outcome(
        self, attempt: Attempt[Configuration], outcome: Outcome, promised: State, stopwatch: Stopwatch
    ) -> Attempt[Configuration]:
        with stopwatch.stage("abstraction"):
            failure, detail = judge(self.abstraction(outcome.c), promised, attempt.action, outcome)
        return replace(
            attempt,
            failure=failure,
            successor=outcome.c,
            motion=outcome.motion,
            seconds=stopwatch.seconds,
            detail=detail,
            recording=outcome.recording,
        )

    def _draw(self, c: Configuration, plan: Skeleton, rng: np.random.Generator) -> Iterator[Parameter | Failure]:
        drawing = self.sampler.draws(c, plan.actions[0], rng)
        return drawing if self.lookahead is None else self.lookahead.sort(c, plan, drawing, rng)

    def _plan(
        self,
        c: Configuration,
        action: Action,
        drawing: Iterator[Parameter | Failure],
        rng: np.random.Generator,
        stopwatch: Stopwatch,
    ) -> tuple[Parameter | None, Motion | Refusal, list[Refusal]]:
        """Draw parameters until one has a motion. Return it, or else the last refusal, and the earlier refusals."""
        refusals: list[Refusal] = []
        k = None
        for _ in range(self.draws):
            with stopwatch.stage("sampling"):
                drawn = next(drawing, None if refusals else Failure.NO_INVERSE_KINEMATICS)
            if drawn is None:
                break
            if isinstance(drawn, Failure):
                refusals.append(Refusal(drawn, "the sampler found no parameter"))
                break
            k = drawn
            with stopwatch.stage("motion"):
                plan = self.skills[action.name].plan(c, action, k, rng)
            if not isinstance(plan, Refusal):
                return k, plan, refusals
            refusals.append(plan)
        return k, refusals[-1], refusals[:-1]


def execute(physics: Physics, c: Configuration, action: Action, motion: Motion) -> Outcome:
    """f of one low-level step: run its motion from c until it ends or the box is no longer between the fingers.

    Raises:
        RuntimeError: The contact solver diverges, which it does in a few jammed situations.
    """
    return physics.run(c, motion, watch=_Grip(action.args[0]))


@dataclass(frozen=True)
class _Grip:
    """Ends the simulation when the box is not between the fingers where it should be."""

    box: str

    def __call__(self, segment: Segment, physics: Physics) -> bool:
        return segment.gripper.force == 0 or physics.held == self.box
