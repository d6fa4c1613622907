"""Orders of the decisions in which a diagram may be narrower than in the order of the file.

Rules are the edges of a hypergraph over the variables. What a diagram must remember at a layer are the edges cut
there, so orders are sought in which few edges are open at a time, by closing edges greedily from one end (as in the
bandwidth reduction of Cuthill and McKee 1969). Parents always come before their children.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dse.space.flat import FlatSpace
from dse.space.methods.mdd.diagram import MOST_DIAGRAM_NODES, DecisionDiagram, compile_diagram
from dse.space.methods.mdd.growth import TooWideError

_CANDIDATES = 24
"""Variables looked at for each place of a greedy order."""


def compile_best(flat: FlatSpace, most_nodes: int = MOST_DIAGRAM_NODES) -> DecisionDiagram:
    """The diagram in the order of the file if it fits, else in the first proposed order in which it does.

    TooWideError if there is none.
    """
    file_order = tuple(range(len(flat.variables)))
    for order in (file_order, *(order for order in proposed(flat) if order != file_order)):
        try:
            return compile_diagram(flat, order, most_nodes)
        except TooWideError:
            continue
    raise TooWideError


def proposed(flat: FlatSpace) -> list[tuple[int, ...]]:
    """Orders worth trying, the one with the fewest bits to remember first."""
    edges = _edges(flat)
    if not edges:
        return [tuple(range(len(flat.variables)))]
    found = dict.fromkeys(_greedy(flat, edges, first) for first in _far_ends(flat, edges))
    return sorted(found, key=lambda order: _width(flat, edges, order))


def _edges(flat: FlatSpace) -> list[tuple[int, ...]]:
    """The variables of every rule that has two or more; each parent with its children is one."""
    scopes = [table.scope for table in flat.tables()]
    scopes += [tuple(number for number, _ in clause.literals) for clause in flat.clauses()]
    families: dict[int, list[int]] = {}
    for number, variable in enumerate(flat.variables):
        if variable.parent is not None:
            families.setdefault(variable.parent[0], [variable.parent[0]]).append(number)
    return list(dict.fromkeys(scope for scope in (*scopes, *map(tuple, families.values())) if len(scope) > 1))


def _far_ends(flat: FlatSpace, edges: Sequence[tuple[int, ...]]) -> list[int]:
    """Two root variables to start from: the first that has rules, and one as far from it as edges go."""
    touching = _touching(len(flat.variables), edges)
    roots = [n for n, variable in enumerate(flat.variables) if variable.parent is None and touching[n]]
    distance = {roots[0]: 0}
    queue = [roots[0]]
    seen_edges: set[int] = set()
    for number in queue:
        for edge in touching[number]:
            if edge in seen_edges:
                continue
            seen_edges.add(edge)
            for other in edges[edge]:
                if other not in distance:
                    distance[other] = distance[number] + 1
                    queue.append(other)
    is_root = set(roots)
    far = next(number for number in reversed(queue) if number in is_root)
    return list(dict.fromkeys((roots[0], far)))


def _greedy(flat: FlatSpace, edges: Sequence[tuple[int, ...]], first: int) -> tuple[int, ...]:
    """Next comes, of the variables on the open edges that wait longest, the one that opens fewest and closes most."""
    touching = _touching(len(flat.variables), edges)
    left = [len(edge) for edge in edges]
    opened: dict[int, None] = {}
    placed = [False] * len(flat.variables)
    order: list[int] = []
    unplaced = iter(range(len(flat.variables)))

    def cost(number: int) -> int:
        opens = sum(left[edge] == len(edges[edge]) for edge in touching[number])
        return opens - sum(left[edge] == 1 for edge in touching[number])

    def place(number: int) -> None:
        chain = [number]
        while (parent := flat.variables[chain[-1]].parent) is not None and not placed[parent[0]]:
            chain.append(parent[0])
        for member in reversed(chain):
            placed[member] = True
            order.append(member)
            for edge in touching[member]:
                left[edge] -= 1
                opened[edge] = None
                if not left[edge]:
                    del opened[edge]

    place(first)
    while len(order) < len(placed):
        candidates: dict[int, None] = {}
        for edge in opened:
            candidates.update((number, None) for number in edges[edge] if not placed[number])
            if len(candidates) >= _CANDIDATES:
                break
        if candidates:
            place(min(candidates, key=cost))
        else:
            place(next(number for number in unplaced if not placed[number]))
    return tuple(order)


def _touching(variables: int, edges: Sequence[tuple[int, ...]]) -> list[list[int]]:
    touching: list[list[int]] = [[] for _ in range(variables)]
    for number, edge in enumerate(edges):
        for variable in edge:
            touching[variable].append(number)
    return touching


def _width(flat: FlatSpace, edges: Sequence[tuple[int, ...]], order: tuple[int, ...]) -> float:
    """The most bits of variables that open edges still need, over all layers."""
    places = np.empty(len(order), np.int64)
    places[list(order)] = np.arange(len(order))
    until = places.copy()
    for edge in edges:
        of_edge = places[list(edge)]
        until[list(edge)] = np.maximum(until[list(edge)], of_edge.max())
    bits = np.log2([len(variable.values) + 1 for variable in flat.variables])
    change = np.zeros(len(order) + 1)
    np.add.at(change, places, bits)
    np.add.at(change, until, -bits)
    return float(np.cumsum(change).max())
