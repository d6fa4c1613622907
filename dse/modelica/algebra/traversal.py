"""Walking through expressions: what they refer to, and by which of it they can be solved."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

from dse.modelica.algebra.expression import STEPS, Expression
from dse.modelica.algebra.symbol import Referent, Symbol


def walk(roots: Iterable[Expression], closed: str = "") -> Iterator[Expression]:
    """Every expression below and including *roots* once, operands before what uses them.

    Nothing below expressions of the operator *closed*.
    """
    seen: set[int] = set()
    stack: list[tuple[Expression, bool]] = [(root, False) for root in reversed(list(roots))]
    while stack:
        node, is_open = stack.pop()
        if is_open:
            yield node
        elif node.number not in seen:
            seen.add(node.number)
            stack.append((node, True))
            if node.operator == closed:
                continue
            stack.extend((operand, False) for operand in reversed(node.operands) if operand.number not in seen)


def replaced(roots: Iterable[Expression], new: Callable[[Expression], Expression | None]) -> list[Expression]:
    """*roots* with every expression for which *new* gives another replaced, from the leaves up."""
    done: dict[int, Expression] = {}
    listed = list(roots)
    for node in walk(listed):
        other = new(node)
        if other is None and node.operands:
            operands = tuple(done[operand.number] for operand in node.operands)
            if all(a is b for a, b in zip(operands, node.operands, strict=True)):
                other = node
            elif node.operator in ("array", "call"):
                other = node.graph.node(node.operator, operands, node.name, node.shape)
            else:
                other = node.graph.make(node.operator, *operands)
        done[node.number] = node if other is None else other
    return [done[root.number] for root in listed]


def symbols(*roots: Expression) -> dict[Symbol, None]:
    """All symbols of *roots*, in a reproducible order."""
    return {node.symbol: None for node in walk(roots) if node.symbol is not None}


def actual(root: Expression) -> Expression:
    """*root* at the end of a continuation: ``homotopy`` is its actual expression."""
    share = Symbol(referent=Referent.CONTINUED)
    if not root.graph.knows(share):
        return root
    one = root.graph.constant(1.0)
    return replaced((root,), lambda node: one if node.symbol == share else None)[0]


def without_rates(root: Expression) -> Expression:
    """*root* after the index reduction: each ``prescribed`` value without its derivative."""

    def new(node: Expression) -> Expression | None:
        return without_rates(node.operands[0]) if node.operator == "prescribed" else None

    return replaced((root,), new)[0]


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
    return symbols(*inside)


def _continuous_operands(node: Expression) -> tuple[Expression, ...]:
    match node.operator:
        case "if":
            return node.operands[1:]
        case "select" | "prescribed":
            return node.operands[:1]
    return node.operands
