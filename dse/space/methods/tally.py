"""How many there are: a number, and whether it is known or estimated.

Counts are whole numbers of any size: what is shown of them is worked out from their digits, as no float holds them all.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from decimal import Decimal

_WRITTEN_OUT = 10**36
"""Numbers from here on have more digits than anyone reads."""


@dataclass(frozen=True, slots=True)
class Tally:
    """A count: *value* is *exact*, or an estimate with its 95 % confidence interval from *low* to *high*."""

    value: int
    exact: bool = True
    low: int = -1
    high: int = -1

    def __str__(self) -> str:
        if self.exact:
            return f"{self.value:,}" if self.value < _WRITTEN_OUT else significant(self.value, 4)
        return f"≈ {significant(self.value, 4)} ± {self.half_width} (95 %)"

    def __int__(self) -> int:
        return self.value

    @property
    def half_width(self) -> str:
        """Half the length of the interval, two digits of it."""
        length = self.high - self.low
        return f"{length / 2:.2g}" if length < 20 else significant(length // 2, 2)


def significant(number: int, figures: int) -> str:
    """*number* >= 0, rounded half to even to that many figures: ``1003``, ``1.003e24``."""
    if number < 10**figures:
        return str(number)
    digits, _, exponent = f"{Decimal(number):.{figures - 1}e}".partition("e+")
    return f"{digits.rstrip('0').rstrip('.')}e{exponent}"


def total_of(tallies: Iterable[Tally]) -> Tally:
    """The number of what several disjoint tallies count; the half-widths of independent estimates add as squares."""
    counted = list(tallies)
    value = sum(tally.value for tally in counted)
    unsure = [tally for tally in counted if not tally.exact]
    if not unsure:
        return Tally(value)
    half = math.isqrt(sum(((tally.high - tally.low) // 2 + 1) ** 2 for tally in unsure))
    return Tally(value, False, max(value - half, 0), value + half)
