"""The best rows under an objective: exact, complete, and the same ones every time.

Of rows of equal value those come first that the list has first.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from dse.space.flat import Ints, Linear
from dse.space.listing.bounds import cuts_of
from dse.space.listing.walk import Rounds
from dse.space.mdd.diagram import Diagram
from dse.space.optimum.optimizer import Optimizer, Ranking, sums
from dse.space.optimum.regions import Valued, best_valued

__all__ = ["Ranking", "Valued", "best", "best_valued", "sums"]


def best(
    diagram: Diagram,
    weights: Mapping[int, Ints],
    number: int,
    *,
    largest: bool = False,
    within: Sequence[Linear] = (),
    rounds: Rounds | None = None,
) -> Ranking:
    """The *number* valid rows of least (or largest) sum of weights[variable][value], or all if there are fewer.

    Weights are as in `Linear`. Only rows that meet the sums of *within*, too, count. Raises DseError if weights are
    too large for whole numbers of 64 bits, TooMuchError when *rounds* are spent.
    """
    sign = -1 if largest else 1
    beside = cuts_of(within)
    aim = {variable: sign * values for variable, values in weights.items()}
    optimizer = Optimizer(diagram, [aim, *(cut.weights for cut in beside)])
    found = optimizer.best([1, *[0] * len(beside)], number, [None, *(cut.high for cut in beside)], rounds)
    return Ranking(found.rows, tuple(sign * int(value) for value in found.values))
