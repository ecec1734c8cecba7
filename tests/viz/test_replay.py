"""The page of a recording, in a real browser without network."""

import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from pydrake.geometry import Role

from ictamp_drake.core.types import Action, Attempt
from ictamp_drake.viz.page import Caption
from ictamp_drake.viz.replay import plan_captions, replay_html
from ictamp_drake.viz.stage import Stage
from tests.motions import stay
from tests.viz.chromium import Chromium
from tests.viz.scene import DURATION, SPEC, START, recording

HALF = DURATION / 2
CAPTIONS = [Caption(0.0, HALF, "1/2 pick(red_box, table) – grasp"), Caption(HALF, DURATION, "2/2 </script> – lower")]

MESHES = """(() => {
  let count = 0;
  viewer.scene_tree.find(["scene"]).object.traverse(part => { count += part.isMesh ? 1 : 0; });
  return count;
})()"""
MIDDLE = """name => {
  const rows = [...document.querySelectorAll(".dg .property-name")];
  const box = rows.find(row => row.textContent === name).getBoundingClientRect();
  return [box.x + box.width / 2, box.y + box.height / 2];
}"""
PIXEL = """(() => {
  const part = viewer.scene_tree.find(PATH).object;
  const p = new MeshCat.THREE.Vector3().setFromMatrixPosition(part.matrixWorld).project(viewer.camera);
  return [(p.x + 1) / 2 * window.innerWidth, (1 - p.y) / 2 * window.innerHeight];
})()"""


def test_captions_name_every_segment_of_every_skill() -> None:
    pick = Attempt(Action("pick", ("a", "b")), None, motion=(stay(1.0, "approach"), stay(0.5, "grasp")))
    place = Attempt(Action("place", ("a", "rack")), None, motion=(stay(2.0, "lower"),))
    assert plan_captions([pick, place], [0.0, 1.75]) == [
        Caption(0.0, 1.0, "1/2 pick(a, b) – approach"),
        Caption(1.0, 1.5, "1/2 pick(a, b) – grasp"),
        Caption(1.75, 3.75, "2/2 place(a, rack) – lower"),
    ]


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("replay") / "replay.html"
    replay_html(SPEC, recording(), CAPTIONS, path)
    return path


def test_the_page_is_one_file_of_moderate_size(page: Path) -> None:
    assert list(page.parent.iterdir()) == [page]
    assert page.stat().st_size < 8e6


def test_what_stands_still_costs_nothing(page: Path, tmp_path: Path) -> None:
    longer = [frame._replace(c=START) for frame in recording()]
    replay_html(SPEC, longer, CAPTIONS, tmp_path / "still.html")
    replay_html(SPEC, longer[:1], CAPTIONS, tmp_path / "short.html")
    still, short = ((tmp_path / name).stat().st_size for name in ("still.html", "short.html"))
    assert abs(still - short) < 100 < page.stat().st_size - still


@pytest.fixture(scope="module")
def browser(chromium: str, page: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Chromium]:
    with Chromium(chromium, tmp_path_factory.mktemp("profile")) as browser:
        browser.open(page.as_uri())
        browser.wait_until("typeof viewer !== 'undefined' && viewer.animator.duration > 0")
        browser.wait_until(f"{MESHES} === {visible_shapes()}")
        yield browser


def visible_shapes() -> int:
    stage = Stage(SPEC)
    inspector = stage.shapes(START).inspector()
    return inspector.NumGeometriesWithRole(Role.kIllustration)


def seek(browser: Chromium, time: float) -> np.ndarray:
    """Move the slider, and take a picture."""
    browser.run(f"viewer.animator.pause(); viewer.animator.time_scrubber.setValue({time}); null")
    browser.run("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")
    return browser.picture()


def pixel(browser: Chromium, *path: str) -> tuple[int, int]:
    """Place of a body's origin in the window: column, row."""
    x, y = browser.run(PIXEL.replace("PATH", json.dumps(["scene", *path])))
    return round(x), round(y)


def color_around(picture: np.ndarray, place: tuple[int, int]) -> np.ndarray:
    """Mean color of several pixels."""
    x, y = place
    return picture[y - 2 : y + 3, x - 2 : x + 3].mean(axis=(0, 1))


def caption(browser: Chromium) -> str:
    return str(browser.run("document.getElementById('caption').innerText"))


def control(browser: Chromium, name: str) -> tuple[float, float]:
    """Middle of a row of Meshcat's controls, which must be visible."""
    x, y = browser.run(f"({MIDDLE})({json.dumps(name)})")
    assert browser.run(f"document.elementFromPoint({x}, {y}).textContent") == name
    return x, y


def test_the_page_plays_by_itself_and_its_buttons_are_at_hand(browser: Chromium) -> None:
    assert browser.run("viewer.animator.duration") == pytest.approx(DURATION, abs=1e-3)
    browser.wait_until("viewer.animator.time > 0.1")
    browser.click(*control(browser, "pause"))
    browser.wait_until("!viewer.animator.playing")
    assert browser.run("viewer.animator.time") < DURATION
    browser.click(*control(browser, "reset"))
    browser.wait_until("viewer.animator.time === 0")
    x, y = control(browser, "time")
    browser.click(x + 120, y)  # the slider is right of its name
    browser.wait_until(f"viewer.animator.time > {DURATION / 4}")
    browser.click(*control(browser, "reset"))
    browser.click(*control(browser, "play"))
    browser.wait_until("viewer.animator.playing && viewer.animator.time > 0.1")


def test_the_scene_is_drawn(browser: Chromium) -> None:
    picture = seek(browser, 0.0)
    red, green, blue = color_around(picture, pixel(browser, "red_box", "red_box"))
    assert red > 2 * green
    assert red > 2 * blue
    red, green, blue = color_around(picture, pixel(browser, "blue_box", "blue_box"))
    assert blue > 2 * red
    arm = color_around(picture, pixel(browser, "robot", "panda", "panda_link2"))
    assert arm.min() > 0.6, "the arm is white"
    red, green, blue = color_around(picture, pixel(browser, "table", "table"))
    assert red > green > blue, "the table is of wood"


def test_the_animation_moves_the_arm_and_what_it_carries(browser: Chromium) -> None:
    first = seek(browser, 0.0)
    places = [pixel(browser, "robot", "panda", "panda_hand"), pixel(browser, "blue_box", "blue_box")]
    still = pixel(browser, "red_box", "red_box")
    last = seek(browser, DURATION)
    for place in places:
        assert np.abs(color_around(first, place) - color_around(last, place)).max() > 0.1
    assert np.abs(color_around(first, still) - color_around(last, still)).max() < 0.02
    moved = pixel(browser, "robot", "panda", "panda_hand")
    assert np.hypot(*np.subtract(moved, places[0])) > 50
    red, _, blue = color_around(last, pixel(browser, "blue_box", "blue_box"))
    assert blue > 2 * red


def test_the_names_of_the_skills_follow_the_slider(browser: Chromium) -> None:
    seek(browser, 0.25 * DURATION)
    assert caption(browser) == CAPTIONS[0].text
    seek(browser, 0.75 * DURATION)
    assert caption(browser) == CAPTIONS[1].text
    seek(browser, DURATION)
    assert caption(browser) == ""


def test_nothing_was_missing_on_the_page(browser: Chromium) -> None:
    seek(browser, DURATION)
    assert browser.problems == []
