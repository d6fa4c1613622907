"""A design space as a directed graph: what stands in what, and what can be chosen where."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from typing import TYPE_CHECKING

from dse.domain.design import Alternative, Compound, DesignSpace, Node, Optional, Part
from dse.errors import closest, fail
from dse.pictures.tree_layout import NodeKind
from dse.space.decisions import Choices
from dse.space.lowering.shape import Branch

if TYPE_CHECKING:
    import networkx as nx

ONE_OF = "one of"
"""The label of an alternative that is optional: its place is the optional node above."""


@dataclass(frozen=True, slots=True)
class _Pending:
    """*above* is the node to hang it below, *decision* the optional's that an alternative inside it shares."""

    node: Node
    path: str
    label: str
    above: int | None
    branch: Branch | None = None
    decision: int | None = None
    is_there: bool = True
    is_dead: bool = False


def graph(space: DesignSpace, choices: Choices | None = None, dead: Collection[Branch] = ()) -> nx.DiGraph[int]:
    """The tree of containers, parents before children in the order of the file; nodes are numbered from the root, 0.

    Nodes have *kind* (a `NodeKind`), *label*, *path*, *name* (of the component or architecture, else ""), *chosen*
    (whether it is there under complete *choices*; None without) and *dead* (it hangs below a branch in *dead*).
    Edges have *kind*: that of the node above, so that those below an alternative are its options.
    """
    import networkx as nx

    found: nx.DiGraph[int] = nx.DiGraph(name=space.name)
    pending = [_Pending(space.root, "", space.name, None)]
    decisions = 0
    while pending:
        at = pending.pop()
        number = len(found)
        position = at.decision
        if position is None and isinstance(at.node, Alternative | Optional):
            position, decisions = decisions, decisions + 1
        found.add_node(
            number,
            kind=_kind(at.node),
            label=at.label,
            path=at.path,
            name=at.node.name if isinstance(at.node, Part | Compound) else "",
            chosen=None if choices is None else _is_chosen(at, choices),
            dead=at.is_dead,
        )
        if at.above is not None:
            found.add_edge(at.above, number, kind=found.nodes[at.above]["kind"])
        pending += reversed(_below(at, number, position, choices or {}, dead))
    return found


def part_below(whole: nx.DiGraph[int], path: str) -> nx.DiGraph[int]:
    """The part of the graph at and below *path*. Raises DseError if nothing stands there."""
    import networkx as nx

    roots = [node for node, data in whole.nodes(data=True) if data["path"] == path]
    if not roots:
        known = {data["path"] for _, data in whole.nodes(data=True)} - {""}
        raise fail(f"there is no place '{path}' in '{whole.name}'", None, closest(path, known))
    wanted = {roots[0], *nx.descendants(whole, roots[0])}
    part: nx.DiGraph[int] = nx.DiGraph(whole.subgraph(wanted))
    return part


def _kind(node: Node) -> NodeKind:
    match node:
        case Compound():
            return NodeKind.COMPOUND
        case Alternative():
            return NodeKind.ALTERNATIVE
        case Optional():
            return NodeKind.OPTIONAL
    return NodeKind.COMPONENT


def _is_chosen(at: _Pending, choices: Choices) -> bool:
    """Whether it is there; an optional place without its content is not."""
    return at.is_there and (at.path in choices or not isinstance(at.node, Optional))


def _below(
    at: _Pending, number: int, position: int | None, choices: Choices, dead: Collection[Branch]
) -> list[_Pending]:
    match at.node:
        case Part():
            return []
        case Compound(parts=parts):
            return [
                _Pending(
                    child,
                    f"{at.path}.{name}" if at.path else name,
                    f"{name}: {child.name}" if isinstance(child, Part) else name,
                    number,
                    is_there=at.is_there,
                    is_dead=at.is_dead,
                )
                for name, child in parts.items()
            ]
        case Optional(content=content):
            if isinstance(content, Part | Compound):
                return [_option(content, 0, at, number, position, choices, dead)]
            there = at.is_there and at.path in choices
            return [_Pending(content, at.path, ONE_OF, number, None, position, there, at.is_dead)]
        case Alternative(options=options):
            return [_option(option, value, at, number, position, choices, dead) for value, option in enumerate(options)]


def _option(
    node: Part | Compound,
    value: int,
    at: _Pending,
    number: int,
    position: int | None,
    choices: Choices,
    dead: Collection[Branch],
) -> _Pending:
    assert position is not None  # noqa: S101  # what has options is a decision
    branch = (position, value)
    there = at.is_there and choices.get(at.path) == node.name
    return _Pending(node, at.path, node.name, number, branch, None, there, at.is_dead or branch in dead)
