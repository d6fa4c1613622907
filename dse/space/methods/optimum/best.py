"""The best rows under an objective: exact, complete, and the same ones every time.

Of rows of equal value those come first that the list has first.
"""

from __future__ import annotations

from collections.abc import Mapping

from dse.space.flat import Ints
from dse.space.methods.mdd.diagram import Diagram
from dse.space.methods.optimum.optimizer import Optimizer, Ranking, sums
from dse.space.methods.optimum.regions import Valued, best_valued

__all__ = ["Ranking", "Valued", "best", "best_valued", "sums"]


def best(diagram: Diagram, weights: Mapping[int, Ints], number: int, *, largest: bool = False) -> Ranking:
    """The *number* valid rows of least (or largest) sum of weights[variable][value], or all if there are fewer.

    Weights are as in `Linear`. Raises DseError if they are too large for whole numbers of 64 bits.
    """
    sign = -1 if largest else 1
    aim = {variable: sign * values for variable, values in weights.items()}
    found = Optimizer(diagram, [aim]).best([1], number)
    return Ranking(found.rows, tuple(sign * int(value) for value in found.values))
