"""How much of the space there is to each run: what it counts where runs crowd.

Where points are drawn with a density q, a mean over the space is one over the points with weights 1/q; the volume that
is nearer to a point than to any other is 1/(n q) of it (Voronoi cells; importance sampling with an estimated density).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

_PROBES = 2**14
_PROBES_A_POINT = 16
_MOST_PROBES = 2**20
_CROWDED = 0.8
_SEED = 0


def effective(weights: Floats) -> float:
    """How many runs that count alike tell as much as these (Kish 1965); 0 for none."""
    squared = float((weights**2).sum())
    return float(weights.sum()) ** 2 / squared if squared else 0.0


def space_weights(places: Floats, groups: NDArray[np.intp], on_grid: bool) -> Floats:
    """Weights of n points of the unit cube, (n, k), 1 on average in each of *groups*, (n,); NaN is no coordinate.

    All 1 where points lie as evenly as random ones do, or more so, unless they are *on_grid*: the ends of a grid have
    half as much space to them. A group of points without coordinates has weights 1, too.
    """
    weights = np.ones(len(places))
    for group in np.unique(groups):
        rows = np.flatnonzero(groups == group)
        points = places[rows][:, ~np.isnan(places[rows]).any(axis=0)]
        points = points[:, np.ptp(points, axis=0) > 0]
        if len(rows) < 2 or not points.shape[1]:
            continue
        cells = _cells(points)
        even = _cells(np.random.default_rng(_SEED).random(points.shape))
        if on_grid or effective(cells) < _CROWDED * effective(even):
            weights[rows] = cells
    return weights


def _cells(points: Floats) -> Floats:
    """The volume of each point's cell, 1 on average."""
    import warnings

    from scipy.spatial import cKDTree
    from scipy.stats import qmc

    count, dimensions = points.shape
    different, which, copies = np.unique(points, axis=0, return_inverse=True, return_counts=True)
    probes = min(max(_PROBES, _PROBES_A_POINT * len(different)), _MOST_PROBES)
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="The balance properties", category=UserWarning)
        cloud = qmc.Sobol(dimensions, seed=np.random.default_rng(_SEED)).random(probes)
    _, nearest = cKDTree(different).query(cloud)
    # A share of half a probe for those that got none: no run counts nothing.
    volume = np.maximum(np.bincount(nearest, minlength=len(different)), 0.5) / copies
    shared = volume[which.reshape(-1)]
    return np.asarray(shared * count / shared.sum(), dtype=np.float64)
