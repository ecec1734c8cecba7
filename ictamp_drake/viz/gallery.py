"""Pictures of several scenes side by side (paper, Figure 2)."""

from collections.abc import Mapping
from functools import cache

from matplotlib.figure import Figure

from ictamp_drake.scenes.levels import LEVELS, problem_files
from ictamp_drake.scenes.spec import INTERFERENCES, SceneSpec, load_scene
from ictamp_drake.viz.picture import picture
from ictamp_drake.world.world import World

COLUMNS, WIDTH, HEIGHT = 3, 3.2, 3.5  # panels per row, size of a panel with its title [in]
VIEW = (slice(100, 600), slice(130, 630))
"""Visible rows and columns of a picture: the arm and the table."""


def examples() -> dict[str, SceneSpec]:
    """Load the first plain packing problem of each level, and the first with each single kind of interference."""
    files = {f"{level}-{path.stem}": path for level in LEVELS for path in problem_files(level)}
    scene = cache(load_scene)

    def first(kinds: tuple[str, ...], level: str = "") -> str:
        of_level = (name for name in files if name.startswith(level))
        return next(name for name in of_level if scene(files[name]).interference == kinds)

    names = {level: first((), level) for level in LEVELS} | {kind: first((kind,)) for kind in INTERFERENCES}
    return {f"{title} ({name})": scene(files[name]) for title, name in names.items()}


def gallery(scenes: Mapping[str, SceneSpec]) -> Figure:
    """Draw scenes as specified, each below its title."""
    rows = -(-len(scenes) // COLUMNS)
    figure = Figure(figsize=(COLUMNS * WIDTH, rows * HEIGHT), layout="constrained")
    panels = figure.subplots(rows, COLUMNS, squeeze=False).flat
    for axes in panels:
        axes.set_axis_off()
    for axes, (title, spec) in zip(figure.axes, scenes.items(), strict=False):
        axes.imshow(picture(spec, World(spec).initial_configuration())[VIEW])
        axes.set_title(title, fontsize=9)
    return figure
