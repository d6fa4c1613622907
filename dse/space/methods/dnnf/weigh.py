"""Counting on a compiled space: every node gets the number of rows it stands for."""

from __future__ import annotations

from dataclasses import dataclass

from dse.space.methods.dnnf.cnf import NO_LITERAL, TRUE_LITERAL
from dse.space.methods.dnnf.compile import Dnnf
from dse.space.methods.dnnf.graph import GraphBranch
from dse.space.methods.dnnf.simplify import FALSE_LITERAL
from dse.space.methods.dnnf.trim import ValueWays, ways_of


@dataclass(frozen=True, slots=True, eq=False)
class Weighed:
    """A compiled space with numbers of rows: of everything, of each node's branches, and of each node.

    *literals*[l] is in how many ways what was cut off can be filled in where literal l holds.
    """

    dnnf: Dnnf
    ways: ValueWays
    literals: tuple[int, ...]
    outer: int
    branches: tuple[tuple[int, ...], ...]
    nodes: tuple[int, ...]
    root: int

    @property
    def total(self) -> int:
        """All rows."""
        return self.outer * self.root


def weigh(dnnf: Dnnf) -> Weighed:
    """The rows of a compiled space, counted upwards from the leaves of its graph."""
    ways = ways_of(dnnf.trimmed)
    weights = [1] * (2 * dnnf.booleans)
    outer = ways.apart
    for literals, amounts in zip(dnnf.cnf.values, ways.classes, strict=True):
        for literal, amount in zip(literals, amounts, strict=True):
            # A part is left out in one way.
            image = FALSE_LITERAL if literal == NO_LITERAL else dnnf.image[literal]
            if image == TRUE_LITERAL:
                outer *= amount
            elif image != FALSE_LITERAL:
                weights[image] *= amount
    nodes: list[int] = []
    branches: list[tuple[int, ...]] = []
    for node in dnnf.graph.nodes:
        amounts = tuple(_amount(branch, weights, nodes) for branch in node)
        branches.append(amounts)
        nodes.append(sum(amounts))
    root = _amount(dnnf.graph.root, weights, nodes) if dnnf.graph.root is not None else 0
    return Weighed(dnnf, ways, tuple(weights), outer, tuple(branches), tuple(nodes), root)


def _amount(branch: GraphBranch, weights: list[int], nodes: list[int]) -> int:
    amount = 1
    for literal in branch.literals:
        if weights[literal] != 1:
            amount *= weights[literal]
    for boolean in branch.free:
        amount *= weights[2 * boolean] + weights[2 * boolean + 1]
    for child in branch.children:
        amount *= nodes[child]
    return amount
