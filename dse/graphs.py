"""Strong components of a graph, for every room that puts something in order, and groups of what shares something."""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Sequence


def components(needs: Sequence[Sequence[int]]) -> list[list[int]]:
    """Nodes that need each other, each component sorted; a component comes after all that it needs.

    *needs* lists for each node those it needs. Tarjan, SIAM J. Comput. 1(2), 1972, 146-160, without recursion.
    """
    index: dict[int, int] = {}
    low: dict[int, int] = {}
    is_open: set[int] = set()
    path: list[int] = []
    found: list[list[int]] = []
    for root in range(len(needs)):
        if root in index:
            continue
        work = [(root, 0)]
        while work:
            node, place = work.pop()
            if place == 0:
                index[node] = low[node] = len(index)
                path.append(node)
                is_open.add(node)
            else:
                low[node] = min(low[node], low[needs[node][place - 1]])
            while place < len(needs[node]):
                other = needs[node][place]
                place += 1
                if other not in index:
                    work.extend([(node, place), (other, 0)])
                    break
                if other in is_open:
                    low[node] = min(low[node], index[other])
            else:
                if low[node] == index[node]:
                    found.append(_closed(node, path, is_open))
    return found


def joined(parts: Sequence[Iterable[Hashable]]) -> list[list[int]]:
    """Numbers of *parts* that share an element, directly or by way of others: each group sorted, by its first."""
    first: dict[Hashable, int] = {}
    needs: list[list[int]] = [[] for _ in parts]
    for number, part in enumerate(parts):
        for element in part:
            other = first.setdefault(element, number)
            needs[number].append(other)
            needs[other].append(number)
    return components(needs)


def _closed(root: int, path: list[int], is_open: set[int]) -> list[int]:
    component: list[int] = []
    while not component or component[-1] != root:
        component.append(path.pop())
        is_open.discard(component[-1])
    return sorted(component)
