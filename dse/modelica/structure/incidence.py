"""Which symbols an expression refers to, and through which of them it can be solved."""

from __future__ import annotations

from dse.modelica.algebra.expression import STEPS, Expression, Symbol, walk


def occurring(*roots: Expression) -> dict[Symbol, None]:
    """All symbols of *roots*, in a reproducible order."""
    return {node.symbol: None for node in walk(roots) if node.symbol is not None}


def smooth(root: Expression) -> dict[Symbol, None]:
    """Symbols by which *root* has a derivative that is not 0 everywhere: not those inside steps and conditions only."""
    found: dict[Symbol, None] = {}
    seen: set[int] = set()
    stack = [root]
    while stack:
        node = stack.pop()
        if node.number in seen or node.operator in STEPS:
            continue
        seen.add(node.number)
        if node.symbol is not None:
            found[node.symbol] = None
        stack.extend(reversed(_continuous_operands(node)))
    return found


def stepping(*roots: Expression) -> dict[Symbol, None]:
    """Symbols that *roots* refer to inside steps, conditions and indices, whether elsewhere too or not."""
    inside: list[Expression] = []
    for node in walk(roots):
        if node.operator in STEPS:
            inside.append(node)
        elif node.operator == "if":
            inside.append(node.operands[0])
        elif node.operator == "select":
            inside.extend(node.operands[1:])
    return occurring(*inside)


def _continuous_operands(node: Expression) -> tuple[Expression, ...]:
    match node.operator:
        case "if":
            return node.operands[1:]
        case "select":
            return node.operands[:1]
    return node.operands
