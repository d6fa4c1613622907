"""Sums in which a term and its opposite cancel."""

from __future__ import annotations

from dse.modelica.algebra.expression import Expression


def cancelled(residual: Expression) -> Expression:
    """*residual* without terms that occur with both signs, like ``(a + b) - a``; the same object if there are none.

    After aliases were put in, balances of flows are full of them; they would pass for terms that can be solved for.
    """
    terms: list[tuple[Expression, int]] = []
    stack = [(residual, 1)]
    while stack:
        node, sign = stack.pop()
        match node.operator:
            case "negate":
                stack.append((node.operands[0], -sign))
            case "add":
                stack.extend([(node.operands[1], sign), (node.operands[0], sign)])
            case "subtract":
                stack.extend([(node.operands[1], -sign), (node.operands[0], sign)])
            case _:
                terms.append((node, sign))
    balance: dict[int, int] = {}
    count: dict[int, int] = {}
    for term, sign in terms:
        balance[term.number] = balance.get(term.number, 0) + sign
        count[term.number] = count.get(term.number, 0) + 1
    if all(abs(balance[number]) == times for number, times in count.items()):
        return residual
    total = residual.graph.constant(0.0)
    for term, sign in terms:
        left = balance[term.number]
        if left * sign > 0:
            balance[term.number] = left - sign
            total = total + term if sign > 0 else total - term
    return total
