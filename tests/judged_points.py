"""What margins at some points tell about verdicts at others."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from dse.exploration.level_set import LevelSet, border

Array = NDArray[np.float64]


def classes(margins: Mapping[str, Array]) -> NDArray[np.intp]:
    """0 where all requirements pass, 1 where one fails, else 2: not all are exercised."""
    table = np.array(list(margins.values()))
    return np.where((table < 0).any(axis=0), 1, np.where(np.isnan(table).any(axis=0), 2, 0))


def predicted(points: Array, margins: Mapping[str, Array], fine: Array) -> NDArray[np.intp]:
    """`classes` at *fine*, by what the runs at *points* tell, scaled as the search does it."""
    told = {}
    for name, column in margins.items():
        known = ~np.isnan(column)
        scale = np.nanmedian(np.abs(column[:16]))
        surface = LevelSet(points[known], np.arcsinh(column[known] / scale)).at(fine).mean
        told[name] = np.where(border(points, known).at(fine).mean < 0, np.nan, surface)
    return classes(told)
