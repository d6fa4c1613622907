"""Expressions as trees: going through them, comparing them and putting them together."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import fields, replace
from typing import Any

from dse.domain.expression import Between, Binary, Call, Chosen, Conditional, Name, Node, Number, Span, Truth, Unary

DEEPEST = 200
"""Levels a tree may have, so that whoever walks it can recurse."""


def children(node: Node) -> tuple[Node, ...]:
    """The expressions directly below *node*, in the order they are written."""
    match node:
        case Number() | Truth() | Name() | Chosen():
            return ()
        case Call():
            return (*node.arguments, *(value for _, value in node.options))
        case Unary():
            return (node.operand,)
        case Binary():
            return (node.left, node.right)
        case Conditional():
            return (node.condition, node.yes, node.no)
        case Between():
            return (node.value, node.low, node.high)


def descend(node: Node) -> Iterator[Node]:
    """*node* and every expression below it."""
    stack = [node]
    while stack:
        node = stack.pop()
        yield node
        stack.extend(reversed(children(node)))


def too_deep(root: Node) -> Node | None:
    """A node of more than `DEEPEST` levels down from *root*; None if there is none."""
    stack = [(root, 1)]
    while stack:
        node, level = stack.pop()
        if level > DEEPEST:
            return node
        stack += [(child, level + 1) for child in children(node)]
    return None


def rewritten(node: Node, change: Callable[[Node], Node]) -> Node:
    """*node* after *change* was applied to all in it, inner ones first, to itself last."""

    def inside(value: object) -> object:
        if isinstance(value, tuple):
            return tuple(inside(part) for part in value)
        return rewritten(value, change) if isinstance(value, Node) else value

    changed: dict[str, Any] = {field.name: inside(getattr(node, field.name)) for field in fields(node)}
    return change(replace(node, **changed))


def same(a: Node, b: Node) -> bool:
    """Whether two trees are equal wherever they stand."""
    stack: list[tuple[object, object]] = [(a, b)]
    while stack:
        left, right = stack.pop()
        if type(left) is not type(right):
            return False
        if isinstance(left, tuple) and isinstance(right, tuple):
            if len(left) != len(right):
                return False
            stack += zip(left, right, strict=True)
        elif isinstance(left, Node):
            compared = (field.name for field in fields(left) if field.compare and field.name != "span")
            stack += [(getattr(left, name), getattr(right, name)) for name in compared]
        elif left != right:
            return False
    return True


def balanced(operator: str, terms: list[tuple[Node, Span]]) -> Node:
    """The terms, each with where it stands, brackets included, as a tree of few levels."""
    while len(terms) > 1:
        pairs = zip(terms[::2], terms[1::2], strict=False)
        spans = [(left, right, (at[0], till[1])) for (left, at), (right, till) in pairs]
        joined: list[tuple[Node, Span]] = [(Binary(operator, left, right, span), span) for left, right, span in spans]
        terms = [*joined, terms[-1]] if len(terms) % 2 else joined
    return terms[0][0]
