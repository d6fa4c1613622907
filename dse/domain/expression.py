"""Expressions a user writes in constraints, metrics and conditions, as a tree.

`span` is the half-open range of characters of the expression's own text, for messages with a caret.
"""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass, field, replace
from fractions import Fraction

from dse.errors import Location
from dse.units import Unit

Span = tuple[int, int]

ROLLUPS = ("sum", "min", "max", "mean", "product", "count")
"""Roll-ups over a property: ``sum(cost)``, ``max(mass, powertrain)``."""


@dataclass(frozen=True, slots=True)
class Piece:
    """A stretch of a text that stands on one line of the user's file: the text's character *start* stands at *where*.

    An *inserted* piece is not in the file; all of it belongs to the one character at *where*.
    """

    start: int
    where: Location
    inserted: bool = False


Origin = Location | tuple[Piece, ...] | None
"""Where a text stands: where it starts if it stands there as it is, on one line; else its pieces in order."""


def locate(text: str, origin: Origin, offset: int) -> Location | None:
    """Where the character *offset* of *text* stands; where the text starts if no more is known."""
    if isinstance(origin, tuple):
        piece = origin[max(0, bisect_right(origin, offset, key=lambda piece: piece.start) - 1)]
        return piece.where if piece.inserted else _along(piece.where, offset - piece.start)
    if origin is None or not origin.line or "\n" in text:
        return origin
    return _along(origin, offset)


def _along(where: Location, characters: int) -> Location:
    return replace(where, column=where.column + characters)


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
    """``place is component`` or ``place in [component, …]``: what is chosen at a container.

    *spans* are those of the place and of each option, if they are known.
    """

    place: str
    options: tuple[str, ...]
    span: Span
    spans: tuple[Span, ...] = field(default=(), compare=False)

    def place_span(self) -> Span:
        """Where the place is named."""
        return self.spans[0] if self.spans else self.span

    def option_span(self, number: int) -> Span:
        """Where the option of that number is named."""
        return self.spans[1 + number] if self.spans else self.span


Node = Number | Truth | Name | Call | Unary | Binary | Conditional | Between | Chosen


def is_rollup(function: str, first: Node) -> bool:
    """Whether a call with that first argument rolls up a property; ``min``, ``count`` and others also take values."""
    return function in ROLLUPS and isinstance(first, Name) and "." not in first.path


@dataclass(frozen=True, slots=True)
class Expression:
    """A parsed expression with its text and where that starts in the user's file.

    Text that does not stand in the file as it is, on one line, has *pieces*.
    """

    text: str
    root: Node
    where: Location | None = None
    pieces: tuple[Piece, ...] = ()

    @property
    def origin(self) -> Origin:
        """Where the text stands, as exactly as it is known."""
        return self.pieces or self.where

    def location(self, span: Span) -> Location | None:
        """Where *span* starts in the user's file."""
        return locate(self.text, self.origin, span[0])
