"""Figures are written under their names, with the same bytes every time."""

from pathlib import Path

from matplotlib.figure import Figure

from ictamp_drake.viz.figures import write_figures


def line() -> Figure:
    figure = Figure()
    figure.subplots().plot([0, 1])
    return figure


def test_the_same_figure_is_the_same_file(tmp_path: Path) -> None:
    assert write_figures({"a.png": line, "b.png": line}, tmp_path) == ["a.png", "b.png"]
    first, second = ((tmp_path / name).read_bytes() for name in ("a.png", "b.png"))
    assert first == second


def test_looks_do_not_leak(tmp_path: Path) -> None:
    write_figures({"a.png": line}, tmp_path)
    assert line().axes[0].spines["top"].get_visible()
