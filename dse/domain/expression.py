"""Expressions a user writes in constraints, metrics and conditions, as a tree.

`span` is the half-open range of characters of the expression's own text, for messages with a caret.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from dse.errors import Location
from dse.units import Unit

Span = tuple[int, int]


@dataclass(frozen=True, slots=True)
class Number:
    """A literal with its unit: ``70 km/h``; *si* is exact."""

    si: Fraction
    unit: Unit
    span: Span


@dataclass(frozen=True, slots=True)
class Truth:
    """``true`` or ``false``."""

    value: bool
    span: Span


@dataclass(frozen=True, slots=True)
class Name:
    """A dotted name: a container, a property of a chosen part, a waveform or a parameter."""

    path: str
    span: Span


@dataclass(frozen=True, slots=True)
class Call:
    """``function(argument, …, option = argument, …)``."""

    function: str
    arguments: tuple[Node, ...]
    options: tuple[tuple[str, Node], ...]
    span: Span


@dataclass(frozen=True, slots=True)
class Unary:
    """``-x`` or ``not x``."""

    operator: str
    operand: Node
    span: Span


@dataclass(frozen=True, slots=True)
class Binary:
    """Arithmetic ``+ - * / ^``, comparison ``< <= > >= == !=``, logic ``and or xor implies iff``."""

    operator: str
    left: Node
    right: Node
    span: Span


@dataclass(frozen=True, slots=True)
class Conditional:
    """``if condition then yes else no``."""

    condition: Node
    yes: Node
    no: Node
    span: Span


@dataclass(frozen=True, slots=True)
class Between:
    """``x between low and high``, both ends included."""

    value: Node
    low: Node
    high: Node
    span: Span


@dataclass(frozen=True, slots=True)
class Chosen:
    """``place is component`` or ``place in [component, …]``: what is chosen at a container."""

    place: str
    options: tuple[str, ...]
    span: Span


Node = Number | Truth | Name | Call | Unary | Binary | Conditional | Between | Chosen


@dataclass(frozen=True, slots=True)
class Expression:
    """A parsed expression with its text and where the text starts in the user's file."""

    text: str
    root: Node
    where: Location | None = None

    def location(self, span: Span) -> Location | None:
        """Where *span* stands in the user's file, exact for text on one line."""
        if self.where is None or "\n" in self.text:
            return self.where
        return Location(self.where.file, self.where.line, self.where.column + span[0])
