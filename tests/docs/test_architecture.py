"""The drawing in docs/architecture.md matches today's imports, and everything that the page names exists."""

import re
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).parents[2]
PACKAGE = ROOT / "ictamp_drake"
PAGE = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def rooms() -> ModuleType:
    spec = spec_from_file_location("draw_rooms", ROOT / "scripts" / "draw_rooms.py")
    assert spec is not None
    assert spec.loader is not None
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_drawing_is_up_to_date(rooms: ModuleType) -> None:
    drawn = rooms.DRAWING.read_text(encoding="utf-8")
    assert drawn == rooms.draw(rooms.read_imports()), "run `python scripts/draw_rooms.py`"


def test_an_arrow_that_follows_from_others_is_left_out(rooms: ModuleType) -> None:
    imports = {"top": frozenset({"middle", "base"}), "middle": frozenset({"base"}), "base": frozenset()}
    assert rooms.find_arrows(imports) == [("middle", "base"), ("top", "middle")]
    assert rooms.find_floors(imports) == {"top": 2, "middle": 1, "base": 0}


def test_the_page_introduces_every_room_and_no_other(rooms: ModuleType) -> None:
    assert set(re.findall(r"\*\*`([\w.]+)`\*\*", PAGE)) == set(rooms.read_imports())


@pytest.mark.parametrize("name", sorted(set(re.findall(r"`((?:[a-z_]+\.)+[a-z_]+)`", PAGE))))
def test_a_module_that_the_page_names_exists(name: str) -> None:
    if name.rpartition(".")[2] in {"yaml", "jsonl", "toml"}:
        pytest.skip("a file of a run or of the checkout")
    room, module, *attribute = name.split(".")
    assert (PACKAGE / room / f"{module}.py").is_file()
    assert all(
        re.search(rf"^(def|class) {each}\b", (PACKAGE / room / f"{module}.py").read_text(), re.M) for each in attribute
    )
