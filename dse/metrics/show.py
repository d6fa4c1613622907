"""Units in which numbers are shown."""

from __future__ import annotations

from fractions import Fraction

from dse.units import DIMENSIONLESS, Dimension, Unit, parse_unit

_SYMBOLS = {
    "length": "m",
    "time": "s",
    "mass": "kg",
    "current": "A",
    "temperature": "K",
    "substance": "mol",
    "luminosity": "cd",
    "currency": "EUR",
    "operation": "operation",
}
_NAMED = ("N", "J", "W", "N/m", "V", "Pa")


def show_unit(wanted: Unit | None, dimension: Dimension) -> Unit:
    """The *wanted* unit if it has a symbol, else the SI unit of *dimension*."""
    if wanted is not None and wanted.symbol:
        return wanted
    return coherent_unit(dimension)


def coherent_unit(dimension: Dimension) -> Unit:
    """The SI unit of a dimension, by its own name where it has a well-known one."""
    if not dimension:
        return DIMENSIONLESS
    for name in _NAMED:
        unit = parse_unit(name)
        if unit.dimension == dimension:
            return unit
    over = [_factor(name, n) for name, n in dimension if n > 0]
    under = [_factor(name, -n) for name, n in dimension if n < 0]
    symbol = "*".join(over or ["1"]) + "".join(f"/{text}" for text in under)
    return Unit(symbol, Fraction(1), Fraction(0), dimension)


def _factor(name: str, exponent: Fraction) -> str:
    symbol = _SYMBOLS.get(name, name)
    return symbol if exponent == 1 else f"{symbol}^{float(exponent):g}"
