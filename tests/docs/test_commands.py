"""Commands and snippets of the README and of docs; those that take long are only parsed, by their own programs.

A command is a line of a code block without a language, or code in a sentence or table, that starts with `python`,
`ictamp` or `make`. The checks of each:

- `python -m ictamp_drake.…` and `ictamp …`: the program starts and stops before it acts on its options. They are
  parsed and their values are checked, except for files that they name;
- `python benchmarks/….py`, `scripts/….py`, `docs/examples/….py`: the file exists and its options, if it has a class
  of these, are parsed. `benchmarks/opening.py` takes plain numbers; other programs without `Options` take nothing;
- `make …`: the target exists.

Not checked: commands of `pip`, `cp`, `bash` and `pytest`, fragments that say "the same with …", commands that name a
part that the reader wrote, and whether the files in a command exist.
"""

import re
import runpy
import shlex
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tyro
import yaml

import ictamp_drake as ict
from ictamp_drake import cli
from ictamp_drake.experiments.strategies import methods
from ictamp_drake.skills.config import OptimizationConfig

ROOT = Path(__file__).parents[2]
PAGES = (ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md")))
BLOCK = re.compile(r"^```(\w*)\n(.*?)^```$", re.M | re.S)
PROGRAM = re.compile(r"(python (-m ictamp_drake|(benchmarks|scripts|docs/examples)/)|ictamp |make )[\w.]")


def find_commands() -> Iterator[tuple[str, str]]:
    """Page and text of each command."""
    for page in PAGES:
        text = page.read_text(encoding="utf-8")
        plain = (body for language, body in BLOCK.findall(text) if not language)
        lines = [line for body in plain for line in body.replace("\\\n", " ").splitlines()]
        spans = [" ".join(span.split()) for span in re.findall(r"`([^`]+)`", BLOCK.sub("", text))]
        yield from ((page.name, line.partition("  #")[0].strip()) for line in lines + spans if PROGRAM.match(line))


COMMANDS = sorted(set(find_commands()))

WRITTEN_BY_THE_READER = ("patient", "my_package")
"""Parts of their own that readers are told to choose; there is no such part to check."""


class Stopped(Exception):  # noqa: N818  (no error)
    """The program is about to act."""

    def __init__(self, options: object) -> None:
        self.options = options


def read_options(words: list[str], monkeypatch: pytest.MonkeyPatch) -> object:
    """Parse options as a program of the package does, without acting on them."""
    parse = tyro.cli

    def stop(kind: Any, **more: Any) -> object:
        options = parse(kind, **more)
        if "prog" in more:
            raise Stopped(options)
        return options

    monkeypatch.setattr(tyro, "cli", stop)
    monkeypatch.setattr(sys, "argv", ["program", *words[1:]])
    with pytest.raises(Stopped) as stopped:
        runpy.run_module(words[0], run_name="__main__")
    return stopped.value.options


def test_there_are_commands_to_check() -> None:
    assert len(COMMANDS) > 40


@pytest.mark.parametrize(("page", "command"), COMMANDS)
def test_the_command_can_be_read(page: str, command: str, monkeypatch: pytest.MonkeyPatch) -> None:
    program, *words = shlex.split(command)
    if any(part in command for part in WRITTEN_BY_THE_READER):
        pytest.skip(f"{page} tells how to choose a part that the reader wrote")
    if program == "make":
        targets = re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(encoding="utf-8"), re.M)
        assert words[0] in targets
    elif program == "ictamp" and words[0] != "--help":
        assert words[0] in cli.PROGRAMS
        if words[1:] != ["--help"]:
            read_options([cli.PROGRAMS[words[0]][0], *words[1:]], monkeypatch)
    elif words[0] == "-m":
        if words[2:] not in ([], ["--help"]):
            check(read_options(words[1:], monkeypatch))
        else:
            runs(words[1])
    else:
        check_script(words, monkeypatch)


def check(options: Any) -> None:
    """Check what a program reads only when it acts: the strategies of a comparison."""
    if hasattr(options, "regime") and hasattr(options, "strategies"):
        assert methods(options.regime, options.strategies, options.seeds)


def runs(module: str) -> None:
    path = ROOT / Path(*module.split("."))
    assert path.with_suffix(".py").is_file()


def check_script(words: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    path = ROOT / words[0]
    assert path.is_file()
    if not words[1:]:
        return
    monkeypatch.syspath_prepend(str(path.parent))
    contents = runpy.run_path(str(path))
    if "Options" in contents:
        tyro.cli(contents["Options"], args=words[1:])
    else:
        assert all(word.isdigit() for word in words[1:])


def find_blocks(page: Path, language: str) -> list[str]:
    return [body for kind, body in BLOCK.findall(page.read_text(encoding="utf-8")) if kind == language]


@pytest.mark.slow
def test_the_scene_and_the_snippet_of_the_readme_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (scene,), (snippet,) = (find_blocks(ROOT / "README.md", language) for language in ("yaml", "python"))
    (tmp_path / "scene.yaml").write_text(scene, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    exec(compile(snippet, "README.md", "exec"), names)
    plan = names["plan"]
    assert isinstance(plan, ict.Plan), capsys.readouterr().out
    assert "place(blue_box, red_box)" in capsys.readouterr().out.splitlines()
    for sentence in re.findall(r"`(plan\.\w+\(.*?\))`", (ROOT / "README.md").read_text(encoding="utf-8")):
        call = sentence.replace("show()", "show(browser=False)")
        exec(call, names)
    assert yaml.safe_load((tmp_path / "plan.yaml").read_text(encoding="utf-8"))["skeleton"] == list(
        map(str, plan.actions)
    )


@pytest.mark.slow
def test_the_snippets_of_other_pages_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """All but the files of docs/examples, which run as programs; what a snippet takes from its reader is given here."""
    scene = tmp_path / "scene.yaml"
    scene.write_text(find_blocks(ROOT / "README.md", "yaml")[0], encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    snippets = [body for page in PAGES[1:] for body in find_blocks(page, "python") if not body.startswith('"""')]
    assert len(snippets) == 2
    for snippet in snippets:
        task, X_WO = ict.load(scene), np.array([1.0, 0.0, 0.0, 0.0, 0.45, 0.2, 0.059])
        exec(snippet, {"ict": ict, "task": task, "X_WO": X_WO, "MySampler": OptimizationConfig})


def test_other_blocks_can_be_read() -> None:
    assert [tomllib.loads(body) for page in PAGES for body in find_blocks(page, "toml")]
    languages = {language for page in PAGES for language, _ in BLOCK.findall(page.read_text(encoding="utf-8"))}
    assert languages == {"", "python", "yaml", "toml", "bibtex"}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_lead_somewhere(page: Path) -> None:
    links = re.findall(r"\]\(([^)#\s]+)(?:#[^)]*)?\)", BLOCK.sub("", page.read_text(encoding="utf-8")))
    missing = [link for link in links if "://" not in link and not (page.parent / link).exists()]
    assert missing == []


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_files_of_the_checkout_that_are_named_are_there(page: Path) -> None:
    text = BLOCK.sub("", page.read_text(encoding="utf-8"))
    named = re.findall(r"`((?:benchmarks|data|docs|ictamp_drake|scripts|tests|tools)/[\w./-]+)`", text)
    assert [name for name in named if not (ROOT / name).exists()] == []


def test_the_readme_is_short() -> None:
    assert len((ROOT / "README.md").read_text(encoding="utf-8").splitlines()) <= 130
