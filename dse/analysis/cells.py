"""How much of the space there is to each run of a grid: an end of a range has half as much as what lies between."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def effective(weights: Floats) -> float:
    """How many runs that count alike tell as much as these (Kish 1965); 0 for none."""
    squared = float((weights**2).sum())
    return float(weights.sum()) ** 2 / squared if squared else 0.0


def grid_weights(places: Floats, groups: NDArray[np.intp]) -> Floats:
    """The cells of n points of a grid in the unit cube, (n, k), 1 on average in each of *groups*, (n,).

    Coordinates that are NaN, or equal in a whole group, do not count.
    """
    weights = np.ones(len(places))
    for group in np.unique(groups):
        rows = np.flatnonzero(groups == group)
        for column in places[rows].T:
            if np.isnan(column).any() or np.ptp(column) == 0:
                continue
            levels, which = np.unique(column, return_inverse=True)
            borders = np.concatenate([[0.0], (levels[1:] + levels[:-1]) / 2, [1.0]])
            weights[rows] *= np.diff(borders)[which.reshape(-1)]
        weights[rows] /= weights[rows].mean()
    return weights
