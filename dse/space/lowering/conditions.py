"""What makes a condition true, or false, as a formula; Kleene's undefined is what makes it neither."""

from __future__ import annotations

from dse.errors import DseError
from dse.space.decisions import Site
from dse.space.language.terms import (
    ConditionalTerm,
    Constant,
    Every,
    Quota,
    Selected,
    Some,
    Term,
    TermOperation,
)
from dse.space.lowering.affine import OPPOSITE, compare, one_taken
from dse.space.lowering.cells import holds_in_cells, scope_of_term
from dse.space.lowering.counts import counting
from dse.space.lowering.formulas import (
    FALSE_FORMULA,
    TRUE_FORMULA,
    Atom,
    Formula,
    conjoin,
    disjoin,
    literal,
    negation,
    same,
)
from dse.space.lowering.shape import SpaceShape, VariableValue


class ConditionLowering:
    """Formulas of the conditions of one expression; each condition is looked at once for each outcome.

    The conditions must not fail, as a division by zero would: short cuts are not kept.
    """

    def __init__(self, shape: SpaceShape) -> None:
        self.shape = shape
        self._known: dict[tuple[int, bool], Formula] = {}

    def formula(self, term: Term, outcome: bool) -> Formula:
        """Where *term* has the value *outcome*. Raises TooLargeError."""
        key = (id(term), outcome)
        if key not in self._known:
            self._known[key] = self._formula(term, outcome)
        return self._known[key]

    def _formula(self, term: Term, outcome: bool) -> Formula:
        shape = self.shape
        match term:
            case Constant(value):
                return TRUE_FORMULA if bool(value) is outcome else FALSE_FORMULA
            case Selected():
                truth = _standing(shape, term)
                return truth if outcome else negation(shape, truth)
            case Every(conditions):
                return self._junction(conditions, outcome, every=outcome)
            case Some(conditions):
                return self._junction(conditions, outcome, every=not outcome)
            case TermOperation("not", (operand,)):
                return self.formula(operand, not outcome)
            case TermOperation("xor" | "iff" as word, (left, right)):
                alike = (word == "iff") is outcome
                pairs = [(value, value if alike else not value) for value in (True, False)]
                return disjoin(
                    shape, [conjoin(shape, [self.formula(left, a), self.formula(right, b)]) for a, b in pairs]
                )
            case TermOperation() if term.operator in OPPOSITE:
                found = compare(shape, term, outcome)
                return found if found is not None else atom(shape, term, outcome)
            case ConditionalTerm(condition, yes, no):
                met = conjoin(shape, [self.formula(condition, True), self.formula(yes, outcome)])
                unmet = conjoin(shape, [self.formula(condition, False), self.formula(no, outcome)])
                return disjoin(shape, [met, unmet])
            case Quota():
                return self._quota(term, outcome)
        return atom(shape, term, outcome)

    def _junction(self, conditions: tuple[Term, ...], outcome: bool, *, every: bool) -> Formula:
        formulas = [self.formula(condition, outcome) for condition in conditions]
        return conjoin(self.shape, formulas) if every else disjoin(self.shape, formulas)

    def _quota(self, term: Quota, outcome: bool) -> Formula:
        shape = self.shape
        true = [self.formula(condition, True) for condition in term.conditions]
        possible = [negation(shape, self.formula(condition, False)) for condition in term.conditions]
        if all(same(one, other) for one, other in zip(true, possible, strict=True)):
            # None of them is ever undefined, so both bounds are of one count.
            found = counting(shape, true, term.low, term.high)
            if found is not None:
                return found if outcome else negation(shape, found)
        if outcome:
            bounds = [counting(shape, true, term.low, None), counting(shape, possible, None, term.high)]
            return conjoin(shape, [one for one in bounds if one]) if all(bounds) else atom(shape, term, outcome)
        beyond: list[Formula | None] = []
        if term.low is not None:
            beyond.append(counting(shape, possible, None, term.low - 1) if term.low else FALSE_FORMULA)
        if term.high is not None:
            beyond.append(counting(shape, true, term.high + 1, None))
        return disjoin(shape, [one for one in beyond if one]) if all(beyond) else atom(shape, term, outcome)


def atom(shape: SpaceShape, term: Term, outcome: bool) -> Formula:
    """The atom itself, or a literal or what it always is where it has one variable or none."""
    scope = scope_of_term(term)
    found = Atom(term, scope, outcome)
    if len(scope) > 1:
        return found
    try:
        holds = holds_in_cells(shape, found)
    except DseError:
        return found
    if scope:
        return literal(shape, scope[0], holds)
    return TRUE_FORMULA if holds else FALSE_FORMULA


def _standing(shape: SpaceShape, term: Selected) -> Formula:
    # Where nothing is among the names, it is easier to say which names are not.
    wanted = None not in term.named
    found = _there(shape, [site for site in term.sites if (site.name in term.named) is wanted])
    return found if wanted else negation(shape, found)


def _there(shape: SpaceShape, sites: list[Site]) -> Formula:
    branches: list[VariableValue] = []
    for site in sites:
        if site.branch is None:
            return TRUE_FORMULA
        branches.append(site.branch)
    return one_taken(shape, branches)
