"""Changes expressions from the leaves up."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from dse.domain.expression import Between, Binary, Call, Conditional, Node, Unary


def rewritten(node: Node, change: Callable[[Node], Node]) -> Node:
    """*node* after *change* was applied to all in it, inner ones first, to itself last."""
    match node:
        case Call():
            arguments = tuple(rewritten(argument, change) for argument in node.arguments)
            options = tuple((name, rewritten(value, change)) for name, value in node.options)
            node = replace(node, arguments=arguments, options=options)
        case Unary():
            node = replace(node, operand=rewritten(node.operand, change))
        case Binary():
            node = replace(node, left=rewritten(node.left, change), right=rewritten(node.right, change))
        case Conditional():
            condition, yes, no = (rewritten(part, change) for part in (node.condition, node.yes, node.no))
            node = replace(node, condition=condition, yes=yes, no=no)
        case Between():
            value, low, high = (rewritten(part, change) for part in (node.value, node.low, node.high))
            node = replace(node, value=value, low=low, high=high)
    return change(node)
