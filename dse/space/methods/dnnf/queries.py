"""Questions to a compiled space that one or two passes over its nodes answer, exactly."""

from __future__ import annotations

from dse.space.methods.dnnf.cnf import NO_LITERAL, TRUE_LITERAL
from dse.space.methods.dnnf.compile import Dnnf
from dse.space.methods.dnnf.simplify import FALSE_LITERAL
from dse.space.methods.dnnf.weigh import Weighed, weigh


def count(dnnf: Dnnf) -> int:
    """How many rows there are."""
    return weigh(dnnf).total


def occurrences(dnnf: Dnnf) -> tuple[tuple[int, ...], ...]:
    """By variable of the space: in how many rows it takes each value; the last entry is absence.

    A pass from the root brings to each node the number of rows that reach it (Darwiche 2003, differentiation).
    """
    weighed = weigh(dnnf)
    total = weighed.total
    trimmed = dnnf.trimmed
    holding = _holding(weighed)
    found: list[tuple[int, ...]] = []
    place = {number: at for at, number in enumerate(trimmed.kept)}
    for number, variable in enumerate(trimmed.flat.variables):
        existing = total if variable.parent is None else found[variable.parent[0]][variable.parent[1]]
        below = weighed.ways.below[number]
        if number in place:
            groups = trimmed.classes[place[number]]
            sums = weighed.ways.classes[place[number]]
            amounts = _by_class(weighed, place[number], holding, existing)
            shares = [0] * len(below)
            for group, whole, amount in zip(groups, sums, amounts, strict=True):
                for value in group:
                    shares[value] = amount * below[value] // whole
        else:
            whole = sum(below)
            shares = [existing * part // whole for part in below]
        found.append((*shares, total - existing))
    return tuple(found)


def _holding(weighed: Weighed) -> list[int]:
    """In how many rows each literal of the graph holds."""
    holding = [0] * len(weighed.literals)
    graph = weighed.dnnf.graph
    if graph.root is None:
        return holding
    # Rows that reach a node, over the rows it stands for itself.
    reaching = [0] * len(graph.nodes)
    work = [(graph.root, weighed.root, weighed.outer)]
    for number in range(len(graph.nodes), -1, -1):
        if number < len(graph.nodes):
            times = reaching[number]
            if not times:
                continue
            work = [
                (branch, own, times) for branch, own in zip(graph.nodes[number], weighed.branches[number], strict=True)
            ]
        for branch, own, times in work:
            rows = own * times
            for literal in branch.literals:
                holding[literal] += rows
            for boolean in branch.free:
                yes, no = weighed.literals[2 * boolean], weighed.literals[2 * boolean + 1]
                each = rows // (yes + no)
                holding[2 * boolean] += each * yes
                holding[2 * boolean + 1] += each * no
            for child in branch.children:
                reaching[child] += rows // weighed.nodes[child]
    return holding


def _by_class(weighed: Weighed, at: int, holding: list[int], existing: int) -> list[int]:
    """In how many rows a core variable takes each of its values."""
    amounts: list[int] = []
    for literal in weighed.dnnf.cnf.values[at]:
        image = weighed.dnnf.image[literal] if literal != NO_LITERAL else FALSE_LITERAL
        amounts.append(weighed.total if image == TRUE_LITERAL else 0 if image == FALSE_LITERAL else holding[image])
    for value, literal in enumerate(weighed.dnnf.cnf.values[at]):
        if literal == NO_LITERAL:
            amounts[value] = existing - sum(amounts)
    return amounts
