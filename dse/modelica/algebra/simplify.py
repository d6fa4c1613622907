"""Operators in their simplest form.

The rules keep every finite value to the bit, apart from the sign of a zero. What a rule may lose is a value that is
not finite: ``0 * x``, ``0 / x`` and ``x - x`` become 0 although they are NaN where x is not finite (or where ``0 / x``
divides by 0); without this no Jacobian would have a structural zero. ``x / x`` stays, since its 0 / 0 is a singular
equation to be told. Sums and products are never regrouped: that would round differently. Numbers are folded unless the
result is not finite, so that ``1 / 0`` stays visible to whoever has a file and a line for it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

from dse.modelica.algebra.arithmetic import FUNCTIONS

if TYPE_CHECKING:
    from dse.modelica.algebra.expression import Expression, Graph

_TRUTH = frozenset({"less", "less_equal", "greater", "greater_equal", "equal", "not_equal", "and", "or", "not"})


def simplified(graph: Graph, operator: str, operands: tuple[Expression, ...]) -> Expression:
    """*operator* over *operands* in its simplest form. Truth operands are taken to be 0 or 1."""
    if operator in FUNCTIONS and all(operand.is_constant for operand in operands):
        value = FUNCTIONS[operator](*(operand.value for operand in operands))
        if math.isfinite(value):
            return graph.constant(value)
    rule = _RULES.get(operator)
    found = rule(graph, operands) if rule else None
    return graph.node(operator, operands) if found is None else found


def _is_negated(node: Expression) -> bool:
    return node.operator == "negate"


def _add(graph: Graph, operands: tuple[Expression, ...]) -> Expression | None:
    left, right = operands
    if left.is_number(0):
        return right
    if right.is_number(0):
        return left
    if _is_negated(right):
        return graph.make("subtract", left, right.operands[0])
    if _is_negated(left):
        return graph.make("subtract", right, left.operands[0])
    return None


def _subtract(graph: Graph, operands: tuple[Expression, ...]) -> Expression | None:
    left, right = operands
    if right.is_number(0):
        return left
    if left is right:
        return graph.constant(0.0)
    if left.is_number(0):
        return graph.make("negate", right)
    if _is_negated(right):
        return graph.make("add", left, right.operands[0])
    return None


def _negate(graph: Graph, operands: tuple[Expression, ...]) -> Expression | None:
    (inner,) = operands
    if _is_negated(inner):
        return inner.operands[0]
    if inner.operator == "subtract":
        return graph.make("subtract", inner.operands[1], inner.operands[0])
    return None


def _multiply(graph: Graph, operands: tuple[Expression, ...]) -> Expression | None:
    left, right = operands
    for one, other in ((left, right), (right, left)):
        if one.is_number(0):
            return graph.constant(0.0)
        if one.is_number(1):
            return other
        if one.is_number(-1):
            return graph.make("negate", other)
    if _is_negated(left) and _is_negated(right):
        return graph.make("multiply", left.operands[0], right.operands[0])
    if _is_negated(left):
        return graph.make("negate", graph.make("multiply", left.operands[0], right))
    if _is_negated(right):
        return graph.make("negate", graph.make("multiply", left, right.operands[0]))
    return None


def _divide(graph: Graph, operands: tuple[Expression, ...]) -> Expression | None:
    left, right = operands
    if right.is_number(1):
        return left
    if right.is_number(-1):
        return graph.make("negate", left)
    if left.is_number(0) and not right.is_number(0):
        return graph.constant(0.0)
    if _is_negated(left) and _is_negated(right):
        return graph.make("divide", left.operands[0], right.operands[0])
    if _is_negated(left):
        return graph.make("negate", graph.make("divide", left.operands[0], right))
    if _is_negated(right):
        return graph.make("negate", graph.make("divide", left, right.operands[0]))
    return None


def _power(graph: Graph, operands: tuple[Expression, ...]) -> Expression | None:
    base, exponent = operands
    if exponent.is_number(0):
        return graph.constant(1.0)
    return base if exponent.is_number(1) else None


def _same(_: Graph, operands: tuple[Expression, ...]) -> Expression | None:
    return operands[0] if operands[0] is operands[1] else None


def _reflexive(value: float) -> Callable[[Graph, tuple[Expression, ...]], Expression | None]:
    def rule(graph: Graph, operands: tuple[Expression, ...]) -> Expression | None:
        return graph.constant(value) if operands[0] is operands[1] else None

    return rule


def _junction(neutral: float) -> Callable[[Graph, tuple[Expression, ...]], Expression | None]:
    def rule(graph: Graph, operands: tuple[Expression, ...]) -> Expression | None:
        left, right = operands
        for one, other in ((left, right), (right, left)):
            if one.is_constant:
                return other if (one.value != 0) == (neutral != 0) else graph.constant(1.0 - neutral)
        return left if left is right else None

    return rule


def _not(_: Graph, operands: tuple[Expression, ...]) -> Expression | None:
    (inner,) = operands
    return inner.operands[0] if inner.operator == "not" else None


def _if(graph: Graph, operands: tuple[Expression, ...]) -> Expression | None:
    condition, yes, no = operands
    if condition.is_constant:
        return yes if condition.value != 0 else no
    if yes is no:
        return yes
    if condition.operator == "not":
        return graph.make("if", condition.operands[0], no, yes)
    if condition.operator in _TRUTH and yes.is_number(1) and no.is_number(0):
        return condition
    return None


def _abs(graph: Graph, operands: tuple[Expression, ...]) -> Expression | None:
    (inner,) = operands
    if inner.operator == "abs":
        return inner
    return graph.make("abs", inner.operands[0]) if _is_negated(inner) else None


def _select(_: Graph, operands: tuple[Expression, ...]) -> Expression | None:
    array, *indices = operands
    if not indices or array.operator != "array" or not all(index.is_constant for index in indices):
        return None
    place = 0
    for index, size in zip(indices, array.shape, strict=True):
        if not (index.value.is_integer() and 1 <= index.value <= size):
            return None
        place = place * size + int(index.value) - 1
    return array.operands[place]


_RULES: Mapping[str, Callable[[Graph, tuple[Expression, ...]], Expression | None]] = {
    "add": _add,
    "subtract": _subtract,
    "negate": _negate,
    "multiply": _multiply,
    "divide": _divide,
    "power": _power,
    "minimum": _same,
    "maximum": _same,
    "less": _reflexive(0.0),
    "less_equal": _reflexive(1.0),
    "greater": _reflexive(0.0),
    "greater_equal": _reflexive(1.0),
    "equal": _reflexive(1.0),
    "not_equal": _reflexive(0.0),
    "and": _junction(1.0),
    "or": _junction(0.0),
    "not": _not,
    "if": _if,
    "abs": _abs,
    "select": _select,
}
