"""What expressions refer to."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class Referent(StrEnum):
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
    CONTINUED = "continued"
    """In ``homotopy``: how far from the simplified expression, 0, to the actual one, 1; always 1 after the start."""


@dataclass(frozen=True, slots=True)
class Symbol:
    """What a leaf refers to. *order* counts time derivatives, of variables only."""

    name: str = ""
    order: int = 0
    referent: Referent = Referent.VARIABLE

    def __str__(self) -> str:
        match self.referent:
            case Referent.VARIABLE:
                return "der(" * self.order + self.name + ")" * self.order
            case Referent.PRE | Referent.HELD:
                return f"{self.referent}({self.name})"
        return str(self.referent)

    @property
    def derivative(self) -> Symbol:
        """Its time derivative."""
        return Symbol(self.name, self.order + 1)

    @property
    def is_variable(self) -> bool:
        """Whether it is a variable or a derivative."""
        return self.referent is Referent.VARIABLE
