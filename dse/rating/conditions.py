"""Which cells of a test a part of a rating is for: a condition over their attributes."""

from __future__ import annotations

import operator
from collections.abc import Callable, Mapping
from fractions import Fraction

from dse.domain.expression import Between, Binary, Chosen, Expression, Name, Node, Number, Unary
from dse.errors import closest
from dse.expression import error_in
from dse.units import UnitError, describe, parse_quantity

_COMPARED: Mapping[str, Callable[[Fraction, Fraction], bool]] = {
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
    "==": operator.eq,
    "!=": operator.ne,
}


def is_met(condition: Expression, attributes: Mapping[str, str]) -> bool:
    """Whether a cell with these *attributes*, by the names the condition has for them, meets it. Raises DseError."""
    return _truth(condition, condition.root, {name: text.lower() for name, text in attributes.items()})


def _truth(whole: Expression, node: Node, attributes: Mapping[str, str]) -> bool:
    match node:
        case Binary("and", left, right):
            return _truth(whole, left, attributes) & _truth(whole, right, attributes)
        case Binary("or", left, right):
            return _truth(whole, left, attributes) | _truth(whole, right, attributes)
        case Unary("not", operand):
            return not _truth(whole, operand, attributes)
        case Chosen(place=name, options=options):
            return _text(whole, name, node, attributes) in {option.lower() for option in options}
        case Between(Name(path=name), Number() as low, Number() as high):
            return low.si <= _number(whole, name, node, low, attributes) <= high.si
        case Binary(sign, Name(path=name), Number() as bound) if sign in _COMPARED:
            return _COMPARED[sign](_number(whole, name, node, bound, attributes), bound.si)
        case Binary("==" | "!=" as sign, Name(path=name), Name(path=word)):
            return (_text(whole, name, node, attributes) == word.lower()) == (sign == "==")
    raise error_in(
        whole, node.span, "this is not a condition on an attribute", "as 'vut_speed >= 40 km/h and turn == farside'"
    )


def _text(whole: Expression, name: str, node: Node, attributes: Mapping[str, str]) -> str:
    if name not in attributes:
        raise error_in(whole, node.span, f"the cells have no attribute '{name}'", closest(name, attributes))
    return attributes[name]


def _number(whole: Expression, name: str, node: Node, bound: Number, attributes: Mapping[str, str]) -> Fraction:
    text = _text(whole, name, node, attributes)
    try:
        found = parse_quantity(text.replace("%", " %"))
    except UnitError:
        raise error_in(whole, bound.span, f"'{text}' is not a quantity", f"{name} == {text}") from None
    if found.unit.dimension != bound.unit.dimension:
        what = f"{name} is {describe(found.unit.dimension)}, not {describe(bound.unit.dimension)}"
        raise error_in(whole, bound.span, what, "write a quantity of the same kind")
    return found.si
