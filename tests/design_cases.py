"""Cases of the rule by which runs make a design feasible or not: for the exploration and for the report's page."""

from __future__ import annotations

import math
from typing import NamedTuple

AT_MOST = 2.0
"""The bound of the one requirement, on the metric that is also the objective, to be small."""

NAN = math.nan


class Run(NamedTuple):
    """One of a design, at a condition, with a draw of what is uncertain."""

    condition: float
    draw: float
    value: float
    exercised: bool = True
    done: bool = True


class DesignCase(NamedTuple):
    """A design and what must follow from its *runs*: *objective* is the largest mean of any condition."""

    runs: tuple[Run, ...]
    verdict: str
    margin: float
    objective: float


def _two(first: float, second: float, *, exercised: tuple[bool, bool] = (True, True), done: bool = True):
    """A run at each of two conditions; of the second one says whether it was *done*."""
    return Run(0, 5, first, exercised[0]), Run(1, 5, second, exercised[1], done)


DESIGN_CASES = (
    DesignCase(_two(1.0, 1.5), "pass", 0.5, 1.5),
    DesignCase(_two(2.0, 0.0), "pass", 0.0, 2.0),
    DesignCase(_two(1.0, 5.0, exercised=(True, False)), "pass", 1.0, 5.0),
    DesignCase(_two(1.0, 1.0, exercised=(False, False)), "not exercised", NAN, 1.0),
    DesignCase(_two(1.0, 3.0), "fail", -1.0, 3.0),
    DesignCase(_two(4.0, 3.0, exercised=(False, True)), "fail", -1.0, 4.0),
    DesignCase(_two(1.0, NAN), "fail", NAN, NAN),
    DesignCase(_two(1.0, NAN, done=False), "failed to run", 1.0, NAN),
    DesignCase(_two(3.0, NAN, done=False), "failed to run", -1.0, NAN),
    DesignCase((Run(0, 4, 1.0), Run(0, 6, 1.75), Run(1, 4, 0.5), Run(1, 6, 1.5)), "pass", 0.25, 1.375),
    DesignCase((Run(0, 4, 0.5), Run(1, 4, 1.0), Run(0, 6, 0.5), Run(1, 6, 2.5)), "fail", -0.5, 1.75),
)
