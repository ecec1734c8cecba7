"""search.html: a search to step through, with the replay of any of its steps, in one file that needs nothing else.

Meshcat's static page, which shows the scene, is in it once; the page's own JavaScript draws the tree from the record
and moves the bodies by the tracks of the steps that lead to the node at hand.
"""

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from ictamp_drake.core.failures import Failure
from ictamp_drake.core.files import write_whole
from ictamp_drake.core.types import Attempt, Configuration
from ictamp_drake.motion.reach import Reach
from ictamp_drake.planning.tree import Step, Tree
from ictamp_drake.scenes.spec import SceneSpec
from ictamp_drake.viz.drawing import to_hex
from ictamp_drake.viz.layout import CAUSE_COLORS, Layout, Record
from ictamp_drake.viz.page import add_to_body, resource, to_script
from ictamp_drake.viz.reasons import NO_REASONS, Reasons
from ictamp_drake.viz.stage import Stage, start_meshcat
from ictamp_drake.viz.tracks import Track, tracks
from ictamp_drake.world.outcome import Frame

TIME_UNIT, POSE_UNIT = 1e-3, 1e-4
"""Tracks are whole numbers of these: time [s]; position [m] and components of the unit quaternion."""

DESCRIBED = 300
"""Maximum number of steps of which the page says whether they were out of reach or a joint has a limit."""

SCRIPTS = ("log", "tree", "facts", "player", "why", "controls")
"""Parts of the page's JavaScript, in their order."""


def search_html(
    spec: SceneSpec,
    tree: Tree[Configuration],
    recordings: Mapping[int, Sequence[Frame]],
    path: Path,
    title: str = "",
    *,
    stage: Stage | None = None,
    reasons: Reasons = NO_REASONS,
) -> None:
    """Write the page; it appears whole or not at all.

    Args:
        spec: Scene of the search.
        tree: Tree of the search.
        recordings: Recordings of executed steps by their index in the tree's log; for a successful step without one,
            the page shows the step's end.
        path: File of the page.
        title: Name of the search.
        stage: Stage of the scene, which must hold no animation; by default a new one.
        reasons: Reasons why there is no plan, if there is none.
    """
    stage = stage or Stage(spec, start_meshcat())
    stage.show(tree.root.c)
    data = {
        "title": title,
        "tree": (record := tree.to_dict()),
        "layout": _layout(Layout(record)),
        "failures": {f.name: {"sentence": str(f), "color": to_hex(CAUSE_COLORS[f])} for f in Failure},
        "attempts": _attempts(spec, tree),
        "scene": {
            "bodies": list(stage.poses(tree.root.c)),
            "boxes": list(spec.boxes),
            "units": [TIME_UNIT, POSE_UNIT],
            "root": _motion(stage, [Frame(0.0, tree.root.c)]),
            "motions": _motions(stage, tree, recordings),
        },
        "reasons": _reasons(reasons),
    }
    scripts = "\n".join(resource(f"search/{name}.js") for name in SCRIPTS)
    script = f"<script>const record = {to_script(data)};\n{scripts}</script>"
    write_whole(path, add_to_body(stage.meshcat.StaticHtml(), resource("search/page.html") + script))


def _reasons(reasons: Reasons) -> Record:
    refusals = [{**asdict(refusal), "colors": refusal.colors} for refusal in reasons.refusals]
    return {"ended": reasons.ended, "refusals": refusals, "remarks": reasons.remarks}


def _layout(layout: Layout) -> Record:
    nodes = range(len(layout.nodes))
    return {
        "levels": layout.levels,
        "stubs": [{"node": stub.node, "action": stub.action} for stub in layout.stubs],
        "labels": layout.labels,
        "solution": sorted(layout.solution),
        "colors": [to_hex(layout.color(layout.plan_of.get(node))) for node in nodes],
        "plans": [{"plan": plan, "color": to_hex(layout.color(plan))} for plan in layout.plans],
        "expanded": layout.expanded,
        "depth": layout.depth,
    }


def _attempts(spec: SceneSpec, tree: Tree[Configuration]) -> dict[int, Record]:
    """Facts of the steps, by their index in the tree's log, that the record lacks."""
    steps = {number: step.attempt for number, step in enumerate(tree.log) if isinstance(step, Step)}
    unreached = {
        number: attempt.unreached[-1]
        for number, attempt in steps.items()
        if attempt.failure is Failure.NO_INVERSE_KINEMATICS and attempt.unreached and not attempt.detail
    }
    some = dict([*unreached.items()][:DESCRIBED])
    reach = Reach(spec)
    said = {number: reach.describe(pose) for number, pose in some.items()}
    return {number: _attempt(attempt, attempt.detail or said.get(number, "")) for number, attempt in steps.items()}


def _attempt(attempt: Attempt[Configuration], detail: str) -> Record:
    return {
        "seconds": round(sum(attempt.seconds.values()), 3),
        "detail": detail,
        "segments": [[segment.label, round(segment.duration, 3)] for segment in attempt.motion],
    }


def _motions(
    stage: Stage, tree: Tree[Configuration], recordings: Mapping[int, Sequence[Frame]]
) -> dict[int, dict[str, Any]]:
    ends = {
        number: [Frame(0.0, tree.nodes[entry.child].c)]
        for number, entry in enumerate(tree.log)
        if isinstance(entry, Step) and entry.child is not None
    }
    return {number: _motion(stage, frames) for number, frames in sorted({**ends, **recordings}.items())}


def _motion(stage: Stage, frames: Sequence[Frame]) -> dict[str, Any]:
    """Its end [s], and for each body times and poses of its keys in their units."""
    return {
        "end": round(frames[-1].time, 3),
        "tracks": [_to_integers(track) for track in tracks(stage, frames).values()],
    }


def _to_integers(track: Track) -> list[list[int]]:
    times = np.rint(track.times / TIME_UNIT).astype(int)
    poses = np.rint(track.poses / POSE_UNIT).astype(int)
    return [times.tolist(), poses.ravel().tolist()]
