"""The exact number of rows that meet all rules, sums included: grids of partial sums on the nodes of a diagram.

Ways to each partial sum are carried from the root and from the terminal to a level between, where the halves meet
(Horowitz and Sahni 1974, for a sum; here for several, on every node). All arithmetic is exact.

Example: x in {1, 2, 4}, y in {0, 3}, x + y <= 4, and the halves meet between x and y.

    sum                        0 1 2 3 4
    ways of x to it            0 1 1 0 1
    ways of y to no more       1 1 1 2 2
    x = 1 leaves 3 for y: 2 ways; x = 2 leaves 2: 1 way; x = 4 leaves 0: 1 way. Together 4 rows.

Cost: edges of the diagram times cells of a grid, which is the product of the spans of the sums. That is known before
anything is spent, and beyond *most_work* it is refused. Three sums over 54 decisions took 9 s and 1.1 GB; properties
a hundred times finer are out of reach (docs/decisions/0007-design-space-engine.md).
"""

from __future__ import annotations

from dse.space.methods.grid.halves import pairs, summed
from dse.space.methods.grid.split import Counting, caps, counting, execute, split
from dse.space.methods.mdd.diagram import DecisionDiagram, count

MOST_MEMORY = 4e9
"""Bytes."""

MOST_GRID_WORK = 5e10
"""Additions of a cell; some twenty seconds."""


def exact_count(diagram: DecisionDiagram, most_memory: float = MOST_MEMORY, most_work: float = MOST_GRID_WORK) -> int:
    """How many rows of *diagram* meet the Linear rules as well.

    TooMuchError, before anything is spent, if that is estimated to take more bytes or additions, or if there are
    Wide rules that the layers do not contain.
    """
    problem = counting(diagram)
    if not isinstance(problem, Counting):
        return count(problem)
    found = split(problem, most_memory, most_work)
    before, after = (
        execute(sweep, chosen, known).grids
        for sweep, chosen, known in zip(found.sweeps, found.executions, caps(problem, found), strict=True)
    )
    own, other, paths = problem.ahead(found.cut), problem.behind(found.cut), found.sweeps[1].paths[-1]
    total = 0
    for node in before.keys() & after.keys():
        ways = summed(after[node].digits, other, int(paths[node]))
        total += pairs(problem.sums, before[node].digits, own, ways, other)
    return total
