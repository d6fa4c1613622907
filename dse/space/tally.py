"""How many there are: a number, and whether it is known or estimated."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Tally:
    """A count; exact, or an estimate with its 95 % confidence interval [low, high]."""

    value: int
    exact: bool = True
    low: int = -1
    high: int = -1

    def __str__(self) -> str:
        if self.exact:
            return f"{self.value:,}"
        half = (self.high - self.low) / 2
        return f"≈ {self.value:.4g} ± {half:.2g} (95 %)"


def total_of(tallies: Iterable[Tally]) -> Tally:
    """The number of what several disjoint tallies count; the half-widths of independent estimates add as squares."""
    counted = list(tallies)
    value = sum(tally.value for tally in counted)
    unsure = [tally for tally in counted if not tally.exact]
    if not unsure:
        return Tally(value)
    half = math.isqrt(sum(((tally.high - tally.low) // 2 + 1) ** 2 for tally in unsure))
    return Tally(value, False, max(value - half, 0), value + half)
