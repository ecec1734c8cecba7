"""Check the style of docstrings: `python scripts/check_prose.py [FOLDER ...]`.

`--help` shows the lines under Attributes and Args, where they stand alone: they begin with a capital letter and are
whole phrases, not the end of "seed: of …". A docstring begins with a verb or a noun phrase.
"""

import ast
import re
import sys
from collections.abc import Iterator
from pathlib import Path

SECTIONS = ("Args:", "Attributes:", "Raises:")
FRAGMENTS = ("Of", "That", "Those", "The same", "As", "By", "So", "To be")
"""Words that must not begin a line under Attributes or Args, since they continue the name before the colon."""
OPENINGS = ("Of", "How", "Why", "What", "Which", "Where", "When", "That", "Those", "So", "As")
"""Words that must not begin a docstring."""


def main(folders: list[str]) -> int:
    """Print the problems and return the exit code."""
    found = [line for folder in folders for path in sorted(Path(folder).rglob("*.py")) for line in check_file(path)]
    print(*found, sep="\n", end="\n" if found else "")
    return 1 if found else 0


def check_file(path: Path) -> Iterator[str]:
    """Yield the problems of the docstrings in a file."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef | ast.Module):
            text = ast.get_docstring(node)
            if text:
                start = node.body[0].lineno
                yield from (f"{path}:{start + line}: {problem}" for line, problem in check_docstring(text))


def check_docstring(text: str) -> Iterator[tuple[int, str]]:
    """Yield the line number and the text of each problem of a docstring."""
    lines = text.splitlines()
    if _begins_with(lines[0], OPENINGS):
        yield 0, f"begins with '{lines[0].split()[0]}', expected a verb or a noun phrase: {lines[0]}"
    section = ""
    for number, line in enumerate(lines):
        if line in SECTIONS:
            section = line
        elif line and not line.startswith(" "):
            section = ""
        entry = re.match(r"    (\*{0,2}\w[\w, *]*): (.*)", line)
        if section and entry and (problem := _check_entry(entry[2])):
            yield number, f"{problem}: {line.strip()}"


def _check_entry(text: str) -> str:
    if text[0].islower():
        return "begins with a small letter"
    return "leans on the name before the colon" if _begins_with(text, FRAGMENTS) else ""


def _begins_with(line: str, words: tuple[str, ...]) -> bool:
    return any(re.match(rf"{word}\b", line) for word in words)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:] or ["ictamp_drake"]))
