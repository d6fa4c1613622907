"""A design space as a tree to be drawn: what stands in what, and what can be chosen where."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from itertools import count

from dse.domain.design import Alternative, Compound, DesignSpace, Node, Optional, Part
from dse.errors import closest, fail
from dse.pictures import NodeKind, TreeNode
from dse.space.decisions import Choices
from dse.space.lowering.shape import VariableValue

ONE_OF = "one of"
"""The label of an alternative that is optional: its place is the optional node above."""


def tree_of(space: DesignSpace, choices: Choices | None = None, dead: Collection[VariableValue] = ()) -> TreeNode:
    """The tree of containers in the order of the file, with what is there under complete *choices*.

    What hangs below a branch in *dead*, a decision's position and one of its values' numbers, is dead.
    """
    return _Grower(choices, dead).node(space.root, "", space.name, there=True, dead=False)


def part_below(tree: TreeNode, path: str) -> TreeNode:
    """The part of the tree at and below *path*. Raises DseError if nothing stands there."""
    found = next((node for node in tree.all() if node.path == path), None)
    if found is None:
        known = {node.path for node in tree.all()} - {""}
        raise fail(f"there is no place '{path}' in '{tree.label}'", None, closest(path, known))
    return found


class _Grower:
    def __init__(self, choices: Choices | None, dead: Collection[VariableValue]) -> None:
        self.is_shown = choices is not None
        self.choices = choices or {}
        self.dead = dead
        self.positions = count()

    def node(
        self, node: Node, path: str, label: str, *, there: bool, dead: bool, decision: int | None = None
    ) -> TreeNode:
        """*decision* is the optional's that an alternative inside it shares."""
        if decision is None and isinstance(node, Alternative | Optional):
            decision = next(self.positions)
        # An optional place without its content is not there.
        chosen = there and (path in self.choices or not isinstance(node, Optional))
        below = tuple(self._below(node, path, there, dead, decision or 0))
        return TreeNode(_kind(node), label, path, chosen if self.is_shown else None, dead, below)

    def _below(self, node: Node, path: str, there: bool, dead: bool, decision: int) -> Iterator[TreeNode]:
        match node:
            case Compound():
                for name, child in node.parts.items():
                    label = f"{name}: {child.name}" if isinstance(child, Part) else name
                    yield self.node(child, f"{path}.{name}" if path else name, label, there=there, dead=dead)
            case Optional(Alternative((Compound() as only,))) if not only.parts:
                return  # connected or not
            case Optional(Alternative() as content):
                there = there and path in self.choices
                yield self.node(content, path, ONE_OF, there=there, dead=dead, decision=decision)
            case Optional(Part() | Compound() as content):
                yield self._option(content, path, there, dead, (decision, 0))
            case Alternative():
                for value, option in enumerate(node.options):
                    yield self._option(option, path, there, dead, (decision, value))

    def _option(self, node: Part | Compound, path: str, there: bool, dead: bool, branch: VariableValue) -> TreeNode:
        is_chosen = there and self.choices.get(path) == node.name
        return self.node(node, path, node.name, there=is_chosen, dead=dead or branch in self.dead)


def _kind(node: Node) -> NodeKind:
    match node:
        case Compound():
            return NodeKind.COMPOUND
        case Alternative():
            return NodeKind.ALTERNATIVE
        case Optional():
            return NodeKind.OPTIONAL
    return NodeKind.COMPONENT
