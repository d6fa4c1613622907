"""What expressions refer to."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class Place(StrEnum):
    """What a symbol stands for."""

    VARIABLE = "variable"
    """A continuous or discrete variable, input or parameter; with *order* > 0 its time derivative."""
    PRE = "pre"
    """Value of a discrete variable (or of a state at an event) just before."""
    HELD = "held"
    """Truth of relation number *name*, as it was at the last event."""
    TIME = "time"
    INITIAL = "initial"
    """True during the initialization only."""


@dataclass(frozen=True, slots=True)
class Symbol:
    """What a leaf refers to. *order* counts time derivatives, of variables only."""

    place: Place
    name: str = ""
    order: int = 0

    def __str__(self) -> str:
        match self.place:
            case Place.VARIABLE:
                return "der(" * self.order + self.name + ")" * self.order
            case Place.PRE | Place.HELD:
                return f"{self.place}({self.name})"
        return str(self.place)


def variable(name: str, order: int = 0) -> Symbol:
    """The symbol of a variable or its derivative."""
    return Symbol(Place.VARIABLE, name, order)
