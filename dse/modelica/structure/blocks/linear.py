"""Solving one equation for one symbol in closed form."""

from __future__ import annotations

from dse.modelica.algebra.derivative import partial
from dse.modelica.algebra.expression import Expression
from dse.modelica.algebra.symbol import Symbol
from dse.modelica.algebra.traversal import replaced, stepping, symbols
from dse.modelica.structure.known import Known


def coefficient(residual: Expression, symbol: Symbol) -> Expression | None:
    """Factor a in residual = a * symbol + b, where a and b do not refer to *symbol*; None if it is not linear in it."""
    if symbol in stepping(residual):
        return None
    factor = partial(residual, symbol)
    return None if symbol in symbols(factor) else factor


def solved_for(residual: Expression, symbol: Symbol, known: Known) -> Expression | None:
    """What *symbol* equals where *residual* vanishes, or None if there is no closed form that always holds.

    Divides only by what is never 0 as far as *known* can tell.
    """
    graph = residual.graph
    node, target = residual, graph.constant(0.0)
    while node.symbol != symbol:
        inside = [symbol in symbols(operand) for operand in node.operands]
        if sum(inside) != 1 or node.operator not in ("add", "subtract", "negate", "multiply", "divide"):
            return _by_coefficient(node, target, symbol, known)
        if node.operator == "negate":
            node, target = node.operands[0], -target
            continue
        left, right = node.operands
        match node.operator, inside[0]:
            case "add", is_left:
                node, target = (left, target - right) if is_left else (right, target - left)
            case "subtract", True:
                node, target = left, target + right
            case "subtract", False:
                node, target = right, left - target
            case "multiply", is_left:
                factor = right if is_left else left
                if not known.is_never_zero(factor):
                    return None
                node, target = (left if is_left else right), target / factor
            case "divide", True:
                node, target = left, target * right
            case _:
                return None
    return target


def _by_coefficient(node: Expression, target: Expression, symbol: Symbol, known: Known) -> Expression | None:
    factor = coefficient(node, symbol)
    if factor is None or not known.is_never_zero(factor):
        return None
    zero = node.graph.constant(0.0)
    (rest,) = replaced((node,), lambda one: zero if one.symbol == symbol else None)
    return (target - rest) / factor
