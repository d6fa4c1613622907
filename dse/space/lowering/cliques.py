"""Places that are all different, recognised in rules that compare each pair of them.

Twelve places that differ pair by pair are 66 tables, and the diagram of their conjunction is built over all orders in
which they narrow each other: it does not fit. That of twelve sums, at most one place for each name, has 2^12 states a
layer. So cells ``p is x and q is x`` that tables forbid are the edges of a graph over what can be chosen; where many
choices are all joined to each other, a sum says the same as their tables. What excludes each other need not be called
the same.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from dse.space.flat import FlatSpace, Linear, Table

FEWEST_PLACES = 6
"""Fewer are left to their tables, which the diagram takes as they are."""

Literal = tuple[int, int]
"""A variable and the number of one of its values."""

_Graph = dict[Literal, set[Literal]]


def with_cliques(flat: FlatSpace) -> FlatSpace:
    """*flat* with sums in place of the tables that say no more than that places are all different."""
    cells = {number: found for number, rule in enumerate(flat.rules) if (found := _pairs(flat, rule))}
    graphs = _graphs(flat, [pair for pairs in cells.values() for pair in pairs])
    covered: set[tuple[Literal, Literal]] = set()
    sums: list[Linear] = []
    for graph in graphs:
        for clique in _cliques(graph):
            covered |= {(a, b) for a in clique for b in clique}
            sums.append(_at_most_one(flat, clique))
    gone = {number for number, pairs in cells.items() if covered.issuperset(pairs)}
    if not gone:
        return flat
    rest = tuple(rule for number, rule in enumerate(flat.rules) if number not in gone)
    return replace(flat, rules=(*rest, *sums))


def _pairs(flat: FlatSpace, rule: object) -> list[tuple[Literal, Literal]]:
    """The values that a table forbids two variables to take together, if each is in one such pair at most."""
    if not isinstance(rule, Table) or len(rule.scope) != 2:
        return []
    left, right = (flat.variables[variable] for variable in rule.scope)
    # A variable without a parent always exists, whatever the table says of its absence.
    cells = ~rule.allowed[: -1 if left.parent is None else None, : -1 if right.parent is None else None]
    if (cells.sum(0) > 1).any() or (cells.sum(1) > 1).any():
        return []
    found = np.argwhere(cells).tolist()
    if any(a == len(left.values) or b == len(right.values) for a, b in found):
        return []
    return [((rule.scope[0], a), (rule.scope[1], b)) for a, b in found]


def _graphs(flat: FlatSpace, pairs: Sequence[tuple[Literal, Literal]]) -> Iterator[_Graph]:
    """The pairs as graphs: of values that are joined, or of those of one name where a variable had two in a graph."""
    joined: dict[Literal, set[Literal]] = {}
    for a, b in pairs:
        joined.setdefault(a, set()).add(b)
        joined.setdefault(b, set()).add(a)
    waiting = set(joined)
    for start in joined:
        if start not in waiting:
            continue
        waiting.remove(start)
        reached = [start]
        for one in reached:
            new = joined[one] & waiting
            waiting -= new
            reached += sorted(new)
        if len({variable for variable, _ in reached}) == len(reached):
            yield {one: joined[one] for one in reached}
            continue
        names: dict[str | None, set[Literal]] = {}
        for variable, value in reached:
            names.setdefault(flat.variables[variable].values[value], set()).add((variable, value))
        yield from ({one: joined[one] & same for one in sorted(same)} for same in names.values())


def _cliques(graph: _Graph) -> Iterator[list[Literal]]:
    """Disjoint sets of vertices that are all joined to each other, the largest degrees first."""
    left = sorted(graph, key=lambda vertex: (-len(graph[vertex]), vertex))
    while left:
        clique: list[Literal] = []
        for vertex in left:
            if all(vertex in graph[other] for other in clique):
                clique.append(vertex)
        left = [vertex for vertex in left if vertex not in clique]
        if len(clique) >= FEWEST_PLACES:
            yield clique


def _at_most_one(flat: FlatSpace, literals: Sequence[Literal]) -> Linear:
    weights = {}
    for variable, value in sorted(literals):
        weights[variable] = np.zeros(len(flat.variables[variable].values) + 1, np.int64)
        weights[variable][value] = 1
    return Linear(weights, None, 1)
