"""Conditions and values with their names resolved: what `dse.space.language.interpret` makes of an expression.

Units are checked and forgotten, every number is in SI. Undefined values and truths are Kleene's, as told in
`dse.space.language.evaluate`.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

from dse.domain.expression import Span
from dse.space.decisions import Site

Entries = tuple[tuple[Site, Fraction], ...]
"""What is stated where; at one path at most one site is there at a time."""


@dataclass(frozen=True, slots=True, eq=False)
class Constant:
    """A number or a truth that is written out."""

    value: Fraction | bool


@dataclass(frozen=True, slots=True, eq=False)
class Selected:
    """True where one of *sites* is there whose name is among *named*; None is the name of nothing."""

    sites: tuple[Site, ...]
    named: frozenset[str | None]


@dataclass(frozen=True, slots=True, eq=False)
class Stated:
    """The value stated at a place by what is there; undefined if nothing is."""

    entries: Entries


@dataclass(frozen=True, slots=True, eq=False)
class RollUp:
    """*function*, one of ROLLUPS, of the values of what is there."""

    function: str
    entries: Entries


@dataclass(frozen=True, slots=True, eq=False)
class TermOperation:
    """A function of *operands*, undefined as soon as one of them is; a division by zero is told at *span*."""

    operator: str
    operands: tuple[Term, ...]
    span: Span


@dataclass(frozen=True, slots=True, eq=False)
class Every:
    """``and``."""

    conditions: tuple[Term, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Some:
    """``or``."""

    conditions: tuple[Term, ...]


@dataclass(frozen=True, slots=True, eq=False)
class ConditionalTerm:
    """``if … then … else …``; undefined where the condition is."""

    condition: Term
    yes: Term
    no: Term


@dataclass(frozen=True, slots=True, eq=False)
class Quota:
    """Between *low* and *high* of *conditions* are true; None is no bound."""

    low: int | None
    high: int | None
    conditions: tuple[Term, ...]


Leaf = Selected | Stated | RollUp
"""The terms that look at what is chosen."""

Term = Constant | Leaf | TermOperation | Every | Some | ConditionalTerm | Quota


def parts(term: Term) -> tuple[Term, ...]:
    """The terms directly below *term*."""
    match term:
        case TermOperation():
            return term.operands
        case Every() | Some() | Quota():
            return term.conditions
        case ConditionalTerm():
            return (term.condition, term.yes, term.no)
    return ()


def leaves(term: Term) -> Iterator[Leaf]:
    """Every leaf of *term*, from left to right; one that stands twice comes twice."""
    stack = [term]
    while stack:
        term = stack.pop()
        if isinstance(term, Leaf):
            yield term
        else:
            stack.extend(reversed(parts(term)))


def sites_of(leaf: Leaf) -> Iterator[Site]:
    """The sites *leaf* looks at."""
    match leaf:
        case Selected():
            yield from leaf.sites
        case Stated() | RollUp():
            yield from (site for site, _ in leaf.entries)
