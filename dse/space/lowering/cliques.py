"""Places that are all different, recognised in rules that compare each pair of them.

Twelve places that differ pair by pair are 66 tables, and the diagram of their conjunction is built over all orders in
which they narrow each other: it does not fit. That of twelve sums, at most one place for each name, has 2^12 states a
layer. So cells ``p is x and q is x`` that tables forbid are the edges of a graph over the places for each name; where
many places are all joined to each other, a sum says the same as their tables.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from dse.space.flat import FlatSpace, Linear, Table

FEWEST_PLACES = 6
"""Fewer are left to their tables, which the diagram takes as they are."""

_Graph = dict[int, set[int]]


def with_cliques(flat: FlatSpace) -> FlatSpace:
    """*flat* with sums in place of the tables that say no more than that places are all different."""
    cells = {number: found for number, rule in enumerate(flat.rules) if (found := _same_names(flat, rule))}
    graphs: dict[str, _Graph] = {}
    for pairs in cells.values():
        for name, (left, right) in pairs.items():
            graph = graphs.setdefault(name, {})
            graph.setdefault(left, set()).add(right)
            graph.setdefault(right, set()).add(left)
    covered: set[tuple[str, int, int]] = set()
    sums: list[Linear] = []
    for name, graph in graphs.items():
        for clique in _cliques(graph):
            covered |= {(name, a, b) for a in clique for b in clique}
            sums.append(_at_most_one(flat, name, clique))
    gone = {number for number, pairs in cells.items() if all((name, a, b) in covered for name, (a, b) in pairs.items())}
    if not gone:
        return flat
    rest = tuple(rule for number, rule in enumerate(flat.rules) if number not in gone)
    return replace(flat, rules=(*rest, *sums))


def _same_names(flat: FlatSpace, rule: object) -> Mapping[str, tuple[int, int]]:
    """The names that a table forbids two variables to share, if it forbids nothing else."""
    if not isinstance(rule, Table) or len(rule.scope) != 2:
        return {}
    left, right = (flat.variables[variable] for variable in rule.scope)
    found: dict[str, tuple[int, int]] = {}
    # A variable without a parent always exists, whatever the table says of its absence.
    cells = ~rule.allowed[: -1 if left.parent is None else None, : -1 if right.parent is None else None]
    for a, b in np.argwhere(cells).tolist():
        name = left.values[a] if a < len(left.values) else None
        if name is None or b >= len(right.values) or right.values[b] != name:
            return {}
        found[name] = rule.scope[0], rule.scope[1]
    return found


def _cliques(graph: _Graph) -> Iterator[list[int]]:
    """Disjoint sets of vertices that are all joined to each other, the largest degrees first."""
    left = sorted(graph, key=lambda vertex: (-len(graph[vertex]), vertex))
    while left:
        clique: list[int] = []
        for vertex in left:
            if all(vertex in graph[other] for other in clique):
                clique.append(vertex)
        left = [vertex for vertex in left if vertex not in clique]
        if len(clique) >= FEWEST_PLACES:
            yield clique


def _at_most_one(flat: FlatSpace, name: str, places: list[int]) -> Linear:
    weights = {}
    for variable in sorted(places):
        values = flat.variables[variable].values
        weights[variable] = np.array([*(value == name for value in values), False], np.int64)
    return Linear(weights, None, 1)
