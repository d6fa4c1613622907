"""Static constraints and selections: expressions over what is chosen, compiled once and evaluated exactly.

* ``place.property`` is a property of the component at a place, ``sensor.range``; ``place.parameter.max``, ``.min``
  and ``.start`` are what its parameter may be and is, ``controller.kp_speed.max``.
* ``sum min max mean product count (property, place)`` roll up over the parts below a place that state the
  property, without a place over the whole design. A bare ``cost`` is ``sum(cost)``. ``min`` and ``max`` of
  values, ``min(a.mass, b.mass)``, are told apart by the dot in their first argument.
* ``place is x``, ``place in [x, y]``, ``place is absent``, ``place is present``; ``same_choice(p, q)`` is
  true if one name is chosen at p and q, or both are absent.
* ``at_least(2, a is x, b is y, c is z)``, ``at_most`` and ``exactly`` count the conditions that are true.
* ``abs sqrt floor min max`` calculate; all is exact but roots and fractional powers, which are floats.
* A property of an absent part is undefined, and so is all that needs it, as in SQL. A constraint whose
  outcome is undefined holds. An absent part is nothing: ``place is x`` is false, roll-ups skip it. Counted
  conditions that are undefined leave a count undefined if it depends on them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Generic, TypeVar

from dse.domain.design import DesignSpace
from dse.domain.expression import Expression
from dse.errors import fail
from dse.expression import error_in
from dse.space.decisions import Choices, Site
from dse.space.language.arithmetic import EXACT_FUNCTIONS, ExactValue, UndefinedError, quota, roll_up
from dse.space.language.interpret import interpret, interpret_condition
from dse.space.language.places import Places
from dse.space.language.terms import (
    ConditionalTerm,
    Constant,
    Every,
    Leaf,
    Quota,
    RollUp,
    Selected,
    Some,
    Stated,
    Term,
    TermOperation,
)

_Source = TypeVar("_Source")
Evaluate = Callable[[_Source], ExactValue]
"""The value of a term, given what is chosen, in whatever form the leaves take it."""

There = Callable[[Sequence[tuple[Site, Any]]], Callable[[_Source], list[Any]]]
"""Makes, of values by site, a function that finds those whose site is there in what is chosen, in their order."""


class CompiledCondition:
    """A compiled condition."""

    def __init__(self, evaluate: Evaluate[Choices]) -> None:
        self._evaluate = evaluate

    def outcome(self, choices: Choices) -> bool | None:
        """True, false, or None where it is undefined. Raises DseError for a division by zero and its like."""
        return _truth(self._evaluate(choices))


def compile_in(expression: Expression, places: Places) -> CompiledCondition:
    """*expression* as a condition on complete choices among *places*.

    Raises DseError, located, for unknown places, components, properties and functions, and for units that do
    not fit.
    """
    return CompiledCondition(evaluator(expression, interpret_condition(expression, places), _there, _shown))


def compile_value(expression: Expression, space: DesignSpace) -> Evaluate[Choices]:
    """*expression*, a number, as a function of complete choices: exact, None where undefined.

    The function raises DseError for a division by zero and its like, this one like `compile_in`.
    """
    _, term = interpret(expression, Places(space))
    return evaluator(expression, term, _there, _shown)


def evaluator(
    expression: Expression, term: Term, there: There[_Source], shown: Callable[[_Source], str]
) -> Evaluate[_Source]:
    """*term* as a function of a source in which *there* finds what is chosen; *shown* tells the source in messages.

    The function raises DseError, located in *expression*, for a division by zero and its like.
    """
    return leaf_evaluator(expression, term, lambda leaf: _read(leaf, there), shown)


def leaf_evaluator(
    expression: Expression, term: Term, leaf: Callable[[Leaf], Evaluate[_Source]], shown: Callable[[_Source], str]
) -> Evaluate[_Source]:
    """Like `evaluator`, for leaves that are read in another way."""
    evaluate = _Evaluators(expression, leaf, shown).compile(term)

    def guarded(source: _Source) -> ExactValue:
        try:
            return evaluate(source)
        except OverflowError as error:
            raise fail("a number is too large", expression.where) from error

    return guarded


class _Evaluators(Generic[_Source]):
    """Turns a term into closures."""

    def __init__(
        self, expression: Expression, leaf: Callable[[Leaf], Evaluate[_Source]], shown: Callable[[_Source], str]
    ) -> None:
        self.expression = expression
        self.leaf = leaf
        self.shown = shown

    def compile(self, term: Term) -> Evaluate[_Source]:
        match term:
            case Constant(value):
                return lambda _: value
            case TermOperation():
                return self.operation(term)
            case Every():
                return self.junction(term.conditions, deciding=False)
            case Some():
                return self.junction(term.conditions, deciding=True)
            case Quota():
                conditions = [self.compile(condition) for condition in term.conditions]
                low, high = term.low, term.high
                return lambda source: quota(low, high, [_truth(condition(source)) for condition in conditions])
            case ConditionalTerm():
                return self.choice(term)
        return self.leaf(term)

    def junction(self, conditions: Iterable[Term], *, deciding: bool) -> Evaluate[_Source]:
        compiled = [self.compile(condition) for condition in conditions]

        def decide(source: _Source) -> bool | None:
            # What stands behind the deciding condition is not looked at, so that it can guard a division.
            outcome: bool | None = not deciding
            for condition in compiled:
                value = condition(source)
                if value is None:
                    outcome = None
                elif bool(value) is deciding:
                    return deciding
            return outcome

        return decide

    def choice(self, term: ConditionalTerm) -> Evaluate[_Source]:
        condition, yes, no = self.compile(term.condition), self.compile(term.yes), self.compile(term.no)

        def choose(source: _Source) -> ExactValue:
            outcome = condition(source)
            return None if outcome is None else (yes if outcome else no)(source)

        return choose

    def operation(self, term: TermOperation) -> Evaluate[_Source]:
        function = EXACT_FUNCTIONS[term.operator]
        operands = [self.compile(operand) for operand in term.operands]

        def apply(source: _Source) -> ExactValue:
            values = []
            for operand in operands:
                value = operand(source)
                if value is None:
                    return None
                values.append(value)
            try:
                return function(*values)
            except UndefinedError as error:
                shown = self.shown(source)
                what = f"{error}, for {shown}" if shown else str(error)
                raise error_in(self.expression, term.span, what, "guard it: if … then … else …") from error

        return apply


def _there(entries: Sequence[tuple[Site, Any]]) -> Callable[[Choices], list[Any]]:
    return lambda choices: [value for site, value in entries if site.is_there(choices)]


def _read(leaf: Leaf, there: There[_Source]) -> Evaluate[_Source]:
    """How the value of *leaf* is read from a source."""
    match leaf:
        case Selected(sites, named):
            name_at = there([(site, site.name) for site in sites])
            return lambda source: next(iter(name_at(source)), None) in named
        case Stated(entries):
            stated = there(entries)
            return lambda source: next(iter(stated(source)), None)
        case RollUp(function, entries):
            values = there(entries)
            return lambda source: roll_up(function, values(source))


def _truth(value: ExactValue) -> bool | None:
    return None if value is None else bool(value)


def _shown(choices: Mapping[str, str]) -> str:
    return ", ".join(f"{path}={choice}" for path, choice in choices.items()) or "the only configuration"
