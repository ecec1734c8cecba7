"""Evidence from attempts of an edge elsewhere in the tree: computed by hand, and its laws."""

from collections.abc import Callable, Sequence

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ictamp_drake.core.types import Action
from ictamp_drake.planning.credit import EdgeBelief, Lineage
from tests.runs.programs import run_code

STRENGTH = 2.0
LINEAGES = ((0, 1, 2), (0, 1, 3), (0, 4, 5), (0, 4, 6, 7), (0, 8))
"""Two pairs of siblings, one of them a level deeper, and a node at the end of a shorter path."""

WAY = tuple(Action("put", args) for args in (("cup", "table"), ("saucer", "table"), ("cup", "saucer")))
"""Path to a node three steps from the root."""

Attempts = Sequence[tuple[int, bool]]
attempts = st.lists(st.tuples(st.integers(0, len(LINEAGES) - 1), st.booleans()), max_size=12)
a_lineage = st.sampled_from(LINEAGES)


def learn_attempts(history: Attempts) -> EdgeBelief:
    """The belief after these attempts, in order."""
    belief = EdgeBelief(STRENGTH)
    for lineage, success in history:
        belief.learn(LINEAGES[lineage], success)
    return belief


def success_at(belief: EdgeBelief, lineage: Lineage, P: float) -> float:
    return belief.success_at(lineage, WAY[: len(lineage) - 1], P)


def success_ahead(belief: EdgeBelief, lineage: Lineage, depth: int, usual: float) -> float:
    return belief.success_ahead(lineage, WAY[:depth], usual)


def everywhere(belief: EdgeBelief) -> list[float]:
    """Success from each node and from one below each."""
    return [
        value for way in LINEAGES for value in (success_at(belief, way, 0.6), success_ahead(belief, way, len(way), 0.6))
    ]


def test_before_any_attempt_P_is_believed() -> None:
    belief = EdgeBelief(STRENGTH)
    assert success_at(belief, (0, 1), 0.3) == pytest.approx(0.3)
    assert success_ahead(belief, (0, 1), depth=2, usual=0.8) == pytest.approx(0.8)


def test_attempts_from_one_node_update_its_beta_distribution() -> None:
    belief = learn_attempts([(0, False), (0, False), (0, True)])
    assert success_at(belief, LINEAGES[0], 0.6) == pytest.approx((STRENGTH * 0.6 + 1) / (STRENGTH + 3))


def test_a_sibling_shares_the_group_until_the_last_step_decides() -> None:
    """Two of three hypotheses put siblings into one group; under the third, the failure only lowers the common mean."""
    belief = learn_attempts([(0, False)])
    shared = STRENGTH * 0.6 / (STRENGTH + 1)
    alone = STRENGTH * 0.6 / (STRENGTH + STRENGTH / (STRENGTH + 1))
    assert success_at(belief, LINEAGES[1], 0.6) == pytest.approx((2 * shared + alone) / 3)


def test_the_earlier_a_step_is_repeated_the_more_hope() -> None:
    belief = learn_attempts([(0, False)] * 20)
    hopes = [success_ahead(belief, LINEAGES[0][: kept + 1], depth=2, usual=0.6) for kept in range(2)]
    assert hopes[0] > 1.5 * hopes[1] > 3 * success_at(belief, LINEAGES[0], 0.6)


def test_repeating_a_step_gives_less_hope_each_time_it_did_not_help() -> None:
    belief, hopes = EdgeBelief(STRENGTH), list[float]()
    for node in range(2, 8):
        for _ in range(5):
            belief.learn((0, 1, node), success=False)
        hopes.append(success_ahead(belief, (0, 1), depth=2, usual=0.6))
    assert hopes == sorted(hopes, reverse=True)
    assert hopes[-1] < 0.4 * hopes[0]


def test_P_of_a_node_to_come_is_like_that_of_nodes_nearby() -> None:
    belief = EdgeBelief(STRENGTH)
    for node in (2, 3, 4):
        belief.see((0, 1, node), 0.1)
    anywhere = (0.9 + 3 * 0.1) / 4
    below_1 = (anywhere + 3 * 0.1) / 4
    assert success_ahead(belief, (0, 1), depth=2, usual=0.9) == pytest.approx(below_1)
    assert success_ahead(belief, (0,), depth=2, usual=0.9) == pytest.approx(anywhere)


def test_a_failure_between_objects_is_blamed_on_the_steps_that_put_them_there() -> None:
    """The cup hits the saucer, so moving the saucer or the cup onto it may help; the cup's earlier move may not."""
    belief = EdgeBelief(STRENGTH)
    for _ in range(500):
        belief.learn((0, 1, 2, 3), success=False)
        belief.blame({"cup", "saucer"})
    hopes = [success_ahead(belief, (0, 1, 2, 3)[: kept + 1], depth=3, usual=0.6) for kept in range(4)]
    assert hopes[0] == pytest.approx(hopes[1], rel=0.01)
    assert hopes[1] > 1.5 * hopes[2] > 10 * hopes[3]


def test_between_objects_that_nothing_moved_there_is_no_hope_in_repeating_steps() -> None:
    belief = EdgeBelief(STRENGTH)
    for _ in range(500):
        belief.learn((0, 1, 2, 3), success=False)
        belief.blame({"shelf"})
    assert success_ahead(belief, (0,), depth=3, usual=0.6) < 0.01


@given(blamed=st.lists(st.sets(st.sampled_from(["cup", "saucer", "table", "shelf"])), max_size=5))
def test_blame_alone_changes_nothing(blamed: list[set[str]]) -> None:
    belief = EdgeBelief(STRENGTH)
    for objects in blamed:
        belief.blame(objects)
    assert everywhere(belief) == pytest.approx([0.6] * 2 * len(LINEAGES))


@given(history=attempts)
def test_beliefs_are_probabilities(history: Attempts) -> None:
    assert all(0 < value < 1 for value in everywhere(learn_attempts(history)))


@given(history=attempts, where=st.integers(0, len(LINEAGES) - 1))
def test_no_failure_raises_and_no_success_lowers_any_belief(history: Attempts, where: int) -> None:
    now, failed, succeeded = (
        everywhere(learn_attempts([*history, *more])) for more in ([], [(where, False)], [(where, True)])
    )
    for before, worse, better in zip(now, failed, succeeded, strict=True):
        assert worse <= before + 1e-9
        assert better >= before - 1e-9


@given(history=attempts, data=st.data())
def test_the_order_of_attempts_from_nodes_none_of_which_is_below_another_does_not_matter(
    history: Attempts, data: st.DataObject
) -> None:
    """Attempts from below a node count as its own where r exceeds its depth, but only if they came before its own."""
    shuffled = data.draw(st.permutations(history))
    assert everywhere(learn_attempts(shuffled)) == pytest.approx(everywhere(learn_attempts(history)))


@given(history=attempts, way=a_lineage)
def test_to_ask_changes_nothing(history: Attempts, way: tuple[int, ...]) -> None:
    asked = EdgeBelief(STRENGTH)
    for lineage, success in history:
        success_ahead(asked, way, depth=3, usual=0.6)
        asked.learn(LINEAGES[lineage], success)
    plain = learn_attempts(history)
    success_ahead(plain, way, depth=3, usual=0.6)
    assert everywhere(asked) == pytest.approx(everywhere(plain))


@pytest.mark.parametrize(
    "learn",
    [
        lambda belief: belief.see((0, 1, 2), 0.1),
        lambda belief: belief.learn((0, 1, 2), success=True),
        lambda belief: belief.blame({"cup"}),
        lambda belief: belief.success_ahead((0,), 2 * WAY, 0.6),
    ],
    ids=["P", "attempt", "blame", "longer way"],
)
def test_news_count_where_it_was_asked_before(learn: Callable[[EdgeBelief], object]) -> None:
    asked, fresh = (learn_attempts([(3, False)] * 3) for _ in range(2))
    before = everywhere(asked)
    learn(asked)
    learn(fresh)
    assert before != everywhere(asked) == everywhere(fresh)


def belief_with_blame() -> EdgeBelief:
    """The belief when each failure was between other objects."""
    belief = learn_attempts([(0, False)] * 6)
    for objects in (("cup",), ("saucer", "shelf"), ("cup", "saucer"), ("shelf",), ("table", "cup"), ()):
        belief.blame(objects)
    return belief


@pytest.mark.parametrize("hash_seed", [1, 2])
def test_beliefs_do_not_depend_on_the_order_of_sets(hash_seed: int) -> None:
    """They agree to the last bit, which decides between equals."""
    code = (
        "from tests.planning.test_credit import belief_with_blame, everywhere; print(everywhere(belief_with_blame()))"
    )
    assert run_code(code, hash_seed) == f"{everywhere(belief_with_blame())}\n"
