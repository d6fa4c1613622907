"""A decision-DNNF: the models of a set of clauses as a graph of decisions and independent parts."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple


class GraphBranch(NamedTuple):
    """One outcome of a decision: literals that are settled, nodes that are independent, Booleans that are free."""

    literals: tuple[int, ...]
    children: tuple[int, ...]
    free: tuple[int, ...]


@dataclass(frozen=True, slots=True, eq=False)
class DecisionGraph:
    """Nodes are alternatives that exclude each other, children before parents (Darwiche 2001).

    A model of a node is one of one of its branches: the literals, a model of every child, anything for what is
    free. The children and the free Booleans of a branch have nothing in common, and all branches of a node speak
    about the same Booleans. *root* is a branch, or None if there is no model.
    """

    nodes: tuple[tuple[GraphBranch, ...], ...]
    root: GraphBranch | None
