"""Wide rules: a formula over folds, with an exact judge and one that bounds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dse.domain.expression import Expression
from dse.space.flat import Bools, Fold, Gather, Ints, Wide
from dse.space.language import intervals
from dse.space.language.evaluate import Evaluate, leaf_evaluator
from dse.space.language.intervals import NumberBounds, TruthBounds
from dse.space.language.terms import ConditionalTerm, Constant, Every, Leaf, Quota, Some, Term, TermOperation, leaves
from dse.space.lowering.counts import tally
from dse.space.lowering.folds import Folds
from dse.space.lowering.formulas import Atom, BoundedSum, Formula, FormulaJunction, Literal
from dse.space.lowering.readings import Reading, reading
from dse.space.lowering.shape import SpaceShape


def wide(shape: SpaceShape, expression: Expression, formula: Formula, owner: int) -> Wide:
    """The rule that *formula*, made from *expression*, holds."""
    folds = Folds(shape)
    judge = _test(shape, expression, formula, folds)
    return Wide(tuple(folds.found), judge, owner)


class Calculator:
    """A term, with its leaves read from folds."""

    def __init__(self, expression: Expression, term: Term, folds: Folds) -> None:
        self.term = term
        self._readings: dict[int, Reading] = {id(leaf): reading(leaf, folds) for leaf in leaves(term)}
        self.value: Evaluate[Sequence[int]] = leaf_evaluator(expression, term, self._value_of, lambda _: "")

    def bounds(self, low: Sequence[Ints], high: Sequence[Ints]) -> NumberBounds | TruthBounds:
        """What the term may be for folds between *low* and *high*."""
        form = low[0].shape if low else ()
        return self._bounds(self.term, form, low, high)

    def _value_of(self, leaf: Leaf) -> Evaluate[Sequence[int]]:
        return self._readings[id(leaf)].value

    def _bounds(
        self, term: Term, form: tuple[int, ...], low: Sequence[Ints], high: Sequence[Ints]
    ) -> NumberBounds | TruthBounds:
        def below(terms: Sequence[Term]) -> list[NumberBounds | TruthBounds]:
            return [self._bounds(one, form, low, high) for one in terms]

        match term:
            case Constant(bool() as value):
                return intervals.certain(value, form)
            case Constant(value):
                return intervals.known(value, form)
            case TermOperation(operator, operands):
                return intervals.operation(operator, below(operands))
            case Every(conditions) | Some(conditions):
                return intervals.junction(intervals.truths(below(conditions)), every=isinstance(term, Every))
            case Quota(least, most, conditions):
                return intervals.quota(least, most, intervals.truths(below(conditions)))
            case ConditionalTerm(condition, yes, no):
                (met,) = intervals.truths(below([condition]))
                return intervals.choice(met, *below([yes, no]))
        return self._readings[id(term)].bounds(low, high)


@dataclass(frozen=True, slots=True, eq=False)
class _Between:
    """A fold lies between *low* and *high*."""

    fold: int
    low: int | None
    high: int | None

    def bounds(self, low: Sequence[Ints], high: Sequence[Ints]) -> tuple[Bools, Bools]:
        least, most = low[self.fold], high[self.fold]
        may_hold, may_fail = np.ones(least.shape, bool), np.zeros(least.shape, bool)
        if self.low is not None:
            may_hold &= most >= self.low
            may_fail |= least < self.low
        if self.high is not None:
            may_hold &= least <= self.high
            may_fail |= most > self.high
        return may_hold, may_fail

    def holds(self, folds: Sequence[int]) -> bool:
        value = folds[self.fold]
        return (self.low is None or value >= self.low) and (self.high is None or value <= self.high)


@dataclass(frozen=True, slots=True, eq=False)
class _Has:
    """A term has the value *outcome*; or, if *denied*, has not."""

    calculator: Calculator
    outcome: bool
    denied: bool

    def bounds(self, low: Sequence[Ints], high: Sequence[Ints]) -> tuple[Bools, Bools]:
        (found,) = intervals.truths([self.calculator.bounds(low, high)])
        has, has_not = (found.true, found.false) if self.outcome else (found.false, found.true)
        has, has_not = has | found.fails, has_not | found.undefined | found.fails
        return (has_not, has) if self.denied else (has, has_not)

    def holds(self, folds: Sequence[int]) -> bool:
        value = self.calculator.value(folds)
        return (value is not None and bool(value) is self.outcome) is not self.denied


@dataclass(frozen=True, slots=True, eq=False)
class _Joined:
    """All of *parts* hold, if *every*, else one."""

    every: bool
    parts: tuple[_Test, ...]

    def bounds(self, low: Sequence[Ints], high: Sequence[Ints]) -> tuple[Bools, Bools]:
        pairs = [part.bounds(low, high) for part in self.parts]
        holding, failing = [one for one, _ in pairs], [other for _, other in pairs]
        if self.every:
            return np.logical_and.reduce(holding), np.logical_or.reduce(failing)
        return np.logical_or.reduce(holding), np.logical_and.reduce(failing)

    def holds(self, folds: Sequence[int]) -> bool:
        return (all if self.every else any)(part.holds(folds) for part in self.parts)


_Test = _Between | _Has | _Joined


def _test(shape: SpaceShape, expression: Expression, formula: Formula, folds: Folds) -> _Test:
    match formula:
        case Literal():
            return _literals(shape, [formula], folds, every=True)
        case BoundedSum(weights, low, high, scale):
            return _Between(folds.number(Fold(Gather.SUM, weights, 0, scale)), low, high)
        case Atom(term, _, outcome, denied):
            return _Has(Calculator(expression, term, folds), outcome, denied)
        case FormulaJunction(every, parts):
            literals = [part for part in parts if isinstance(part, Literal)]
            tests = [_test(shape, expression, part, folds) for part in parts if not isinstance(part, Literal)]
            if literals:
                tests.insert(0, _literals(shape, literals, folds, every=every))
            return _Joined(every, tuple(tests))


def _literals(shape: SpaceShape, literals: Sequence[Literal], folds: Folds, *, every: bool) -> _Between:
    """All of *literals* hold, or one, as a count."""
    weights, always = tally(shape, literals)
    fold = folds.number(Fold(Gather.SUM, weights, always))
    return _Between(fold, len(literals) if every else 1, None)
