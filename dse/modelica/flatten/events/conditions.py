"""Conditions, clocks and triggers: when a when-clause becomes active."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from dse.errors import Location, fail
from dse.modelica.algebra.expression import Expression
from dse.modelica.algebra.symbol import Referent, Symbol
from dse.modelica.flat_model import Clock, Trigger
from dse.modelica.flatten.document import fields, single
from dse.modelica.flatten.evaluation.context import Frame
from dse.modelica.flatten.evaluation.evaluation import Evaluation
from dse.modelica.flatten.values import MismatchError, only

_LARGEST = 2**53
_SIMPLE = 10**9
_ROUNDING = Fraction(1, 2**50)


@dataclass(slots=True)
class Conditions:
    """Reads conditions by number. *triggers*: the number of the trigger made of each condition."""

    evaluation: Evaluation
    triggers: dict[int, int] = field(default_factory=dict)

    def trigger(self, condition: int) -> int:
        """The trigger that becomes active when *condition* does."""
        found = self.triggers.get(condition)
        if found is not None:
            return found
        conditions: list[Expression] = []
        clocks: list[int] = []
        at_start = False
        for number in self._alternatives(condition):
            kind, data = self._kind(number)
            if kind == "clock":
                clocks.append(data)
            elif kind == "initial":
                at_start = True
            else:
                conditions.append(self._truth(number, makes_events=True))
        model = self.evaluation.model
        for expression in conditions:
            if not model.is_discrete(expression):
                raise fail("a when-condition that changes without an event is not supported", self.where(condition))
        model.triggers.append(Trigger(tuple(conditions), tuple(clocks), at_start))
        self.triggers[condition] = len(model.triggers) - 1
        return self.triggers[condition]

    def guard(self, condition: int, trigger: int | None) -> Expression:
        """Truth of *condition* as it is now, where *trigger* (a condition) is known to be active."""
        return self._truth(condition, makes_events=False, known=trigger)

    def is_always(self, condition: int) -> bool:
        """Whether *condition* holds at all times."""
        return self._kind(condition)[0] == "always"

    def where(self, condition: int) -> Location | None:
        """Where *condition* stands."""
        document = self.evaluation.document
        return document.where(document.lists["conditions"][condition].get("provenance"))

    def _kind(self, number: int) -> tuple[str, Any]:
        return single(self.evaluation.document.lists["conditions"][number]["node"], "a condition", self.where(number))

    def _alternatives(self, condition: int) -> Iterator[int]:
        """The conditions any of which makes a when-clause active, in order."""
        stack = [condition]
        while stack:
            number = stack.pop()
            kind, data = self._kind(number)
            if kind == "any_rise":
                fields(data, "lhs rhs", "a condition", self.where(number))
                stack += [data["rhs"], data["lhs"]]
            else:
                yield number

    def _truth(self, condition: int, makes_events: bool, known: int | None = None) -> Expression:
        """The expression of *condition*; deep trees are walked with a stack."""
        graph = self.evaluation.graph
        done: dict[int, Expression] = {}
        stack = [condition]
        while stack:
            number = stack[-1]
            if number in done:
                stack.pop()
                continue
            kind, data = self._kind(number)
            if number == known or kind == "always":
                done[number] = graph.constant(1.0)
            elif kind in ("and", "or"):
                fields(data, "lhs rhs", "a condition", self.where(number))
                sides = [data["lhs"], data["rhs"]]
                missing = [side for side in sides if side not in done]
                if missing:
                    stack += missing
                    continue
                done[number] = graph.make(kind, *(done[side] for side in sides))
            elif kind == "not":
                if data not in done:
                    stack.append(data)
                    continue
                done[number] = graph.make("not", done[data])
            else:
                done[number] = self._leaf(kind, data, number, makes_events)
        return done[condition]

    def _leaf(self, kind: str, data: int, number: int, makes_events: bool) -> Expression:
        evaluation = self.evaluation
        where = self.where(number)
        if kind == "clock":
            return evaluation.model.ticks(data, where)
        if kind == "initial":
            return evaluation.graph.symbol(Symbol(referent=Referent.INITIAL))
        if kind == "relation":
            relation, inner = single(evaluation.document.lists["relations"][data], "a relation", where)
            if relation != "relation":
                raise fail(f"a condition on a relation of kind '{relation}' is not supported", where)
            fields(inner, "expression", "a relation", where)
            node = inner["expression"]
        elif kind == "discrete":
            node = data
        else:
            raise fail(f"a condition of kind '{kind}' is not supported", where)
        frame = Frame(makes_events)
        try:
            found = only(evaluation.value(node, frame))
        except MismatchError as problem:
            raise fail(f"{problem} is not supported", where) from None
        if frame.asserts:
            raise fail("an assert in a function that a condition calls is not supported", where)
        return found


def read_clocks(evaluation: Evaluation) -> None:
    """Enter all clocks, with exact periods. Raises DseError for clocks that do not tick at fixed times."""
    document = evaluation.document
    for record in document.lists["clocks"]:
        where = document.where(record.get("provenance"))
        kind, data = single(record["kind"], "a clock", where)
        if kind != "periodic":
            raise fail(f"a clock of kind '{kind}' is not supported", where)
        fields(data, "lattice anchor", "a clock", where)
        fields(data["lattice"], "period phase", "a clock", where)
        if data["anchor"] not in ("absolute", "simulation_start"):
            raise fail(f"a clock that starts at '{data['anchor']}' is not supported", where)
        period, phase = (_fraction(data["lattice"][name]) for name in ("period", "phase"))
        if period <= 0 or phase < 0:
            raise fail("a sample with a period that is not positive, or from before time 0", where)
        if max(period.numerator, period.denominator, phase.numerator, phase.denominator) > _LARGEST:
            raise fail("a sample whose times have too many digits is not supported", where)
        evaluation.model.clocks.append(Clock(period, phase, data["anchor"] == "simulation_start"))


def _fraction(record: dict[str, int]) -> Fraction:
    """The time in *record*; if it is a computed double, the simplest fraction within its last digits."""
    fields(record, "num den", "a clock's time")
    exact = Fraction(int(record["num"]), int(record["den"]))
    simple = exact.limit_denominator(_SIMPLE)
    return simple if abs(simple - exact) <= exact * _ROUNDING else exact
