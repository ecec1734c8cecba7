"""A plan that was executed: saved as plan.yaml, loaded, replayed, shown."""

import tempfile
import webbrowser
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

from pydrake.trajectories import Trajectory

from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.types import Action, Attempt, Configuration, FloatArray
from ictamp_drake.robots.robot import find_robot
from ictamp_drake.scenes.spec import SceneSpec
from ictamp_drake.tamp.inverse_dynamics import torque_shares
from ictamp_drake.tamp.plan_file import plan_content, predicates_of, write_content
from ictamp_drake.tamp.plan_origin import Origin
from ictamp_drake.tamp.plan_reading import read_parts
from ictamp_drake.tamp.replay import Replay, duration, replay
from ictamp_drake.tamp.symbols import goal_of
from ictamp_drake.tamp.torque_use import TorqueUse, largest
from ictamp_drake.world.abstraction import SceneAbstraction
from ictamp_drake.world.commands import arm_trajectory
from ictamp_drake.world.config import PhysicsConfig
from ictamp_drake.world.world import World

if TYPE_CHECKING:
    from ictamp_drake.tamp.playback import PlanSystem


@dataclass(frozen=True, eq=False)
class Plan:
    """A plan that was executed in simulation: skills with their parameters and motions.

    Attributes:
        spec: Scene of the plan.
        c: Initial configuration c_0.
        attempts: Runs of the skills in order, each with action, k and motion, and the configuration in which it ended
            unless the plan was read from a file of format 1 or 2.
        origin: Facts about the search that found the plan; None if they are not known.
    """

    spec: SceneSpec
    c: Configuration
    attempts: tuple[Attempt[Configuration], ...]
    origin: Origin | None = None

    @property
    def actions(self) -> tuple[Action, ...]:
        """High-level actions of the plan."""
        return tuple(attempt.action for attempt in self.attempts)

    @property
    def duration(self) -> float:
        """Total time of the motions, without pauses in between [s]."""
        return duration(self.attempts)

    @cached_property
    def torque_shares(self) -> FloatArray:
        """Largest share of each joint's torque limit that each step uses, shape (steps, n); more than 1 is too much.

        See `tamp.inverse_dynamics`.
        """
        return torque_shares(self.spec, self.c, self.attempts)

    @cached_property
    def torque(self) -> TorqueUse | None:
        """Largest share of a joint's torque limit that the plan uses, with the joint and the step; None if it is empty.

        Its text is a sentence: "Torque: at most 63 % of a joint's limit (elbow_joint, step 3)."
        """
        return largest(self.torque_shares, find_robot(self.spec.robot).joints)

    def __len__(self) -> int:
        return len(self.attempts)

    def __str__(self) -> str:
        return "\n".join(map(str, self.actions))

    def trajectory(self) -> Trajectory:
        """Return the commanded joint positions of the arm [rad], shape (7, 1), from time 0 to `duration`, C² in time.

        The commands of the hand are in the segments of each attempt's motion.

        Raises:
            IctampError: The plan is empty, so that no motion is commanded.
        """
        if not self.attempts:
            raise IctampError(Code.EMPTY, "an empty plan commands no motion, so it has no trajectory")
        return arm_trajectory([segment for attempt in self.attempts for segment in attempt.motion])

    def system(self) -> "PlanSystem":
        """Return a Drake system that plays the plan in your own diagram. Its class documents the output ports.

        Raises:
            IctampError: An action of the plan is not applicable after those before it.
        """
        from ictamp_drake.tamp.playback import PlanSystem  # noqa: PLC0415  (imports this module)

        return PlanSystem(self)

    def replay(self, physics: PhysicsConfig | None = None) -> Replay:
        """Execute the plan in a new simulator, by default with the default options."""
        world = World(self.spec)
        return replay(
            (physics or PhysicsConfig()).create(world),
            abstraction=SceneAbstraction(world, predicates_of(self.origin)),
            goal=goal_of(self.spec),
            c=self.c,
            attempts=self.attempts,
        )

    def show(self, path: Path | str | None = None, *, browser: bool = True) -> Path:
        """Write the plan's replay as a page, and open it in a browser.

        Args:
            path: File of the page; by default a temporary file.
            browser: Whether to open the page.

        Returns:
            File of the page, which needs neither network nor server.
        """
        from ictamp_drake.tamp.pages import write_replay  # noqa: PLC0415  (drawing modules take long to load)

        page = Path(path) if path else Path(tempfile.mkdtemp(prefix="ictamp-")) / "replay.html"
        write_replay(self, page)
        if browser:
            webbrowser.open(page.absolute().as_uri())
        return page

    def save(self, path: Path | str) -> None:
        """Write the plan as YAML, as docs/plan_file.md describes it; see `load`.

        It holds everything that another simulator or an arm needs to execute it.
        """
        write_plan(self, Path(path))

    @classmethod
    def load(cls, path: Path | str) -> "Plan":
        """Read a plan that `save` wrote.

        Raises:
            IctampError: The file cannot be read, is not a plan, or contradicts itself.
        """
        return read_plan(Path(path))


def write_plan(plan: Plan, path: Path, abstraction: SceneAbstraction | None = None) -> None:
    """Write the file, which appears whole or not at all. Numbers are read back exactly.

    Args:
        plan: Plan to write.
        path: File to write.
        abstraction: H of the plan's scene, if it exists already; building it takes as long as writing the file.
    """
    abstraction = abstraction or SceneAbstraction(World(plan.spec), predicates_of(plan.origin))
    write_content(plan_content(plan.spec, plan.c, plan.attempts, plan.origin, abstraction), path)


def read_plan(path: Path) -> Plan:
    """Read a plan back.

    Raises:
        IctampError: The file cannot be read, is not a plan, or contradicts itself.
    """
    return Plan(*read_parts(path))
