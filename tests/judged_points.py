"""What margins at some points tell about verdicts at others."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from dse.exploration.surrogate import Surrogate, SurrogateAt, misjudged, shapes_of, single_threaded

Array = NDArray[np.float64]


def classes(margins: Mapping[str, Array]) -> NDArray[np.intp]:
    """0 where all requirements pass, 1 where one fails, else 2: not all are exercised."""
    table = np.array(list(margins.values()))
    return np.where((table < 0).any(axis=0), 1, np.where(np.isnan(table).any(axis=0), 2, 0))


def believed(points: Array, margins: Mapping[str, Array], fine: Array) -> list[SurrogateAt]:
    """At *fine*, of each requirement, by what the runs at *points* tell."""
    with single_threaded():
        return [Surrogate.of(points, column, shapes_of(points, column)).at(fine) for column in margins.values()]


def predicted(points: Array, margins: Mapping[str, Array], fine: Array) -> NDArray[np.intp]:
    """`classes` at *fine*, by what the runs at *points* tell."""
    beliefs = believed(points, margins, fine)
    passing = np.prod([belief.passing() for belief in beliefs], axis=0)
    failing = 1 - np.prod([1 - belief.failing() for belief in beliefs], axis=0)
    return np.argmax([passing, failing, 1 - passing - failing], axis=0)


def believed_wrong(points: Array, margins: Mapping[str, Array], fine: Array) -> float:
    """Which share of *fine* is believed to be misjudged by the runs at *points*."""
    return float(misjudged(believed(points, margins, fine)).mean())
