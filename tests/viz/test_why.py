"""The page of a search that found no plan, in a real browser: refused actions and their obstacles."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from ictamp_drake.core.failures import Failure
from ictamp_drake.core.types import Action, Attempt, Configuration, Skeleton
from ictamp_drake.planning.tree import Tree
from ictamp_drake.viz.reasons import MOVED, OBSTACLE, WHERE, Reasons, RefusedAction
from ictamp_drake.viz.search_page import search_html
from tests.viz.chromium import Chromium
from tests.viz.scene import SPEC, START, swing
from tests.viz.test_search_page import MOTION, PICK, PLACE, STATES, assert_shown, reopen, small_tree, text

IN_THE_WAY = RefusedAction(
    action=str(PLACE),
    args=("blue_box", "rack"),
    refused="9 of 9 placements: in collision",
    obstacles={"red_box": 8, "panda_link5": 1},
    advice="make <room>",
)
OUT_OF_REACH = RefusedAction(
    action="place(red_box, rack)", args=("red_box", "rack"), refused="2 of 2 placements: too far"
)
REASONS = Reasons("the time limit was reached", (IN_THE_WAY, OUT_OF_REACH), ("it was slow",))


def blocked_tree() -> Tree[Configuration]:
    """Tree of a search in which a box is picked up and cannot be put down."""
    tree = Tree(START, STATES[0])
    tree.record_opening(Skeleton(STATES, (PICK, PLACE)), expanded=1)
    tree.record_step(0, 0, Attempt(PICK, None, swing(0.5), motion=MOTION))
    tree.record_step(1, 1, Attempt(PLACE, Failure.GOAL_IN_COLLISION))
    tree.record_step(1, 1, Attempt(Action("place", ("red_box", "rack")), Failure.NO_INVERSE_KINEMATICS))
    tree.record_step(0, 0, Attempt(PICK, Failure.NO_PATH))
    return tree


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("why") / "search.html"
    search_html(SPEC, blocked_tree(), {}, path, "blocked", reasons=REASONS)
    return path


@pytest.fixture(scope="module")
def browser(chromium: str, page: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Chromium]:
    with Chromium(chromium, tmp_path_factory.mktemp("profile")) as browser:
        reopen(browser, page)
        browser.wait_until(
            "viewer.scene_tree.children.scene?.children.rack?.object.getObjectByProperty('type', 'Mesh')"
        )
        yield browser


def press(browser: Chromium, number: int) -> None:
    browser.run(f"document.querySelectorAll('.refusal')[{number}].click()")


def looks(browser: Chromium, name: str) -> tuple[tuple[int, ...], bool]:
    """Mean color of an object, 0 to 255, and whether it is transparent."""
    red, green, blue, clear = browser.run(
        "(() => { paint(); const materials = [];"
        f"  viewer.scene_tree.find(['scene', '{name}']).object.traverse(o => o.material && materials.push(o.material));"
        "  const sum = materials.reduce((s, {color: c}) => [s[0] + c.r, s[1] + c.g, s[2] + c.b], [0, 0, 0]);"
        "  return [...sum.map(v => v / materials.length), materials.some(m => m.transparent)]; })()"
    )
    return tuple(round(255 * value) for value in (red, green, blue)), clear


def test_the_reasons_are_told(browser: Chromium) -> None:
    said = text(browser, "why")
    for part in ("The time limit was reached", "It was slow", "9 of 9 placements", "red_box (8)", "make <room>"):
        assert part in said


def test_the_first_refusal_is_shown_where_it_happened(browser: Chromium) -> None:
    assert "Failed step from node 1" in text(browser, "facts")
    assert_shown(browser, swing(0.5))
    assert looks(browser, "blue_box")[1] is False
    assert looks(browser, "red_box")[1] is True
    assert looks(browser, "robot")[1] is True


def test_what_is_marked_follows_the_choice(browser: Chromium) -> None:
    press(browser, 0)  # which was chosen
    plain = {name: looks(browser, name) for name in ("red_box", "blue_box", "rack", "robot")}
    assert not any(clear for _, clear in plain.values())
    press(browser, 1)
    assert browser.run("document.querySelectorAll('.refusal[aria-pressed=true]').length") == 1
    assert looks(browser, "red_box")[1] is False
    assert looks(browser, "rack")[0] != plain["rack"][0]
    assert looks(browser, "blue_box")[1] is True
    press(browser, 1)
    assert {name: looks(browser, name) for name in plain} == plain
    press(browser, 0)


def test_pointing_at_a_refusal_marks_it_meanwhile(browser: Chromium) -> None:
    before = looks(browser, "rack")
    browser.run("document.querySelectorAll('.refusal')[1].dispatchEvent(new PointerEvent('pointerenter')); null")
    assert looks(browser, "rack") != before
    browser.run("document.querySelectorAll('.refusal')[1].dispatchEvent(new PointerEvent('pointerleave')); null")
    assert looks(browser, "rack") == before


def test_nothing_was_missing_on_the_page(browser: Chromium) -> None:
    assert browser.problems == []


def test_a_search_that_found_a_plan_has_no_reasons(browser: Chromium, tmp_path: Path) -> None:
    search_html(SPEC, small_tree(), {}, tmp_path / "search.html", "solved")
    reopen(browser, tmp_path / "search.html")
    assert browser.run("by_id('why').getClientRects().length") == 0


def test_colors_tell_the_part_that_a_thing_plays() -> None:
    assert IN_THE_WAY.colors == {"red_box": OBSTACLE, "panda_link5": OBSTACLE, "blue_box": MOVED}
    assert OUT_OF_REACH.colors == {"rack": WHERE, "red_box": MOVED}
    assert REASONS.colors == {"rack": WHERE, "red_box": MOVED, "blue_box": MOVED, "panda_link5": OBSTACLE}
