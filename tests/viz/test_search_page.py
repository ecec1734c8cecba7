"""The page of a search, in a real browser without network."""

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ictamp_drake.core.failures import Failure
from ictamp_drake.core.types import Action, Atom, Attempt, Configuration, Skeleton
from ictamp_drake.motion.reach import Reach
from ictamp_drake.planning.tree import Tree
from ictamp_drake.viz.search_page import search_html
from ictamp_drake.world.outcome import Frame
from tests.motions import stay
from tests.viz.chromium import Chromium
from tests.viz.scene import SPEC, START, swing

PICK, PLACE = Action("pick", ("blue_box", "table")), Action("place", ("blue_box", "rack"))
STATES = tuple(
    frozenset({Atom("on", ("red_box", "table")), atom})
    for atom in (Atom("on", ("blue_box", "table")), Atom("in-hand", ("blue_box",)), Atom("on", ("blue_box", "rack")))
)
MOTION = (stay(2.0, "approach"),)

OPENED, REFUSED, PICKED, SLIPPED, PLACED = range(5)
"""Places in the log."""


def swinging_frames(start: float, end: float) -> list[Frame]:
    """A recording of two seconds."""
    return [Frame(2.0 * time, swing(start + time * (end - start))) for time in np.linspace(0.0, 1.0, 61)]


def small_tree() -> Tree[Configuration]:
    """A pick that is refused and then succeeds, and a placement that slips and then succeeds, with views of k."""
    tree = Tree(START, STATES[0])
    tree.record_opening(Skeleton(STATES, (PICK, PLACE)), expanded=1234)
    k = np.array([0.01, -0.02, 0.03, np.pi / 2])
    tree.record_step(0, 0, Attempt(PICK, Failure.NO_PATH, k=k))
    tree.record_step(0, 0, Attempt(PICK, None, swing(0.5), k=k, motion=MOTION, seconds={"physics": 0.25}))
    tree.record_step(1, 1, Attempt(PLACE, Failure.SLIPPED, swing(0.2), k=k, motion=MOTION, detail="<b> & lost"))
    tree.record_step(1, 1, Attempt(PLACE, None, swing(1.0), k=k, motion=MOTION))
    tree.candidates[2] = True
    return tree


RECORDINGS = {PICKED: swinging_frames(0.0, 0.5), SLIPPED: swinging_frames(0.5, 0.2)}
"""The last step has no recording, so the page shows only its end."""


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("search") / "search.html"
    search_html(SPEC, small_tree(), RECORDINGS, path, "small")
    return path


@pytest.fixture(scope="module")
def browser(chromium: str, page: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Chromium]:
    with Chromium(chromium, tmp_path_factory.mktemp("profile")) as browser:
        reopen(browser, page)
        yield browser


def data(page: Path) -> dict[str, Any]:
    found = re.search(r"const record = (.*);$", page.read_text(), re.MULTILINE)
    assert found is not None
    return dict(json.loads(found[1]))


def test_the_page_is_one_file_of_moderate_size(page: Path) -> None:
    assert list(page.parent.iterdir()) == [page]
    assert page.stat().st_size < 5e6


def test_the_record_in_the_page_is_that_of_the_tree(page: Path) -> None:
    record = data(page)
    assert record["tree"] == json.loads(json.dumps(small_tree().to_dict()))
    assert record["layout"]["solution"] == [0, 1, 2]
    assert record["layout"]["stubs"] == [{"node": 0, "action": str(PICK)}, {"node": 1, "action": str(PLACE)}]
    assert record["attempts"][str(PICKED)] == {"seconds": 0.25, "detail": "", "segments": [["approach", 2.0]]}


def test_a_step_without_a_posture_tells_why(tmp_path: Path) -> None:
    tree = Tree(START, STATES[0])
    tree.record_opening(Skeleton(STATES, (PICK, PLACE)), expanded=1)
    far = np.array([1.0, 0.0, 0.0, 0.0, 5.0, 0.0, 0.2])
    tree.record_step(0, 0, Attempt(PICK, Failure.NO_INVERSE_KINEMATICS, unreached=(far,)))
    tree.record_step(0, 0, Attempt(PICK, Failure.NO_INVERSE_KINEMATICS, detail="of its own", unreached=(far,)))
    search_html(SPEC, tree, {}, tmp_path / "search.html", "small")
    first, second = (attempt["detail"] for attempt in data(tmp_path / "search.html")["attempts"].values())
    assert first == Reach(SPEC).describe(far)
    assert first
    assert second == "of its own"


def test_a_second_of_motion_takes_a_few_kilobytes(page: Path) -> None:
    scene = data(page)["scene"]
    assert scene["motions"].keys() == {str(PICKED), str(SLIPPED), str(PLACED)}
    assert len(json.dumps(scene["motions"][str(PICKED)])) < 20e3
    assert scene["motions"][str(PLACED)]["end"] == 0.0
    assert all(len(times) == 1 for times, _ in scene["motions"][str(PLACED)]["tracks"])


def visible(browser: Chromium, selector: str) -> int:
    script = f"[...document.querySelectorAll('{selector}')].filter(e => e.getClientRects().length).length"
    return int(browser.run(script))


def text(browser: Chromium, name: str) -> str:
    return str(browser.run(f"document.getElementById('{name}').innerText"))


def click(browser: Chromium, element: str) -> None:
    """Click in the middle of an element, which must be visible."""
    browser.run(f"{element}.scrollIntoView({{block: 'nearest', inline: 'nearest'}})")
    x, y, there = browser.run(
        f"(() => {{ const e = {element}, b = e.getBoundingClientRect(), x = b.x + b.width / 2, y = b.y + b.height / 2;"
        " return [x, y, e.contains(document.elementFromPoint(x, y))]; })()"
    )
    assert there
    browser.run("var clicked = false; addEventListener('click', () => { clicked = true; }, {once: true}); null")
    browser.click(x, y)
    browser.wait_until("clicked")


def button(browser: Chromium, name: str) -> None:
    click(browser, f"document.getElementById('{name}')")


def disc(node: int) -> str:
    return f"[...document.querySelectorAll('#tree .number')].find(number => number.textContent === '{node}')"


def assert_shown(browser: Chromium, c: Configuration) -> None:
    """The boxes are where they are in c, in Meshcat."""
    browser.run("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")
    for name, pose in c.poses.items():
        place = json.dumps(["scene", name, name])
        x, y, z = browser.run(f"viewer.scene_tree.find({place}).object.position.toArray()")
        np.testing.assert_allclose([x, y, z], pose[4:], atol=1e-3)


def reopen(browser: Chromium, page: Path) -> None:
    """Open the page like a first-time visitor."""
    browser.open(page.as_uri())
    browser.wait_until("document.readyState === 'complete' && typeof player !== 'undefined'")


def test_the_whole_search_is_shown_first(browser: Chromium, page: Path) -> None:
    reopen(browser, page)
    assert visible(browser, "#tree .node") == 3
    assert visible(browser, "#tree .solution") == 3
    assert visible(browser, "#tree .stub") == 2
    assert text(browser, "counts") == "event 5 of 5 · 4 steps · 2 failed"
    assert_shown(browser, swing(1.0))


@pytest.mark.parametrize("width", [450, 700, 1000])
def test_the_end_is_in_sight_first_in_windows_of_any_width(browser: Chromium, page: Path, width: int) -> None:
    browser.resize(width, 700)
    reopen(browser, page)
    pane, now = (
        browser.run(f"(({{left, right}}) => [left, right])(document.querySelector('{of}').getBoundingClientRect())")
        for of in ("#tree", "#tree .now .disc")
    )
    assert pane[0] <= now[0] < now[1] <= pane[1]
    assert browser.run("document.documentElement.scrollWidth") == width
    browser.resize(1000, 700)


def test_stepping_tells_the_search_event_by_event(browser: Chromium) -> None:
    button(browser, "first")
    assert (visible(browser, "#tree .node"), visible(browser, "#tree .stub"), visible(browser, "#tree .plan")) == (
        1,
        0,
        0,
    )
    story = []
    for _ in range(5):
        button(browser, "next")
        counts = [visible(browser, f"#tree .{kind}") for kind in ("plan", "stub", "node")]
        story.append((*counts, text(browser, "event").partition(" (")[0]))
    assert story == [
        (1, 0, 1, "Plan 0 opened after 1,234 expansions: pick(blue_box, table), place(blue_box, rack)"),
        (1, 1, 1, "Node 0: pick(blue_box, table) failed, no collision-free path"),
        (1, 1, 2, "Node 0: pick(blue_box, table) led to node 1"),
        (1, 2, 2, "Node 1: place(blue_box, rack) failed, object slipped"),
        (1, 2, 3, "Node 1: place(blue_box, rack) led to node 2; the plan is finished and verified"),
    ]
    assert text(browser, "event").endswith(" (k = (0.010, -0.020, 0.030) m, 90°; 0.00 s of computing)")
    button(browser, "previous")
    assert visible(browser, "#tree .node") == 2
    assert visible(browser, "#tree .solution") == 0


def test_a_step_forward_shows_its_motion(browser: Chromium) -> None:
    browser.run("leap(2)")
    button(browser, "next")
    browser.wait_until("!player.playing")
    assert_shown(browser, swing(0.5))
    button(browser, "next")
    browser.wait_until("!player.playing")
    assert_shown(browser, swing(0.2))
    assert text(browser, "caption") == "2/2 place(blue_box, rack) – object slipped"


@pytest.mark.parametrize(
    ("verdict", "end"), [(True, "verified"), (False, "but was refused"), (None, "but no better than one before")]
)
def test_the_end_of_a_plan_is_told(browser: Chromium, tmp_path: Path, verdict: bool | None, end: str) -> None:
    tree = small_tree()
    tree.candidates[2] = verdict
    search_html(SPEC, tree, RECORDINGS, tmp_path / "search.html", "small")
    reopen(browser, tmp_path / "search.html")
    assert text(browser, "event").partition(" (")[0].endswith(end)
    assert browser.run("document.querySelectorAll('#facts .failed').length") == (verdict is False)


def test_arrow_keys_step_too(browser: Chromium) -> None:
    browser.run("leap(3); document.activeElement.blur()")
    for key, event in [("ArrowLeft", 2), ("ArrowRight", 3), ("Home", 0), ("End", 5)]:
        browser.run(f"document.body.dispatchEvent(new KeyboardEvent('keydown', {{key: '{key}', bubbles: true}}))")
        assert browser.run("moment") == event


def test_the_search_plays_to_its_end(browser: Chromium) -> None:
    browser.run("leap(3)")
    button(browser, "play")
    browser.wait_until("moment === 5 && timer === null")
    assert text(browser, "play") == "Play"


def test_a_click_while_the_search_plays_stays_where_it_was(browser: Chromium) -> None:
    browser.run("leap(3)")
    button(browser, "play")
    click(browser, disc(1))
    assert text(browser, "play") == "Play"
    browser.wait_until("!player.playing")
    assert_shown(browser, swing(0.5))


@pytest.mark.parametrize(("node", "c"), [(0, START), (1, swing(0.5)), (2, swing(1.0))])
def test_a_click_on_a_node_replays_the_way_to_it(browser: Chromium, node: int, c: Configuration) -> None:
    browser.run("leap(log.length)")
    click(browser, disc(node))
    browser.wait_until("!player.playing")
    assert_shown(browser, c)
    assert visible(browser, "#tree .way.node") == node + 1


def test_the_slider_shows_any_moment_of_the_motion(browser: Chromium) -> None:
    browser.run("choose(2, false)")
    for time in (0.0, 1.0, 2.0):
        browser.run(f"by_id('time').value = {time}; by_id('time').dispatchEvent(new Event('input')); null")
        assert_shown(browser, swing(0.25 * time))
    assert text(browser, "caption") == "1/1 pick(blue_box, table) – node 1"


def test_the_facts_of_a_node(browser: Chromium) -> None:
    browser.run("leap(log.length)")
    click(browser, disc(1))
    facts = text(browser, "facts")
    for line in [
        "Node 1",
        "pick(blue_box, table) from node 0, event 3, depth 1",
        "k = (0.010, -0.020, 0.030) m, 90° · 0.25 s of computing",
        "+ in-hand(blue_box)",
        "− on(blue_box, table)",
        "tried 2×: place(blue_box, rack)",
        "1× place(blue_box, rack): object slipped",
    ]:
        assert line in facts


def test_the_facts_of_a_failure(browser: Chromium) -> None:
    browser.run("leap(log.length)")
    click(browser, "document.querySelectorAll('#tree .stub')[1].querySelector('.tries')")
    assert "object slipped: <b> & lost" in text(browser, "facts")
    click(browser, "document.querySelectorAll('#tree .stub')[0].querySelector('.tries')")
    assert "Refused before anything was executed." in text(browser, "facts")
    assert_shown(browser, START)


def test_nothing_was_missing_on_the_page(browser: Chromium) -> None:
    browser.run("leap(log.length)")
    assert browser.problems == []
