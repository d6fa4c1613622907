"""SI numbers as a person reads them, in a unit."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from dse.storage import Units

_MOST_DIGITS = 10  # of a value with an error bar; a bar below them is rounding


def units_called(name: str) -> Units:
    """The units numbers leave in by their name, ``shown`` or ``si``. Raises DseError for another."""
    from dse.errors import closest, fail
    from dse.storage import Units

    known = {str(each): each for each in Units}
    if name not in known:
        raise fail(f"'{name}' are no units of a table", None, closest(name, known))
    return known[name]


def quantity(value: float, unit: str) -> str:
    """An SI number in *unit* as a person reads it; a dash where it is undefined."""
    from dse.units import parse_unit, short_symbol, shown

    return f"{shown(parse_unit(unit).from_si(value))} {short_symbol(unit)}".rstrip() if not math.isnan(value) else "–"


def checked_quantity(value: float, bar: float | None, unit: str) -> str:
    """As `quantity`, with an error bar of two digits if there is one, and the value to the bar's last digit."""
    from dse.units import parse_unit, short_symbol, shown

    if bar is None or not math.isfinite(value):
        return quantity(value, unit)
    middle, size = parse_unit(unit).from_si(value), bar / float(parse_unit(unit).factor)
    if math.isnan(bar):
        return f"{shown(middle)} ± ? {short_symbol(unit)}".rstrip()
    if not 0.0 < size < math.inf:
        return f"{shown(middle)} ± {'∞' if size else 0} {short_symbol(unit)}".rstrip()
    decimals = 1 - math.floor(math.log10(size))
    digits = decimals + math.floor(math.log10(max(abs(middle), size))) + 1
    if decimals < 0 or digits > _MOST_DIGITS:
        return f"{middle:.{_MOST_DIGITS}g} ± {size:.2g} {short_symbol(unit)}".rstrip()
    return f"{middle:.{decimals}f} ± {size:.{decimals}f} {short_symbol(unit)}".rstrip()


def difference(value: float, unit: str) -> str:
    """A difference of SI numbers in *unit*: as `quantity`, but 20 degC are 20 K apart from 0 degC, not 293 K."""
    from dse.units import parse_unit, short_symbol, shown

    if math.isnan(value):
        return "–"
    return f"{shown(value / float(parse_unit(unit).factor))} {short_symbol(unit)}".rstrip()
