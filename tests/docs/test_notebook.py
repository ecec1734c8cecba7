"""The tour runs from top to bottom and is committed without outputs."""

from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient
from nbformat import NotebookNode

ROOT = Path(__file__).parents[2]
TOUR = ROOT / "notebooks" / "tour.ipynb"


@pytest.fixture
def tour() -> NotebookNode:
    notebook = nbformat.read(TOUR, as_version=nbformat.NO_CONVERT)
    nbformat.validate(notebook)
    return notebook


def code(notebook: NotebookNode) -> list[NotebookNode]:
    return [cell for cell in notebook.cells if cell.cell_type == "code"]


def test_no_outputs_are_committed(tour: NotebookNode) -> None:
    assert [cell for cell in code(tour) if cell.outputs or cell.execution_count is not None] == []


@pytest.mark.slow
def test_every_cell_runs(tour: NotebookNode, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    NotebookClient(tour, kernel_name="python3", resources={"metadata": {"path": tmp_path}}).execute()
    shown = [output for cell in code(tour) for output in cell.outputs]
    assert not [output for output in shown if output.get("name") == "stderr"]
    pages = [output.data["text/html"] for output in shown if "text/html" in output.get("data", {})]
    assert [sum(f"<div><{tag} " in page for page in pages) for tag in ("iframe", "svg")] == [1, 2]
