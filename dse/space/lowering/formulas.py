"""Two-valued formulas over the variables of a flat space: what makes a three-valued term true, or false."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction

from dse.space.flat import Bools, Ints
from dse.space.language.terms import Term
from dse.space.lowering.shape import SpaceShape


@dataclass(frozen=True, slots=True, eq=False)
class Literal:
    """The variable takes a value of *mask*, shape (values + 1,), whose last entry is False if it always exists."""

    variable: int
    mask: Bools


@dataclass(frozen=True, slots=True, eq=False)
class BoundedSum:
    """low <= sum over variables of weights[variable][value] <= high, as in `Linear`."""

    weights: Mapping[int, Ints]
    low: int | None
    high: int | None
    scale: Fraction = Fraction(1)


@dataclass(frozen=True, slots=True, eq=False)
class Atom:
    """*term*, over the variables of *scope*, ascending, has the value *outcome*; or, if *denied*, has not."""

    term: Term
    scope: tuple[int, ...]
    outcome: bool
    denied: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class FormulaJunction:
    """All of *parts*, if *every*, else one of them. *size* counts the formulas below."""

    every: bool
    parts: tuple[Formula, ...]
    size: int


Formula = Literal | BoundedSum | Atom | FormulaJunction

TRUE_FORMULA = FormulaJunction(True, (), 1)
FALSE_FORMULA = FormulaJunction(False, (), 1)

MOST_PARTS = 20_000
"""Formulas below one another in a formula; what is larger is judged as it was written."""


class TooLargeError(Exception):
    """A formula of more than `MOST_PARTS`."""


def is_constant(formula: Formula, value: bool) -> bool:
    """Whether *formula* is plainly true, or plainly false."""
    return isinstance(formula, FormulaJunction) and not formula.parts and formula.every is value


def same(formula: Formula, other: Formula) -> bool:
    """Whether the two are constants or literals, and the same."""
    if isinstance(formula, Literal) and isinstance(other, Literal):
        return formula.variable == other.variable and bool((formula.mask == other.mask).all())
    return any(is_constant(formula, value) and is_constant(other, value) for value in (True, False))


def literal(shape: SpaceShape, variable: int, mask: Bools) -> Formula:
    """The literal, or what it always is. *mask* becomes the formula's own."""
    root = shape.is_root(variable)
    if root:
        mask[-1] = False
    # Masks are short: looking at their bytes is several times faster than asking numpy.
    values = mask.tobytes()
    if b"\0" not in (values[:-1] if root else values):
        return TRUE_FORMULA
    return Literal(variable, mask) if b"\1" in values else FALSE_FORMULA


def conjoin(shape: SpaceShape, parts: Iterable[Formula]) -> Formula:
    """All of *parts*; literals of one variable become one. Raises TooLargeError."""
    return _join(shape, parts, every=True)


def disjoin(shape: SpaceShape, parts: Iterable[Formula]) -> Formula:
    """One of *parts*; literals of one variable become one. Raises TooLargeError."""
    return _join(shape, parts, every=False)


def negation(shape: SpaceShape, formula: Formula) -> Formula:
    """Where *formula* does not hold. Raises TooLargeError."""
    match formula:
        case Literal():
            return literal(shape, formula.variable, ~formula.mask)
        case BoundedSum(weights, low, high, scale):
            beside: list[Formula] = []
            if low is not None:
                beside.append(BoundedSum(weights, None, low - 1, scale))
            if high is not None:
                beside.append(BoundedSum(weights, high + 1, None, scale))
            return disjoin(shape, beside)
        case Atom():
            return Atom(formula.term, formula.scope, formula.outcome, not formula.denied)
        case FormulaJunction():
            return _join(shape, (negation(shape, part) for part in formula.parts), every=not formula.every)


def scope_of(formula: Formula) -> tuple[int, ...]:
    """The variables that *formula* looks at, ascending."""
    found: set[int] = set()
    for below in walk(formula):
        match below:
            case Literal():
                found.add(below.variable)
            case BoundedSum():
                found.update(below.weights)
            case Atom():
                found.update(below.scope)
    return tuple(sorted(found))


def walk(formula: Formula) -> Iterator[Formula]:
    """*formula* and all below it."""
    stack = [formula]
    while stack:
        formula = stack.pop()
        yield formula
        if isinstance(formula, FormulaJunction):
            stack.extend(formula.parts)


def _join(shape: SpaceShape, parts: Iterable[Formula], *, every: bool) -> Formula:
    literals: dict[int, Literal] = {}
    merged: dict[int, Bools] = {}
    others: list[Formula] = []
    size = 1
    stack = list(parts)[::-1]
    while stack:
        part = stack.pop()
        if isinstance(part, FormulaJunction):
            if part.every is every:
                stack.extend(reversed(part.parts))
                continue
            if not part.parts:
                return part
        elif isinstance(part, Literal):
            before = literals.setdefault(part.variable, part)
            if before is not part:
                mask = merged.get(part.variable, before.mask)
                merged[part.variable] = mask & part.mask if every else mask | part.mask
            continue
        others.append(part)
        size += part.size if isinstance(part, FormulaJunction) else 1
    joined: list[Formula] = []
    for variable, one in literals.items():
        found = literal(shape, variable, merged[variable]) if variable in merged else one
        if is_constant(found, not every):
            return found
        if not is_constant(found, every):
            joined.append(found)
    joined += others
    size += len(joined) - len(others)
    if size > MOST_PARTS:
        raise TooLargeError
    if len(joined) == 1:
        return joined[0]
    return FormulaJunction(every, tuple(joined), size)
