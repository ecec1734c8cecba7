"""Obstructions that a search learns: computed by hand, with actions on a table."""

import math

from ictamp_drake.core.failures import Failure
from ictamp_drake.core.types import Action, Attempt, Obstruction
from ictamp_drake.planning.obstructions import Obstructions, boxes_moved_by
from tests.symbolic.towers import state

INITIAL = state([("table", "low"), ("table", "tall"), ("table", "other")])
PICK = Action("pick", ("low", "table"))
PLACE = Action("place", ("low", "shelf"))
ASIDE = (Action("pick", ("tall", "table")), Action("place", ("tall", "table")))


class Search:
    """Picks that succeed, or fail at one obstacle for each k."""

    def __init__(self, patience: float = 2.0) -> None:
        self.obstructions = Obstructions(patience)

    def fail(self, *obstacles: str, way: tuple[Action, ...] = (), times: int = 1) -> None:
        first, *rejections = [Failure.GOAL_IN_COLLISION] * len(obstacles)
        for _ in range(times):
            attempt = Attempt[object](PICK, first, rejections=tuple(rejections), obstacles=obstacles)
            self.obstructions.learn(INITIAL, way, attempt, success=False)

    def succeed(self, way: tuple[Action, ...] = ()) -> None:
        self.obstructions.learn(INITIAL, way, Attempt[object](PICK, None), success=True)


def test_a_box_at_which_an_action_fails_again_and_again_is_in_its_way() -> None:
    search = Search()
    search.fail("tall")
    assert search.obstructions.boxes(PICK) == frozenset()
    search.fail("other")
    search.fail("tall")
    assert search.obstructions.boxes(PICK) == {"tall"}
    assert search.obstructions.boxes(PLACE) == frozenset()
    assert search.obstructions.list_before([PLACE, PICK]) == {Obstruction(PICK, "tall")}


def test_each_box_has_its_share_in_a_failure() -> None:
    search = Search()
    search.fail("tall", "tall", "other", "tall", times=3)
    assert search.obstructions.boxes(PICK) == {"tall"}
    search.fail("tall", "tall", "other", "tall", times=5)
    assert search.obstructions.boxes(PICK) == {"tall", "other"}


def test_a_box_that_was_moved_is_not_where_it_stood_at_first() -> None:
    search = Search()
    search.fail("tall", way=ASIDE, times=9)
    assert search.obstructions.boxes(PICK) == frozenset()


def test_what_an_action_itself_speaks_of_is_not_in_its_way() -> None:
    search = Search()
    search.fail("low", "table", times=9)
    assert search.obstructions.boxes(PICK) == frozenset()


def test_what_cannot_be_moved_is_not_in_its_way() -> None:
    search = Search()
    search.fail("rack", "link6", times=9)
    assert search.obstructions.boxes(PICK) == frozenset()


def test_successes_in_spite_of_a_box_count_for_it() -> None:
    search = Search()
    search.fail("tall", times=3)
    search.succeed(way=ASIDE)
    assert search.obstructions.boxes(PICK) == {"tall"}
    search.succeed()
    assert search.obstructions.boxes(PICK) == frozenset()
    search.fail("tall")
    assert search.obstructions.boxes(PICK) == {"tall"}


def test_infinite_patience_leaves_all_boxes_where_they_are() -> None:
    search = Search(math.inf)
    search.fail("tall", times=50)
    assert search.obstructions.list_before([PICK]) == frozenset()


def test_a_way_moves_the_first_argument_of_its_actions() -> None:
    assert boxes_moved_by([*ASIDE, PLACE, Action("wait", ())]) == {"tall", "low"}
