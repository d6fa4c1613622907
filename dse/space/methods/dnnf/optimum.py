"""The rows of a wide space with the least sum of weights: an upward pass over its graph, least sums instead of counts.

Weights of values become weights of literals, as in `weigh`; a node keeps the few least sums of its models, and where
each came from (Kimmig, Van den Broeck and De Raedt, Algebraic model counting, 2017, for the tropical semiring).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from heapq import heappop, heappush

import numpy as np

from dse.space.flat import FlatSpace, Ints, Linear, Rows
from dse.space.methods.dnnf.cnf import NO_LITERAL, TRUE_LITERAL
from dse.space.methods.dnnf.compile import MOST_COMPONENTS, Dnnf, compile_dnnf
from dse.space.methods.dnnf.graph import GraphBranch
from dse.space.methods.dnnf.rows import rows_of_model
from dse.space.methods.dnnf.simplify import FALSE_LITERAL

LeastSums = list[tuple[int, tuple[int, ...]]]
"""Sums, ascending, and which branch and which ways of its children make each; of a Boolean, the literal."""


def least(flat: FlatSpace, weights: Mapping[int, Ints], number: int, most_nodes: int = MOST_COMPONENTS) -> Rows:
    """The *number* rows of least sum of weights[variable][value], or all if there are fewer; shape (rows, variables).

    Weights are as in `Linear`. Ascending by the sum; rows of equal sums in an order that is always the same. Raises
    UnsupportedError and TooWideError as `compile_dnnf` does.
    """
    # A sum without bounds forbids nothing, and keeps values of different weights apart.
    dnnf = compile_dnnf(flat.having(Linear(weights, None, None)), most_nodes)
    literals = _of_literals(dnnf, weights)
    ways, tops = _upward(dnnf, literals, number)
    found: list[Rows] = [np.zeros((0, len(flat.variables)), np.int16)]
    missing = number
    for rank in range(len(tops)):
        # Values that neither rules nor weights tell apart make several rows of one model.
        for block in rows_of_model(dnnf, _model(dnnf, literals, ways, tops, rank)):
            found.append(block[:missing])
            missing -= len(found[-1])
            if not missing:
                return np.concatenate(found)
    return np.concatenate(found)


def _of_literals(dnnf: Dnnf, weights: Mapping[int, Ints]) -> list[int]:
    """What each literal of the graph adds, up to a constant."""
    found = [0] * (2 * dnnf.booleans)

    def add(literal: int, amount: int) -> None:
        image = dnnf.image[literal]
        if image not in (TRUE_LITERAL, FALSE_LITERAL):
            found[image] += amount

    for original, groups, literals, exists in zip(
        dnnf.trimmed.kept, dnnf.trimmed.classes, dnnf.cnf.values, dnnf.cnf.exists, strict=True
    ):
        if original not in weights:
            continue
        for group, literal in zip(groups, literals, strict=True):
            amount = int(weights[original][group[0]])
            if literal != NO_LITERAL:
                add(literal, amount)
                continue
            # Left out is: it exists, and is not taken.
            add(exists, amount)
            for other in literals:
                if other != NO_LITERAL:
                    add(other, -amount)
    return found


def _upward(dnnf: Dnnf, literals: Sequence[int], number: int) -> tuple[list[LeastSums], LeastSums]:
    """The least ways of every node, and of the root."""
    ways: list[LeastSums] = []
    for node in dnnf.graph.nodes:
        every: LeastSums = []
        for place, branch in enumerate(node):
            every += [(value, (place, *ranks)) for value, ranks in _of_branch(branch, literals, ways, number)]
        # Sums alone are compared, and the sort is stable: the order does not depend on ranks.
        ways.append(sorted(every, key=lambda way: way[0])[:number])
    return ways, _of_branch(dnnf.graph.root, literals, ways, number) if dnnf.graph.root is not None else []


def _of_branch(branch: GraphBranch, literals: Sequence[int], ways: Sequence[LeastSums], number: int) -> LeastSums:
    found: LeastSums = [(sum(literals[literal] for literal in branch.literals), ())]
    for boolean in branch.free:
        found = _together(found, [value for value, _ in _of_boolean(boolean, literals)], number)
    for child in branch.children:
        found = _together(found, [value for value, _ in ways[child]], number)
    return found


def _of_boolean(boolean: int, literals: Sequence[int]) -> LeastSums:
    return sorted((literals[literal], (literal,)) for literal in (2 * boolean, 2 * boolean + 1))


def _together(found: LeastSums, values: Sequence[int], number: int) -> LeastSums:
    """The least sums of one of each, each with the rank of the second behind its ranks."""
    if number == 1 or len(found) == len(values) == 1:
        return [(found[0][0] + values[0], (*found[0][1], 0))]
    heap = [(found[0][0] + values[0], 0, 0)]
    least_ways: LeastSums = []
    while heap and len(least_ways) < number:
        value, one, other = heappop(heap)
        least_ways.append((value, (*found[one][1], other)))
        if other + 1 < len(values):
            heappush(heap, (found[one][0] + values[other + 1], one, other + 1))
        if not other and one + 1 < len(found):
            heappush(heap, (found[one + 1][0] + values[0], one + 1, 0))
    return least_ways


def _model(dnnf: Dnnf, literals: Sequence[int], ways: Sequence[LeastSums], tops: LeastSums, rank: int) -> Iterator[int]:
    """The literals that hold in the way of that rank."""
    assert dnnf.graph.root is not None  # noqa: S101  # there is a way, so there is a root
    pending = [(dnnf.graph.root, tops[rank][1])]
    while pending:
        branch, ranks = pending.pop()
        yield from branch.literals
        for boolean, place in zip(branch.free, ranks, strict=False):
            yield from _of_boolean(boolean, literals)[place][1]
        for child, place in [*zip(branch.children, ranks[len(branch.free) :], strict=True)][::-1]:
            taken, *below = ways[child][place][1]
            pending.append((dnnf.graph.nodes[child][taken], tuple(below)))
