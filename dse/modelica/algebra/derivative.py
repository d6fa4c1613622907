"""Derivatives of expressions: by one symbol, and by time."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping

from dse.errors import fail
from dse.modelica.algebra.expression import STEPS, Expression, Operands, shown
from dse.modelica.algebra.symbol import Symbol
from dse.modelica.algebra.traversal import walk

Rate = Callable[[Symbol], Expression]


def partial(expression: Expression, symbol: Symbol) -> Expression:
    """Derivative of *expression* by *symbol*, all other symbols held; steps have derivative 0 everywhere.

    At a kink (``abs``, ``minimum``, ``maximum``, a table's points) it is one of the two one-sided derivatives.
    Raises DseError for a third derivative of a table, or by an unknown that is a table's point.
    """
    graph = expression.graph
    one, zero = graph.constant(1.0), graph.constant(0.0)
    return derived((expression,), lambda leaf: one if leaf == symbol else zero)[0]


NO_RATE = "no derivative"
"""In place of the derivative of a ``prescribed`` value that has none."""


def derived(roots: Iterable[Expression], rate: Rate) -> list[Expression]:
    """Derivative of each of *roots* where each leaf changes with *rate* (chain rule, forward)."""
    listed = list(roots)
    done: dict[int, Expression] = {}
    for node in walk(listed, "prescribed"):
        graph = node.graph
        if node.symbol is not None:
            done[node.number] = rate(node.symbol)
        elif node.operator == "prescribed":
            if node.operands[1].name == NO_RATE:
                what = "the derivative of a function that is annotated with noDerivative and has inputs that vary"
                raise fail(f"{what} is not supported", hint="give its input by equations that need no derivative")
            done[node.number] = node.operands[1]
        elif node.operator == "array":
            elements = [done[operand.number] for operand in node.operands]
            is_still = all(element.is_number(0) for element in elements)
            done[node.number] = graph.constant(0.0) if is_still else graph.array(elements, node.shape)
        elif node.operator == "call":
            done[node.number] = _of_call(node, [done[operand.number] for operand in node.operands])
        else:
            rates = [done[operand.number] for operand in node.operands]
            is_still = node.is_constant or node.operator in STEPS or all(one.is_number(0) for one in rates)
            done[node.number] = graph.constant(0.0) if is_still else _of_operator(node, rates)
    return [done[root.number] for root in listed]


def _of_operator(node: Expression, rates: list[Expression]) -> Expression:
    if node.operator in _OUTER:
        return _OUTER[node.operator](node, node.operands[0]) * rates[0]
    if node.operator not in _RATES:
        raise fail(f"'{node.operator}' has no derivative here")
    return _RATES[node.operator](node, node.operands, rates)


def _of_power(node: Expression, operands: Operands, rates: list[Expression]) -> Expression:
    base, exponent = operands
    by_base = exponent * node.graph.make("power", base, exponent - 1.0) * rates[0]
    if rates[1].is_number(0):
        return by_base
    return by_base + node * node.graph.make("log", base) * rates[1]


def _of_extreme(comparison: str) -> _Rule:
    def rule(node: Expression, x: Operands, rates: list[Expression]) -> Expression:
        return node.graph.make("if", node.graph.make(comparison, x[1], x[0]), rates[1], rates[0])

    return rule


_Rule = Callable[[Expression, Operands, list[Expression]], Expression]
_RATES: Mapping[str, _Rule] = {
    "add": lambda _, _x, rates: rates[0] + rates[1],
    "subtract": lambda _, _x, rates: rates[0] - rates[1],
    "negate": lambda _, _x, rates: -rates[0],
    "multiply": lambda _, x, rates: rates[0] * x[1] + x[0] * rates[1],
    "divide": lambda y, x, rates: (rates[0] - y * rates[1]) / x[1],
    "power": _of_power,
    "if": lambda y, x, rates: y.graph.make("if", x[0], rates[1], rates[2]),
    "minimum": _of_extreme("less"),
    "maximum": _of_extreme("greater"),
    "select": lambda y, x, rates: rates[0] if rates[0].is_number(0) else y.graph.make("select", rates[0], *x[1:]),
    "atan2": lambda _, x, rates: (x[1] * rates[0] - x[0] * rates[1]) / (x[1] * x[1] + x[0] * x[0]),
}
"""Derivative of a function of operands x by their rates; y is its value."""
# fmt: off
_OUTER: Mapping[str, Callable[[Expression, Expression], Expression]] = {
    "abs": lambda _, x: x.graph.make("if", x.graph.make("less", x, x.graph.of(0.0)), x.graph.of(-1.0), x.graph.of(1.0)),
    "sqrt": lambda y, _: 0.5 / y, "sin": lambda _, x: x.graph.make("cos", x),
    "cos": lambda _, x: -x.graph.make("sin", x), "tan": lambda y, _: 1.0 + y * y,
    "asin": lambda _, x: 1.0 / x.graph.make("sqrt", 1.0 - x * x),
    "acos": lambda _, x: -1.0 / x.graph.make("sqrt", 1.0 - x * x), "atan": lambda _, x: 1.0 / (1.0 + x * x),
    "sinh": lambda _, x: x.graph.make("cosh", x), "cosh": lambda _, x: x.graph.make("sinh", x),
    "tanh": lambda y, _: 1.0 - y * y, "exp": lambda y, _: y, "log": lambda _, x: 1.0 / x,
    "log10": lambda _, x: (1.0 / math.log(10.0)) / x,
}
# fmt: on
"""Derivative of a function y of one operand x by that operand."""


def _of_call(node: Expression, rates: list[Expression]) -> Expression:
    counts = {"table1": 1, "table2": 2}
    if node.name not in counts:
        raise fail(f"'{node.name}' has no derivative here")
    count = counts[node.name]
    if any(not rate.is_number(0) for rate in rates[2 * count :]):
        raise fail(f"the points of the table in {shown(node)} would have to be solved for", hint="make them parameters")
    graph = node.graph
    sum_ = graph.constant(0.0)
    for axis in range(count):
        rate = rates[count + axis]
        if rate.is_number(0):
            continue
        orders = list(node.operands[:count])
        if sum(order.value for order in orders) >= 2:
            raise fail(
                f"a third derivative of a table would be needed: {shown(node)}", hint="let the table act through a lag"
            )
        orders[axis] = orders[axis] + 1.0
        sum_ = sum_ + graph.call(node.name, (*orders, *node.operands[count:])) * rate
    return sum_
