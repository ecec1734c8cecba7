"""Reader of PDDL domains: typed STRIPS with negative, disjunctive and quantified conditions, and conditional effects.

PDDL is not case-sensitive. The reader checks that every type, predicate, object and variable is declared, and that
every term has the type its predicate asks for.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cache
from importlib.resources import files
from typing import NoReturn

from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.types import Atom
from ictamp_drake.symbolic.expressions import Expression, Group, quote_expression, read
from ictamp_drake.symbolic.formulas import TRUE, And, Equal, Exists, Formula, Not, Or, Variable, negation
from ictamp_drake.symbolic.operators import OBJECT, Effect, Operator, PddlDomain, lineage

REQUIREMENTS = (
    ":strips",
    ":typing",
    ":equality",
    ":negative-preconditions",
    ":disjunctive-preconditions",
    ":universal-preconditions",
    ":existential-preconditions",
    ":quantified-preconditions",
    ":conditional-effects",
    ":adl",
)
"""Requirements that a domain may declare."""

_SECTIONS = (":requirements", ":types", ":constants", ":predicates", ":action")
_PARTS = {
    ":parameters": ":parameters (?VARIABLE - TYPE ...)",
    ":precondition": ":precondition CONDITION",
    ":effect": ":effect EFFECT",
}
"""Parts that follow the name of an action, each at most once."""

_FORMS = {
    "and": "(and PART ...)",
    "or": "(or PART ...) in a condition",
    "not": "(not PART) in a condition or (not ATOM) in an effect",
    "imply": "(imply CONDITION CONSEQUENCE) in a condition",
    "when": "(when CONDITION EFFECT) in an effect",
    "forall": "(forall (?VARIABLE - TYPE ...) PART)",
    "exists": "(exists (?VARIABLE - TYPE ...) PART) in a condition",
    "=": "(= TERM TERM) in a condition",
}
"""Correct forms of the words that are not predicates."""

Scope = Mapping[str, str]
"""Types of the variables that may be used, by name."""


@cache
def boxes_domain() -> PddlDomain:
    """Return the domain of `domain.pddl`."""
    return read_domain((files("ictamp_drake.symbolic") / "domain.pddl").read_text(encoding="utf-8"), "domain.pddl")


def read_domain(text: str, where: str) -> PddlDomain:
    """Read a domain from its text.

    Args:
        text: (define (domain ...) ...).
        where: Name of the file in errors.

    Raises:
        IctampError: The text is malformed. The message names the line, the expression and what was expected.
    """
    try:
        return _DomainReader().domain(read(text.lower()))
    except IctampError as error:
        error.add_file(where)
        raise


class FormulaReader:
    """Reads formulas about declared objects.

    Attributes:
        types: Parent of each type by name.
        constants: Types of the objects by name.
        predicates: Types of the arguments of each predicate by name.
    """

    def __init__(
        self, types: Mapping[str, str], constants: Mapping[str, str], predicates: Mapping[str, tuple[str, ...]]
    ) -> None:
        self.types = dict(types)
        self.constants = dict(constants)
        self.predicates = dict(predicates)

    def formula(self, expression: Expression, scope: Scope, around: Group) -> Formula:
        """Read a formula.

        Args:
            expression: Formula as it is written.
            scope: Types of the variables that may be used, by name.
            around: Group that the expression is part of, or the expression itself.

        Raises:
            IctampError: It is not a formula about the declared objects.
        """

        def read_all(parts: Sequence[Expression]) -> tuple[Formula, ...]:
            return tuple(self.formula(part, scope, group) for part in parts)

        group = _group(expression, "a formula", around)
        match group.items or ("and",):
            case ("and" | "or" as connective, *parts):
                return (And if connective == "and" else Or)(read_all(parts))
            case ("not", part):
                return negation(*read_all([part]))
            case ("imply", condition, consequence):
                return Or((negation(*read_all([condition])), *read_all([consequence])))
            case ("forall" | "exists" as quantifier, Group() as declared, part):
                variables, wider = self._read_quantified(declared, scope)
                body = self.formula(part, wider, group)
                return Exists(variables, body) if quantifier == "exists" else Not(Exists(variables, negation(body)))
            case ("=", str(left), str(right)):
                for term in (left, right):
                    self._type_of(term, scope, group)
                return Equal((left, right))
        return self.atom(group, scope)

    def atom(self, group: Group, scope: Scope) -> Atom:
        """Read an atom, with the same arguments and errors as `formula`."""
        match group.items:
            case (str(predicate), *terms) if predicate in self.predicates:
                types = self.predicates[predicate]
            case (str(word), *_) if word in _FORMS:
                _refuse(group, _FORMS[word])
            case _:
                _refuse(group, f"one of the predicates {_join_names(self.predicates)}")
        if len(terms) != len(types):
            _refuse(group, f"({' '.join((predicate, *map(str.upper, types)))})")
        for term, wanted in zip(terms, types, strict=True):
            kind = self._type_of(term, scope, group)
            if wanted not in lineage(kind, self.types):
                _refuse(group, f"a {wanted} in the place of {term}, which is a {kind}")
        return Atom(predicate, tuple(map(str, terms)))

    def _read_quantified(self, declared: Group, scope: Scope) -> tuple[tuple[Variable, ...], Scope]:
        variables = self._read_typed_list(declared, 0, variables=True)
        for name in variables:
            if name in scope:
                _refuse(declared, f"another name than {name}, which is in use already")
        return tuple(Variable(*variable) for variable in variables.items()), {**scope, **variables}

    def _type_of(self, term: Expression, scope: Scope, around: Group) -> str:
        kind = scope.get(term, self.constants.get(term)) if isinstance(term, str) else None
        if kind is None:
            _refuse(
                term,
                f"one of {_join_names((*scope, *self.constants)) or 'the parameters, of which there are none'}",
                around,
            )
        return kind

    def _read_typed_list(self, group: Group, start: int, variables: bool = False) -> dict[str, str]:
        """Return the names of a typed list with their types. Variables, and nothing else, begin with ?."""
        found: dict[str, str] = {}
        for name, kind in _read_declarations(group, start):
            if kind != OBJECT and kind not in self.types:
                _refuse(kind, f"one of the types {_join_names((OBJECT, *self.types))}", group)
            if name in found or name.startswith("?") != variables:
                _refuse(name, f"a name {'with' if variables else 'without'} ? in front that is not there yet", group)
            found[name] = kind
        return found


class _DomainReader(FormulaReader):
    """Reads one domain and keeps track of the declarations so far."""

    def __init__(self) -> None:
        super().__init__({}, {}, {})

    def domain(self, root: Group) -> PddlDomain:
        match root.items:
            case ("define", Group(("domain", str())), *sections):
                pass
            case _:
                _refuse(root, "(define (domain NAME) ...)")
        by_key: dict[str, list[Group]] = {key: [] for key in _SECTIONS}
        for section in sections:
            match section:
                case Group((str(key), *_)) if key in by_key:
                    by_key[key].append(section)
                case _:
                    _refuse(section, f"a section that begins with one of {', '.join(_SECTIONS)}", root)
        for section in by_key[":requirements"]:
            _check_requirements(section)
        for section in by_key[":types"]:
            self._declare_types(section)
        for section in by_key[":constants"]:
            self.constants |= self._read_typed_list(section, 1)
        for section in by_key[":predicates"]:
            for declaration in section.items[1:]:
                self._declare_predicate(declaration, section)
        operators: dict[str, Operator] = {}
        for section in by_key[":action"]:
            operator = self._operator(section)
            if operator.name in operators:
                _refuse(section, f"another name than {operator.name}, which an action has already")
            operators[operator.name] = operator
        return PddlDomain(self.types, self.constants, self.predicates, tuple(operators.values()))

    def _declare_types(self, section: Group) -> None:
        parents = dict(_read_declarations(section, 1))
        known = {OBJECT, *self.types}
        parents |= {parent: OBJECT for parent in parents.values() if parent not in known.union(parents)}
        for name in parents:
            kind, walked = name, set[str]()
            while kind not in known:
                if kind in walked:
                    _refuse(section, f"types that are not kinds of each other in a circle, as is {kind}")
                walked.add(kind)
                kind = parents[kind]
            known |= walked
        self.types |= {name: parent for name, parent in parents.items() if name != OBJECT}

    def _declare_predicate(self, declaration: Expression, section: Group) -> None:
        match declaration:
            case Group((str(name), *_)) if name not in {*_FORMS, *self.predicates}:
                self.predicates[name] = tuple(self._read_typed_list(declaration, 1, variables=True).values())
            case _:
                _refuse(declaration, "(PREDICATE ?VARIABLE - TYPE ...) with a name of its own", section)

    def _operator(self, section: Group) -> Operator:
        match section.items:
            case (_, str(name), *rest) if set(rest[::2]) <= _PARTS.keys() and len(set(rest[::2])) * 2 == len(rest):
                parts = dict(zip(rest[::2], rest[1::2], strict=True))
            case _:
                _refuse(section, f"(:action NAME {' '.join(_PARTS.values())})")
        parameters = _group(parts.get(":parameters", Group((), section.line)), "parameters", section)
        scope = self._read_typed_list(parameters, 0, variables=True)
        precondition, effect = parts.get(":precondition"), parts.get(":effect")
        return Operator(
            name,
            tuple(Variable(*variable) for variable in scope.items()),
            TRUE if precondition is None else self.formula(precondition, scope, section),
            () if effect is None else tuple(self._effects(effect, scope, (), TRUE, section)),
        )

    def _effects(
        self, expression: Expression, scope: Scope, variables: tuple[Variable, ...], condition: Formula, around: Group
    ) -> Iterator[Effect]:
        group = _group(expression, "an effect", around)
        match group.items:
            case () | ("and",):
                pass
            case ("and", *parts):
                for part in parts:
                    yield from self._effects(part, scope, variables, condition, group)
            case ("when", when, effect):
                more = self.formula(when, scope, group)
                both = more if condition is TRUE else And((condition, more))
                yield from self._effects(effect, scope, variables, both, group)
            case ("forall", Group() as declared, effect):
                quantified, wider = self._read_quantified(declared, scope)
                yield from self._effects(effect, wider, (*variables, *quantified), condition, group)
            case ("not", Group() as atom):
                yield Effect(variables, condition, self.atom(atom, scope), adds=False)
            case _:
                yield Effect(variables, condition, self.atom(group, scope), adds=True)


def _read_declarations(group: Group, start: int) -> Iterator[tuple[str, str]]:
    """Yield the names and types of a typed list such as (a b - box c). A name without a type is an object."""
    names: list[str] = []
    words = iter(group.items[start:])
    for word in words:
        kind = next(words, "") if word == "-" else None
        if not isinstance(word, str) or isinstance(kind, Group) or kind == "":
            _refuse(group, "names, with - TYPE behind those of one type")
        if kind is None:
            names.append(word)
        else:
            yield from ((name, kind) for name in names)
            names.clear()
    yield from ((name, OBJECT) for name in names)


def _join_names(names: Iterable[str]) -> str:
    return quote_expression(", ".join(names))


def _check_requirements(section: Group) -> None:
    for word in section.items[1:]:
        if word not in REQUIREMENTS:
            _refuse(word, f"requirements among {', '.join(REQUIREMENTS)}", section)


def _group(expression: Expression, what: str, around: Group) -> Group:
    if not isinstance(expression, Group):
        _refuse(expression, f"{what} in brackets", around)
    return expression


def _refuse(expression: Expression, expected: str, around: Group | None = None) -> NoReturn:
    line = expression.line if isinstance(expression, Group) else around.line if around else 1
    inside = f' in "{quote_expression(around)}"' if around and isinstance(expression, str) else ""
    problem = f"expected {expected}, got {{value}}{inside}"
    raise IctampError(Code.NOT_PDDL, problem, line=line, value=quote_expression(expression))
