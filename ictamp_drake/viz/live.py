"""Live view: Meshcat shows the planner at work, on this machine only."""

from pydrake.geometry import Meshcat

from ictamp_drake.core.types import Configuration
from ictamp_drake.planning.events import Event, Listener, PlanFound, PlanOpened, StepDone, StepStarted, Verified
from ictamp_drake.scenes.spec import SceneSpec
from ictamp_drake.viz.stage import PREFIX, Stage, start_meshcat


class LiveView:
    """One server for all problems of a run, which prints its address when it starts.

    Args:
        port: Port on localhost; by default the first free one from 7000 on.

    Raises:
        IctampError: The port cannot be used.
    """

    def __init__(self, port: int | None = None) -> None:
        self._meshcat: Meshcat = start_meshcat(port)
        print(f"Live view at {self.url}", flush=True)

    @property
    def url(self) -> str:
        """Address of the page."""
        return str(self._meshcat.web_url())

    def listener(self, spec: SceneSpec) -> Listener:
        """Show this scene from now on, and return a listener that updates it with every low-level step."""
        self._meshcat.Delete(PREFIX)
        stage = Stage(spec, self._meshcat)

        def listen(event: Event) -> None:
            c = configuration(event)
            if c is not None:
                stage.show(c)

        return listen


def configuration(event: Event) -> Configuration | None:
    """Configuration to show at an event: start and end of a step, or a verified plan's end; None for no change."""
    match event:
        case StepStarted(node=node) | Verified(node=node):
            return node.c
        case StepDone(attempt=attempt):
            return attempt.successor
        case PlanOpened() | PlanFound():
            return None
