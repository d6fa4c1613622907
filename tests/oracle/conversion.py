"""Values on their way between elements, in plain Python: the same operations in the same order as in convert.h."""

from __future__ import annotations

from dse.domain.system import Conversion


def outside(conversion: Conversion | None, inside: float) -> float | None:
    """What is *inside* of an FMU as it is outside; None if it is no item that is known."""
    if conversion is None:
        return inside
    if conversion.items:
        return next((outer for inner, outer in conversion.items if inner == inside), None)
    return conversion.factor * inside + conversion.offset


def inside(conversion: Conversion | None, outer: float) -> float | None:
    """What an FMU is given for the value *outer*; None if it is no item that is known."""
    if conversion is None:
        return outer
    if conversion.items:
        return next((inner for inner, known in conversion.items if known == outer), None)
    return (outer - conversion.offset) / conversion.factor


def carried(transform: Conversion | None, value: float) -> float:
    """What arrives at the end of a wire that begins with *value*; what it has no item for is passed on as it is."""
    found = outside(transform, value)
    return value if found is None else found
