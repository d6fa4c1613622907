"""The exact number of rows that meet all rules, sums included: grids of partial sums on the nodes of a diagram.

Ways to each partial sum are carried from the root and from the terminal to a level between, where the halves meet
(Horowitz and Sahni 1974, for a sum; here for several, on every node). All arithmetic is exact.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from dse.space.grid.meeting import pairs
from dse.space.grid.nodes import Node
from dse.space.grid.split import Counting, Split, caps, counting, execute, split
from dse.space.grid.words import moduli, running_sums
from dse.space.mdd.diagram import Diagram, count

MOST_MEMORY = 4e9
"""Bytes."""

MOST_WORK = 5e10
"""Additions of a cell; some twenty seconds."""


def exact_count(diagram: Diagram, most_memory: float = MOST_MEMORY, most_work: float = MOST_WORK) -> int:
    """How many rows of *diagram* meet the Linear rules as well.

    TooMuchError, before anything is spent, if that is estimated to take more bytes or additions, or if there are
    Wide rules that the layers do not contain.
    """
    problem = counting(diagram)
    if not isinstance(problem, Counting):
        return count(problem)
    found = split(problem, most_memory, most_work)
    try:
        return _counted(problem, found, caps(problem, found), None)
    except OverflowError:
        total, product = 0, 1
        for modulus in moduli(count(problem.diagram)):
            remainder = _counted(problem, found, ((), ()), modulus)
            total += product * ((remainder - total) * pow(product, -1, modulus) % modulus)
            product *= modulus
        return total


def _counted(
    problem: Counting, found: Split, known: Sequence[Sequence[Mapping[Node, int]]], modulus: int | None
) -> int:
    """The count, or what has the same remainder. OverflowError if a number may have more than 64 bits."""
    before, after = (
        execute(sweep, chosen, bounds, modulus).grids
        for sweep, chosen, bounds in zip(found.sweeps, found.executions, known, strict=True)
    )
    own, other, paths = problem.ahead(found.cut), problem.behind(found.cut), found.sweeps[1].paths[-1]
    total = 0
    for node in before.keys() & after.keys():
        ways = after[node].ways
        # Of a great number of paths few may be within the bounds; the sum in doubles is a little off.
        bound = min(int(paths[node]), int(1.01 * float(ways.sum(dtype=np.float64))) + 1)
        ways = running_sums(ways.reshape(other.shape), bound, modulus)
        total += pairs(problem.sums, before[node].ways, own, ways, other)
    return total
