"""The reader of PDDL: the domains that it reads, those that it refuses, and agreement with unified-planning."""

from functools import cache
from importlib.resources import files

import pytest
from hypothesis import given, settings
from unified_planning.engines import SequentialPlanValidator
from unified_planning.plans import ActionInstance, SequentialPlan

from ictamp_drake.core.errors import Code, IctampError, Where
from ictamp_drake.core.types import Action, Atom
from ictamp_drake.symbolic.context import GeneratorContext
from ictamp_drake.symbolic.expressions import MAX_DEPTH
from ictamp_drake.symbolic.formulas import TRUE, And, Equal, Exists, Not, Or, Variable
from ictamp_drake.symbolic.operators import Effect, Operator
from ictamp_drake.symbolic.pddl import boxes_domain, read_domain
from ictamp_drake.symbolic.skeletons import BestFirst, BreadthFirst
from tests.refusals import refusal
from tests.symbolic import theirs
from tests.symbolic.towers import LEVELS, Problem, problems

HEAD = """(define (domain toy)
  (:types box tray - thing thing place)
  (:constants home - place)
  (:predicates (at ?t - thing ?p - place) (open ?b - box) (dark))
"""


def domain(body: str) -> str:
    return f"{HEAD}  {body})"


def read_action(text: str) -> Operator:
    (operator,) = read_domain(domain(f"(:action act {text})"), "toy.pddl").operators
    return operator


def test_declarations_are_read() -> None:
    found = read_domain(domain("(:action go :parameters (?t - thing ?p - place) :effect (at ?t ?p))"), "toy.pddl")
    assert found.types == {"box": "thing", "tray": "thing", "thing": "object", "place": "object"}
    assert found.constants == {"home": "place"}
    assert found.predicates == {"at": ("thing", "place"), "open": ("box",), "dark": ()}
    effect = Effect((), TRUE, Atom("at", ("?t", "?p")), adds=True)
    assert found.operators == (Operator("go", (Variable("?t", "thing"), Variable("?p", "place")), TRUE, (effect,)),)


def test_case_does_not_count() -> None:
    text = domain("(:action go :parameters (?t - thing) :precondition (at ?t home))")
    assert read_domain(text.upper(), "toy.pddl") == read_domain(text, "toy.pddl")


def test_what_is_left_out_asks_for_nothing_and_does_nothing() -> None:
    assert read_action("") == Operator("act", (), TRUE, ())
    assert read_action(":parameters () :precondition () :effect ()") == Operator("act", (), TRUE, ())
    assert read_action(":precondition (and) :effect (and)") == Operator("act", (), TRUE, ())


def test_imply_and_forall_are_written_with_or_and_exists() -> None:
    dark, x = Atom("dark", ()), Variable("?x", "box")
    is_open = Atom("open", ("?x",))
    assert read_action(":precondition (imply (dark) (not (dark)))").precondition == Or((Not(dark), Not(dark)))
    assert read_action(":precondition (exists (?x - box) (open ?x))").precondition == Exists((x,), is_open)
    everything = read_action(":precondition (forall (?x - box) (imply (open ?x) (dark)))").precondition
    assert everything == Not(Exists((x,), And((is_open, Not(dark)))))


def test_effects_are_laid_flat() -> None:
    operator = read_action("""
        :parameters (?b - box)
        :effect (and
          (not (dark))
          (forall (?x - box) (when (= ?x ?b) (when (dark) (and (open ?x) (not (at ?x home)))))))""")
    x, both = (Variable("?x", "box"),), And((Equal(("?x", "?b")), Atom("dark", ())))
    assert operator.effects == (
        Effect((), TRUE, Atom("dark", ()), adds=False),
        Effect(x, both, Atom("open", ("?x",)), adds=True),
        Effect(x, both, Atom("at", ("?x", "home")), adds=False),
    )


@pytest.mark.parametrize(
    ("body", "line", "value"),
    [
        ("(:action", 5, None),
        ("(:functions (cost))", 5, None),
        ("word", 1, None),
        ("(:requirements :strips :durative-actions)", 5, None),
        ("(:types a - b b - a)", 5, None),
        ("(:types cup - (either box tray))", 5, None),
        ("(:types cup -)", 5, None),
        ("(:constants here - spot)", 5, "spot"),
        ("(:constants ?x - box)", 5, "?x"),
        ("(:predicates (at ?a))", 5, None),
        ("(:predicates (when ?a))", 5, None),
        ("(:predicates by)", 5, None),
        ("(:action a)\n(:action a)", 6, None),
        ("(:action a :parameters)", 5, None),
        ("(:action a :effects (dark))", 5, None),
        ("(:action a :effect (dark) :effect (dark))", 5, None),
        ("(:action a :parameters ?x)", 5, "?x"),
        ("(:action a :parameters (x))", 5, "x"),
        ("(:action a :parameters (?x ?x))", 5, "?x"),
        ("(:action a :precondition dark)", 5, "dark"),
        ("(:action a :precondition (near home))", 5, None),
        ("(:action a\n:precondition (open))", 6, "(open)"),
        ("(:action a :precondition (open ?x))", 5, "?x"),
        ("(:action a :parameters (?t - thing) :precondition (open ?t))", 5, "(open ?t)"),
        ("(:action a :precondition (not))", 5, None),
        ("(:action a :precondition (imply (dark)))", 5, None),
        ("(:action a :precondition (forall ?x (dark)))", 5, None),
        ("(:action a :precondition (= home))", 5, None),
        ("(:action a :precondition (= home there))", 5, "there"),
        ("(:action a :precondition (when (dark) (dark)))", 5, None),
        ("(:action a :effect (or (dark) (dark)))", 5, None),
        ("(:action a :effect (not (and (dark))))", 5, None),
        ("(:action a :parameters (?b - box) :precondition (exists (?b - box) (open ?b)))", 5, "(?b - box)"),
    ],
)
def test_what_is_wrong_is_named_with_its_line(body: str, line: int, value: str | None) -> None:
    with pytest.raises(IctampError) as caught:
        read_domain(domain(body) if body != "(:action" else f"{HEAD}(:action", "toy.pddl")
    error = caught.value
    assert (error.code, error.where) == (Code.NOT_PDDL, Where("toy.pddl", line))
    assert value is None or error.value == value
    assert len(str(error)) < 400


def test_what_is_no_domain_is_refused() -> None:
    with refusal(Code.NOT_PDDL, file="toy.pddl", line=1):
        read_domain("(define (problem toy))", "toy.pddl")


@pytest.mark.parametrize("connective", ["and", "not", "imply (dark)", "exists (?x{} - box)"])
def test_formulas_may_be_as_deep_as_brackets(connective: str) -> None:
    depth = MAX_DEPTH - 3
    opened = "".join(f"({connective.format(level)} " for level in range(depth))
    assert read_action(f":precondition {opened}(dark){')' * depth}").name == "act"
    with refusal(Code.TOO_DEEP):
        read_action(f":precondition {opened}(and (dark)){')' * depth}")


def test_a_long_chain_of_types_is_read() -> None:
    chain = " ".join(f"t{number} - t{number + 1}" for number in range(5000))
    assert len(read_domain(f"(define (domain chain) (:types {chain}))", "chain.pddl").types) == 5001


@cache
def text() -> str:
    return (files("ictamp_drake.symbolic") / "domain.pddl").read_text()


def test_the_domain_of_boxes_reads_as_it_does_elsewhere() -> None:
    other = theirs.problem(text(), {}, frozenset())
    assert [fluent.name for fluent in other.fluents] == list(boxes_domain().predicates)
    assert {kind.name: kind.father.name if kind.father else "object" for kind in other.user_types} == (
        boxes_domain().types
    )
    for action, operator in zip(other.actions, boxes_domain().operators, strict=True):
        assert action.name == operator.name
        assert [(f"?{each.name}", each.type.name) for each in action.parameters] == list(operator.parameters)


def is_valid(problem: Problem, actions: tuple[Action, ...]) -> bool:
    objects = dict.fromkeys(problem.boxes, "box") | dict.fromkeys(problem.supports, "support")
    other = theirs.problem(text(), objects, problem.initial, problem.goal.mentioned)
    steps = [
        ActionInstance(other.action(name), tuple(map(other.environment.expression_manager.ObjectExp, given)))
        for name, given in ((name, map(other.object, args)) for name, args in actions)
    ]
    return bool(SequentialPlanValidator().validate(other, SequentialPlan(steps)))


@pytest.mark.parametrize("config", [BreadthFirst(), BestFirst()], ids=["breadth_first", "best_first"])
@pytest.mark.parametrize("problem", LEVELS.values(), ids=LEVELS)
def test_the_validator_accepts_our_plans_and_no_broken_ones(problem: Problem, config: BreadthFirst | BestFirst) -> None:
    stream = config.create(GeneratorContext(problem.domain, problem.initial, problem.goal))
    plans = [plan for plan in (stream.next_plan(1000) for _ in range(10)) if plan is not None]
    assert len(plans) == 10
    for plan in plans:
        assert is_valid(problem, plan.actions)
    assert not is_valid(problem, plans[0].actions[:-1])
    assert not is_valid(problem, plans[0].actions[1:])


@settings(max_examples=20)
@given(problems(boxes=4))
def test_the_validator_agrees_on_scenes_with_tipped_boxes(problem: Problem) -> None:
    plan = BestFirst().create(GeneratorContext(problem.domain, problem.initial, problem.goal)).next_plan(1000)
    assert plan is not None
    assert is_valid(problem, plan.actions)
