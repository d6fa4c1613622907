"""Writes a constraint of a container in the names of the container: the reverse of `dse.loading.design.scope`."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

from dse.domain.expression import Binary, Call, Chosen, Expression, Name, Node, is_rollup
from dse.errors import DseError, Location
from dse.expression import rewritten, same, show_expression
from dse.loading.design.located_text import written
from dse.loading.design.scope import Scope, inside


def relative_rule(rule: Expression, scope: Scope, parts: Collection[str]) -> str | None:
    """The text that *rule* has within the container at *scope*; None if it cannot stand there."""
    root = rule.root
    if scope.guards:
        if not (isinstance(root, Binary) and root.operator == "implies"):
            return None
        root = root.right
    prefix = f"{scope.path}."

    def stripped(node: Node) -> Node:
        match node:
            case Chosen():
                return replace(node, place=node.place.removeprefix(prefix))
            case Name(path) if path != scope.path:
                return replace(node, path=path.removeprefix(prefix))
            case Call(function, (first, Name(path))) if path == scope.path and is_rollup(function, first):
                return replace(node, arguments=(first,))
        return node

    try:
        text = show_expression(rewritten(root, stripped))
        again = inside(scope, parts, written(text, Location(""))).parse()
    except DseError:
        return None
    return text if same(again.root, rule.root) else None
