"""Each example of docs/extending.md runs, and the page shows it unchanged."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.runs.programs import environment

DOCS = Path(__file__).parents[2] / "docs"
PAGE = DOCS / "extending.md"
PROGRAMS = sorted((DOCS / "examples").glob("*.py"))
LANGUAGES = {".py": "python", ".yaml": "yaml"}


@pytest.mark.parametrize("program", PROGRAMS, ids=lambda path: path.stem)
def test_the_example_keeps_its_promises(program: Path, tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, program], cwd=tmp_path, env=environment(), capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize("file", sorted((DOCS / "examples").iterdir()), ids=lambda path: path.name)
def test_the_page_shows_the_file_as_it_is(file: Path) -> None:
    block = f"```{LANGUAGES[file.suffix]}\n{file.read_text()}```\n"
    assert block in PAGE.read_text(), f"the block of {file.name} in {PAGE.name} differs from the file"


@pytest.mark.parametrize("program", PROGRAMS, ids=lambda path: path.stem)
def test_the_example_needs_the_promised_names_only(program: Path) -> None:
    imported = re.findall(r"^(?:from|import) (ictamp_drake\S*)", program.read_text(), re.MULTILINE)
    assert set(imported) <= {"ictamp_drake", "ictamp_drake.plugins"}
