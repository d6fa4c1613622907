"""How much of the space there is to each run: what it counts where runs crowd.

Where points are drawn with a density q, a mean over the space is one over the points with weights 1/q (importance
sampling); the volume that is nearer to a point than to any other is about 1/(n q) (Voronoi cells).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

_PROBES = 2**12
_PROBES_A_POINT = 16
_MOST_PROBES = 2**20
_CROWDED = 0.8
_MOST_EVEN = 2000
_SEED = 0


def effective(weights: Floats) -> float:
    """How many runs that count alike tell as much as these (Kish 1965); 0 for none."""
    squared = float((weights**2).sum())
    return float(weights.sum()) ** 2 / squared if squared else 0.0


def space_weights(places: Floats, groups: NDArray[np.intp], on_grid: bool) -> Floats:
    """Weights of n points of the unit cube, (n, k), 1 on average in each of *groups*, (n,); NaN is no coordinate.

    All 1 where points lie as evenly as random ones do, or more so, unless they are *on_grid*: the end of a grid has
    half as much space to it. A group of points without coordinates has weights 1, too.
    """
    weights = np.ones(len(places))
    known: dict[bytes, Floats] = {}
    for group in np.unique(groups):
        rows = np.flatnonzero(groups == group)
        points = places[rows][:, ~np.isnan(places[rows]).any(axis=0)]
        points = points[:, np.ptp(points, axis=0) > 0]
        if len(rows) < 2 or not points.shape[1]:
            continue
        if on_grid:
            weights[rows] = _grid_cells(points)
            continue
        # Groups often have the same points: those of a study at each condition.
        key = points.tobytes()
        if key not in known:
            known[key] = _cells(points) if _is_crowded(points) else np.ones(len(points))
        weights[rows] = known[key]
    return weights


def _is_crowded(points: Floats) -> bool:
    """Whether *points*, of which some tell, lie less evenly than random ones."""
    random = np.random.default_rng(_SEED)
    even = random.random((min(len(points), _MOST_EVEN), points.shape[1]))
    some = points if len(points) == len(even) else points[np.sort(random.permutation(len(points))[: len(even)])]
    return effective(_cells(some)) < _CROWDED * effective(_cells(even))


def lean(places: Floats, weights: Floats, met: NDArray[np.bool_]) -> float:
    """By how much the weight of runs that are *met* may be too large, negative if too small, as a part of all weight.

    Where runs at *places*, (n, k), crowd on one side of a boundary their cells reach across it. That is told by what
    the nearest other run says of each: the one too often, or the other. 0 where they do not crowd.
    """
    from scipy.spatial import cKDTree

    if len(places) < 2 or not places.shape[1] or np.ptp(weights) == 0:
        return 0.0
    points = np.nan_to_num(places, nan=-1.0)
    nearest = np.asarray(cKDTree(points).query(points, k=[2])[1])
    wrong = met[nearest[:, 0]].astype(np.float64) - met
    return float(weights @ wrong / weights.sum())


def _grid_cells(points: Floats) -> Floats:
    """The cells of a grid, 1 on average."""
    volume = np.ones(len(points))
    for column in points.T:
        levels, which = np.unique(column, return_inverse=True)
        borders = np.concatenate([[0.0], (levels[1:] + levels[:-1]) / 2, [1.0]])
        volume *= np.diff(borders)[which.reshape(-1)]
    return np.asarray(volume / volume.mean(), dtype=np.float64)


def _cells(points: Floats) -> Floats:
    """The volume of each point's cell, 1 on average."""
    from scipy.spatial import cKDTree

    count, dimensions = points.shape
    different, which, copies = np.unique(points, axis=0, return_inverse=True, return_counts=True)
    probes = min(max(_PROBES, _PROBES_A_POINT * len(different)), _MOST_PROBES)
    _, nearest = cKDTree(different).query(np.random.default_rng(_SEED).random((probes, dimensions)))
    # A share of half a probe for those that got none: no run counts nothing.
    volume = np.maximum(np.bincount(nearest, minlength=len(different)), 0.5) / copies
    shared = volume[which.reshape(-1)]
    return np.asarray(shared * count / shared.sum(), dtype=np.float64)
