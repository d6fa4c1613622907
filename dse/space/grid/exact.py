"""The exact number of rows that meet all rules, sums included: grids of partial sums on the nodes of a diagram.

Ways to each partial sum are carried from the root and from the terminal to a level between, where the halves meet
(Horowitz and Sahni 1974, for a sum; here for several, on every node). All arithmetic is exact.
"""

from __future__ import annotations

from dse.space.budget import Cost, TooMuchError
from dse.space.grid.meeting import pairs, summed
from dse.space.grid.plan import Task, caps, execute, plan, task
from dse.space.mdd.diagram import Diagram, count

__all__ = ["MOST_MEMORY", "MOST_WORK", "Cost", "TooMuchError", "cost", "exact_count"]

MOST_MEMORY = 4e9
"""Bytes."""

MOST_WORK = 5e10
"""Additions of a cell; some twenty seconds."""


def exact_count(diagram: Diagram, most_memory: float = MOST_MEMORY, most_work: float = MOST_WORK) -> int:
    """How many rows of *diagram* meet the Linear rules as well.

    TooMuchError, before anything is spent, if that is estimated to take more bytes or additions, or if there are
    Wide rules that the layers do not contain.
    """
    to_count = task(diagram)
    if not isinstance(to_count, Task):
        return count(to_count)
    found = plan(to_count, most_memory, most_work)
    before, after = (
        execute(sweep, way, known).grids
        for sweep, way, known in zip(found.sweeps, found.ways, caps(to_count, found), strict=True)
    )
    own, other, paths = to_count.ahead(found.cut), to_count.behind(found.cut), found.sweeps[1].paths[-1]
    unmoved = (0,) * len(to_count.sums)
    total = 0
    for node in before.keys() & after.keys():
        ways = summed(after[node].limbs, other, int(paths[node]))
        total += pairs(to_count.sums, before[node].limbs, own, ways, other, unmoved)
    return total


def cost(diagram: Diagram) -> Cost:
    """What `exact_count` would take at least work; TooMuchError if it cannot count this at all."""
    to_count = task(diagram)
    if not isinstance(to_count, Task):
        return Cost(0, 0)
    return plan(to_count, float("inf"), float("inf")).cost
