"""Derivatives of expressions: by one symbol, and by time."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping

from dse.errors import fail
from dse.modelica.algebra.expression import STEPS, Expression, Graph, shown
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
            done[node.number] = _of_call(graph, node, [done[operand.number] for operand in node.operands])
        else:
            rates = [done[operand.number] for operand in node.operands]
            is_still = node.is_constant or node.operator in STEPS or all(one.is_number(0) for one in rates)
            done[node.number] = graph.constant(0.0) if is_still else _of_operator(graph, node, rates)
    return [done[root.number] for root in listed]


def _of_operator(graph: Graph, node: Expression, rates: list[Expression]) -> Expression:
    match node.operator:
        case "add":
            return rates[0] + rates[1]
        case "subtract":
            return rates[0] - rates[1]
        case "negate":
            return -rates[0]
        case "multiply":
            return rates[0] * node.operands[1] + node.operands[0] * rates[1]
        case "divide":
            return (rates[0] - node * rates[1]) / node.operands[1]
        case "power":
            return _of_power(graph, node, rates)
        case "if":
            return graph.make("if", node.operands[0], rates[1], rates[2])
        case "minimum" | "maximum":
            comparison = "less" if node.operator == "minimum" else "greater"
            return graph.make("if", graph.make(comparison, node.operands[1], node.operands[0]), rates[1], rates[0])
        case "select":
            if rates[0].is_number(0):
                return rates[0]
            return graph.make("select", rates[0], *node.operands[1:])
        case "atan2":
            y, x = node.operands
            return (x * rates[0] - y * rates[1]) / (x * x + y * y)
    if node.operator not in _OUTER:
        raise fail(f"'{node.operator}' has no derivative here")
    return _OUTER[node.operator](node, node.operands[0]) * rates[0]


def _of_power(graph: Graph, node: Expression, rates: list[Expression]) -> Expression:
    base, exponent = node.operands
    by_base = exponent * graph.make("power", base, exponent - 1.0) * rates[0]
    if rates[1].is_number(0):
        return by_base
    return by_base + node * graph.make("log", base) * rates[1]


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


def _of_call(graph: Graph, node: Expression, rates: list[Expression]) -> Expression:
    counts = {"table1": 1, "table2": 2}
    if node.name not in counts:
        raise fail(f"'{node.name}' has no derivative here")
    count = counts[node.name]
    if any(not rate.is_number(0) for rate in rates[2 * count :]):
        raise fail(f"the points of the table in {shown(node)} would have to be solved for", hint="make them parameters")
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
