"""Counting on a compiled space: every node gets the number of rows it stands for."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from dse.space.dnnf.cnf import NO_LITERAL, TRUE
from dse.space.dnnf.compile import MOST_NODES, Dnnf, compile_dnnf
from dse.space.dnnf.graph import Branch
from dse.space.dnnf.simplify import FALSE
from dse.space.dnnf.trim import Ways, ways_of
from dse.space.flat import ABSENT, Bools, FlatSpace, single


@dataclass(frozen=True, slots=True, eq=False)
class Weighed:
    """A compiled space with numbers of rows: of everything, of each node's branches, and of each node.

    *literals*[l] is in how many ways what was cut off can be filled in where literal l holds.
    """

    dnnf: Dnnf
    ways: Ways
    literals: tuple[int, ...]
    outer: int
    branches: tuple[tuple[int, ...], ...]
    nodes: tuple[int, ...]
    root: int

    @property
    def total(self) -> int:
        """All rows."""
        return self.outer * self.root


def weigh(dnnf: Dnnf, wanted: Mapping[int, Bools] | None = None, most_nodes: int = MOST_NODES) -> Weighed:
    """The rows whose variables take only what is *wanted*, masks of shape (values + 1,) by variable; by default all.

    A part that may be absent but not left out cannot be said in weights; then the space is compiled again with that
    rule, which may raise TooWideError.
    """
    masks = _spread(dnnf.flat, wanted or {})
    if masks is None:
        return _weighed(dnnf, ways_of(dnnf.trimmed, {}), [0] * (2 * dnnf.booleans), 0)
    ways = ways_of(dnnf.trimmed, masks)
    weights = [1] * (2 * dnnf.booleans)
    outer = ways.apart
    for number, (literals, amounts) in enumerate(zip(dnnf.cnf.values, ways.classes, strict=True)):
        for literal, amount in zip(literals, amounts, strict=True):
            if literal == NO_LITERAL:
                if amount == 1:
                    continue
                # Left out is not wanted: the part must stand, which is one literal if there is always a place for it.
                original = dnnf.trimmed.kept[number]
                exists = dnnf.image[dnnf.cnf.exists[number]] == TRUE or not masks[original][ABSENT]
                if not exists:
                    rules = (single(each, mask) for each, mask in masks.items())
                    return weigh(compile_dnnf(dnnf.flat.having(*rules), most_nodes))
                image = dnnf.image[next(other for other in literals if other != NO_LITERAL)] ^ 1
            else:
                image = dnnf.image[literal]
            if image == TRUE:
                outer *= amount
            elif image != FALSE:
                weights[image] *= amount
    return _weighed(dnnf, ways, weights, outer)


def _weighed(dnnf: Dnnf, ways: Ways, weights: list[int], outer: int) -> Weighed:
    nodes: list[int] = []
    branches: list[tuple[int, ...]] = []
    for node in dnnf.graph.nodes:
        amounts = tuple(_amount(branch, weights, nodes) for branch in node)
        branches.append(amounts)
        nodes.append(sum(amounts))
    root = _amount(dnnf.graph.root, weights, nodes) if dnnf.graph.root is not None else 0
    return Weighed(dnnf, ways, tuple(weights), outer, tuple(branches), tuple(nodes), root)


def _amount(branch: Branch, weights: list[int], nodes: list[int]) -> int:
    amount = 1
    for literal in branch.literals:
        if weights[literal] != 1:
            amount *= weights[literal]
    for boolean in branch.free:
        amount *= weights[2 * boolean] + weights[2 * boolean + 1]
    for child in branch.children:
        amount *= nodes[child]
    return amount


def _spread(flat: FlatSpace, wanted: Mapping[int, Bools]) -> dict[int, Bools] | None:
    """The masks with what they say about the parents said there too; None if a root cannot take any value."""
    masks = {number: mask.copy() for number, mask in wanted.items()}
    for number in range(len(flat.variables) - 1, -1, -1):
        mask = masks.get(number)
        if mask is None:
            continue
        parent = flat.variables[number].parent
        if parent is None:
            if not mask[:ABSENT].any():
                return None
            continue
        above, value = parent
        size = len(flat.variables[above].values) + 1
        says = np.ones(size, bool)
        if not mask[ABSENT]:
            says = np.arange(size) == value
        if not mask[:ABSENT].any():
            says[value] = False
        if not says.all():
            masks[above] = masks.get(above, np.ones(size, bool)) & says
    return masks
