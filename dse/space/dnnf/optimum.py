"""The rows of a wide space with the least sum of weights: an upward pass over its graph, least sums instead of counts.

Weights of values become weights of literals, as in `weigh`; a node keeps the few least sums of its models, and where
each came from (Kimmig, Van den Broeck and De Raedt, Algebraic model counting, 2017, for the tropical semiring).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from heapq import heappop, heappush

import numpy as np

from dse.space.dnnf.cnf import NO_LITERAL, TRUE, encode
from dse.space.dnnf.compile import MOST_NODES, Dnnf
from dse.space.dnnf.exhaust import compile_graph
from dse.space.dnnf.graph import Branch
from dse.space.dnnf.order import arrange
from dse.space.dnnf.rows import rows
from dse.space.dnnf.simplify import FALSE, simplify
from dse.space.dnnf.trim import trim
from dse.space.flat import ABSENT, Bools, FlatSpace, Ints, Linear, Rows

Ways = list[tuple[int, tuple[int, ...]]]
"""Sums, ascending, and which branch and which ways of its children make each; of a Boolean, the literal."""


def least(flat: FlatSpace, weights: Mapping[int, Ints], number: int, most_nodes: int = MOST_NODES) -> Rows:
    """The *number* rows of least sum of weights[variable][value], or all if there are fewer; shape (rows, variables).

    Weights are as in `Linear`. Ascending by the sum; rows of equal sums in an order that is always the same. Raises
    UnsupportedError and TooWideError as `compile_dnnf` does.
    """
    dnnf = _compiled(flat, weights, most_nodes)
    literals = _of_literals(dnnf, weights)
    ways, tops = _upward(dnnf, literals, number)
    found: list[Rows] = [np.zeros((0, len(flat.variables)), np.int16)]
    missing = number
    for rank in range(len(tops)):
        # Values that neither rules nor weights tell apart make several rows of one model.
        for block in rows(dnnf, 0, _wanted(dnnf, _model(dnnf, literals, ways, tops, rank))):
            found.append(block[:missing])
            missing -= len(found[-1])
            if not missing:
                return np.concatenate(found)
    return np.concatenate(found)


def _compiled(flat: FlatSpace, weights: Mapping[int, Ints], most_nodes: int) -> Dnnf:
    """Like `compile_dnnf`, but values of different weights stay apart."""
    trimmed = trim(flat.having(Linear(weights, None, None)))
    cnf = encode(replace(trimmed.core, rules=trimmed.core.rules[:-1]))
    simplified = arrange(simplify(cnf))
    graph = compile_graph(simplified, most_nodes)
    return Dnnf(trimmed, cnf, simplified.image, simplified.booleans, graph)


def _of_literals(dnnf: Dnnf, weights: Mapping[int, Ints]) -> list[int]:
    """What each literal of the graph adds, up to a constant."""
    found = [0] * (2 * dnnf.booleans)

    def add(literal: int, amount: int) -> None:
        image = dnnf.image[literal]
        if image not in (TRUE, FALSE):
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


def _upward(dnnf: Dnnf, literals: Sequence[int], number: int) -> tuple[list[Ways], Ways]:
    """The least ways of every node, and of the root."""
    ways: list[Ways] = []
    for node in dnnf.graph.nodes:
        every: Ways = []
        for place, branch in enumerate(node):
            every += [(value, (place, *ranks)) for value, ranks in _of_branch(branch, literals, ways, number)]
        # Sums alone are compared, and the sort is stable: the order does not depend on ranks.
        ways.append(sorted(every, key=lambda way: way[0])[:number])
    return ways, _of_branch(dnnf.graph.root, literals, ways, number) if dnnf.graph.root is not None else []


def _of_branch(branch: Branch, literals: Sequence[int], ways: Sequence[Ways], number: int) -> Ways:
    found: Ways = [(sum(literals[literal] for literal in branch.literals), ())]
    for boolean in branch.free:
        found = _together(found, [value for value, _ in _of_boolean(boolean, literals)], number)
    for child in branch.children:
        found = _together(found, [value for value, _ in ways[child]], number)
    return found


def _of_boolean(boolean: int, literals: Sequence[int]) -> Ways:
    return sorted((literals[literal], (literal,)) for literal in (2 * boolean, 2 * boolean + 1))


def _together(found: Ways, values: Sequence[int], number: int) -> Ways:
    """The least sums of one of each, each with the rank of the second behind its ranks."""
    if number == 1 or len(found) == len(values) == 1:
        return [(found[0][0] + values[0], (*found[0][1], 0))]
    heap = [(found[0][0] + values[0], 0, 0)]
    least_ways: Ways = []
    while heap and len(least_ways) < number:
        value, one, other = heappop(heap)
        least_ways.append((value, (*found[one][1], other)))
        if other + 1 < len(values):
            heappush(heap, (found[one][0] + values[other + 1], one, other + 1))
        if not other and one + 1 < len(found):
            heappush(heap, (found[one + 1][0] + values[0], one + 1, 0))
    return least_ways


def _model(dnnf: Dnnf, literals: Sequence[int], ways: Sequence[Ways], tops: Ways, rank: int) -> Bools:
    """Which Booleans hold in the way of that rank."""
    holds = np.zeros(dnnf.booleans, np.bool_)
    holds[TRUE >> 1] = True
    assert dnnf.graph.root is not None  # noqa: S101  # there is a way, so there is a root
    pending = [(dnnf.graph.root, tops[rank][1])]
    while pending:
        branch, ranks = pending.pop()
        settled = [*branch.literals]
        for boolean, place in zip(branch.free, ranks, strict=False):
            settled += _of_boolean(boolean, literals)[place][1]
        for literal in settled:
            holds[literal >> 1] = not literal & 1
        for child, place in zip(branch.children, ranks[len(branch.free) :], strict=True):
            taken, *below = ways[child][place][1]
            pending.append((dnnf.graph.nodes[child][taken], tuple(below)))
    return holds


def _wanted(dnnf: Dnnf, holds: Bools) -> dict[int, Bools]:
    """What each kept variable takes in a model, as masks over all its values."""
    wanted = {}
    for original, groups, literals, exists in zip(
        dnnf.trimmed.kept, dnnf.trimmed.classes, dnnf.cnf.values, dnnf.cnf.exists, strict=True
    ):
        mask = np.zeros(len(dnnf.flat.variables[original].values) + 1, np.bool_)
        taken = [group for group, literal in zip(groups, literals, strict=True) if _holds(dnnf, holds, literal)]
        left_out = [group for group, literal in zip(groups, literals, strict=True) if literal == NO_LITERAL]
        if not _holds(dnnf, holds, exists):
            mask[ABSENT] = True
        else:
            mask[list((taken or left_out)[0])] = True
        wanted[original] = mask
    return wanted


def _holds(dnnf: Dnnf, holds: Bools, literal: int) -> bool:
    if literal == NO_LITERAL:
        return False
    image = dnnf.image[literal]
    return bool(holds[image >> 1]) != bool(image & 1)
