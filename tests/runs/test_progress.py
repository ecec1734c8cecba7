"""Output while a run works, with and without a terminal."""

from io import StringIO
from multiprocessing import get_context

from rich.console import Console

from ictamp_drake.core.types import Action, Atom, Attempt, Skeleton
from ictamp_drake.planning.events import PlanOpened, StepDone, StepStarted
from ictamp_drake.planning.tree import Node
from ictamp_drake.runs.board import Board
from ictamp_drake.runs.progress import Progress, format_clock, outcome
from ictamp_drake.runs.records import Record

PICK = Action("pick", ("red_box", "table"))


def record(problem: str, **values: object) -> Record:
    return Record(
        **{"level": None, "seed": 0, "stop_reason": "SOLVED", "planning_time_s": 12.34, **values}, problem=problem
    )  # type: ignore[arg-type]


def begin_work(board: Board, slot: int) -> None:
    """A worker begins, opens a plan, fails at one step and begins another."""
    node = Node(0, 0, frozenset({Atom("at", ("0",))}))
    board.start(slot)
    board.tell(slot, PlanOpened(Skeleton((node.s,), ()), 10, exhausted=False))
    board.tell(slot, PlanOpened(None, 1000, exhausted=False))
    board.tell(slot, StepStarted(node, PICK))
    board.tell(slot, StepDone(node, Attempt(PICK, None), None))
    board.tell(slot, StepStarted(node, PICK))


def test_the_board_shows_who_is_at_what() -> None:
    board = Board(get_context("spawn"), 3)
    begin_work(board, 1)
    (running,) = board.list_running()
    assert (running.slot, running.plans, running.steps, running.doing) == (1, 1, 1, "pick(red_box, table)")
    assert running.seconds >= 0
    board.finish(1)
    assert not list(board.list_running())


def test_the_board_takes_names_of_any_length() -> None:
    board = Board(get_context("spawn"), 1)
    board.start(0)
    board.tell(0, StepStarted(Node(0, 0, frozenset()), Action("pick", ("ö" * 99, "table"))))
    (running,) = board.list_running()
    assert running.doing.startswith("pick(öö")


def test_a_terminal_shows_what_is_going_on() -> None:
    board = Board(get_context("spawn"), 2)
    begin_work(board, 1)
    output = StringIO()
    console = Console(file=output, force_terminal=True, width=100)
    with Progress(console, ["easy-003", "easy-004"], total=5, solved=2) as progress:
        progress(board, [record("easy-003", solved=True, plan_length=6)])
        board.url = "http://localhost:7003"
        board.stop()
        progress(board, [])
    shown = output.getvalue()
    assert "4 of 5 done, 3 solved, 1 left" in shown
    assert "easy-004" in shown
    assert "pick(red_box, table)" in shown
    assert "live view at http://localhost:7003" in shown
    assert "stopping after the steps under way" in shown


def test_without_a_terminal_there_is_one_line_for_each_finished_problem() -> None:
    board = Board(get_context("spawn"), 2)
    begin_work(board, 1)
    output = StringIO()
    with Progress(Console(file=output, width=80), ["a", "b"], total=2, solved=0) as progress:
        progress(board, [])
        progress(board, [record("a", stop_reason="OUT_OF_TIME", high_level_plans=2, low_level_steps=1)])
        progress(board, [])
    assert output.getvalue() == "a  not solved after 12.3 s (2 plans, 1 step): the time limit was reached\n"


def test_the_outcome_of_a_broken_problem_ends_with_the_cause() -> None:
    line = outcome(record("a", stop_reason="CRASHED", error="Traceback\n  ...\nValueError: no\n")).plain
    assert line == "a  crashed after 12.3 s (0 plans, 0 steps): ValueError: no"


def test_the_outcome_names_strategy_and_seed_where_there_are_several() -> None:
    line = outcome(record("easy-003", strategy="els", seed=7, solved=True, plan_length=6)).plain
    assert line.startswith("els/7/easy-003  solved with 6 skills")


def test_times_are_readable() -> None:
    assert [format_clock(seconds) for seconds in (0.9, 7, 750, 3723)] == ["0:00", "0:07", "12:30", "1:02:03"]
