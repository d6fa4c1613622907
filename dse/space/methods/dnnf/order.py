"""In what order to decide: what holds a set of clauses together comes first."""

from __future__ import annotations

import heapq
from collections.abc import Iterable, Sequence
from dataclasses import replace

from dse.space.methods.dnnf.simplify import Simplified
from dse.space.methods.mdd.growth import TooWideError

_MOST_PAIRS = 5_000_000
"""Pairs of Booleans in all bags together, half a second of work; models of 1,000 features have 100,000."""


def arrange(simplified: Simplified) -> Simplified:
    """The same clauses with Booleans numbered in the order in which to decide them.

    TooWideError if they are joined so closely that deciding some leaves the others together.
    """
    number = [0] * simplified.booleans
    for at, boolean in enumerate(decision_order(simplified.booleans, simplified.clauses)):
        number[boolean] = at + 1
    return replace(
        simplified,
        clauses=tuple(tuple(2 * number[each >> 1] | (each & 1) for each in clause) for clause in simplified.clauses),
        image=tuple(2 * number[literal >> 1] | (literal & 1) for literal in simplified.image),
    )


def decision_order(booleans: int, clauses: Iterable[Sequence[int]]) -> list[int]:
    """The Booleans 1 to *booleans* - 1; deciding them from the front makes the rest fall apart early and evenly.

    A tree decomposition by minimum-degree elimination (Markowitz 1957), cut at its centroids again and again: the
    bags of the cuts are decided first. As in counters that follow a decomposition (Korhonen and Järvisalo 2021),
    the result bounds the depth of decisions by treewidth times the logarithm of the size.
    """
    neighbours: list[set[int]] = [set() for _ in range(booleans)]
    clause_count = [0] * booleans
    for clause in clauses:
        members = [literal >> 1 for literal in clause]
        for boolean in members:
            neighbours[boolean].update(members)
            clause_count[boolean] += 1
    for boolean, beside in enumerate(neighbours):
        beside.discard(boolean)
    bags, eliminated = _eliminate(neighbours)
    depth = _centroid_depths(bags, eliminated)
    return sorted(range(1, booleans), key=lambda boolean: (depth[boolean], -clause_count[boolean], boolean))


def _eliminate(neighbours: list[set[int]]) -> tuple[list[set[int]], list[int]]:
    """Bags (without the Boolean eliminated) and the order of elimination; empties *neighbours*."""
    heap = [(len(beside), boolean) for boolean, beside in enumerate(neighbours) if boolean]
    heapq.heapify(heap)
    bags: list[set[int]] = [set() for _ in neighbours]
    done = [False] * len(neighbours)
    order: list[int] = []
    pairs = 0
    while heap:
        degree, boolean = heapq.heappop(heap)
        beside = neighbours[boolean]
        if done[boolean] or degree != len(beside):
            continue
        pairs += degree * degree
        if pairs > _MOST_PAIRS:
            raise TooWideError
        done[boolean] = True
        order.append(boolean)
        bags[boolean] = beside
        for other in beside:
            around = neighbours[other]
            around |= beside
            around.discard(other)
            around.discard(boolean)
            heapq.heappush(heap, (len(around), other))
    return bags, order


def _centroid_depths(bags: list[set[int]], order: list[int]) -> list[int]:
    """At which level of cutting each Boolean is decided; 0 is the first."""
    place = {boolean: at for at, boolean in enumerate(order)}
    links: list[list[int]] = [[] for _ in bags]
    roots: list[int] = []
    for boolean in order:
        if bags[boolean]:
            above = min(bags[boolean], key=place.__getitem__)
            links[boolean].append(above)
            links[above].append(boolean)
        else:
            roots.append(boolean)
    unset = len(bags)
    depth = [unset] * len(bags)
    cut = [False] * len(bags)
    pending = [(root, 0) for root in roots]
    while pending:
        root, level = pending.pop()
        centroid = _centroid(root, links, cut)
        cut[centroid] = True
        for boolean in (centroid, *bags[centroid]):
            depth[boolean] = min(depth[boolean], level)
        pending.extend((other, level + 1) for other in links[centroid] if not cut[other])
    return depth


def _centroid(root: int, links: Sequence[Sequence[int]], cut: Sequence[bool]) -> int:
    """The node whose removal leaves no part larger than half."""
    above = {root: 0}
    nodes = [root]
    for node in nodes:
        for other in links[node]:
            if not cut[other] and other != above[node]:
                above[other] = node
                nodes.append(other)
    size = dict.fromkeys(nodes, 1)
    for node in reversed(nodes[1:]):
        size[above[node]] += size[node]
    centroid = root
    while True:
        heavy = [n for n in links[centroid] if above.get(n) == centroid and not cut[n] and 2 * size[n] > len(nodes)]
        if not heavy:
            return centroid
        centroid = heavy[0]
