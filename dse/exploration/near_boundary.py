"""Which runs lie near a boundary: those with a neighbour whose verdict or outcome is another one."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dse.domain.bench import VERDICTS, Verdict
from dse.domain.sampler import Grid
from dse.domain.study import Study
from dse.exploration.variables import unit_of
from dse.storage import RunTable

_PASS, _NOT_APPLICABLE = VERDICTS.index(Verdict.PASS), VERDICTS.index(Verdict.NOT_APPLICABLE)


def near_boundary(study: Study, table: RunTable, grid: Grid | None) -> frozenset[int]:
    """Numbers of the finished, not failed runs near a boundary in any requirement, or next to a failed run.

    Neighbours belong to the same configuration. On a *grid* they are one level apart in one variable; of points of d
    variables that lie anywhere they are the 2 d nearest, each variable scaled to its range.
    """
    if not study.sampled or not len(table):
        return frozenset()
    points = unit_of(table.coordinates(), study.sampled)
    kinds = _kinds(table)
    names = np.array(table.configurations)
    near = np.zeros(len(table), dtype=np.bool_)
    for name in dict.fromkeys(table.configurations):
        rows = np.flatnonzero(names == name)
        if grid is None:
            near[rows] = _differs_from_nearest(points[rows], kinds[rows])
        else:
            near[rows] = _differs_along_an_axis(points[rows], kinds[rows])
    return frozenset(table.numbers[near & table.done].tolist())


def _kinds(table: RunTable) -> NDArray[np.intp]:
    """A number per run that is equal where outcome and all verdicts are; what does not apply is no boundary."""
    verdicts = np.where(table.block.verdicts == _NOT_APPLICABLE, _PASS, table.block.verdicts)
    codes = np.column_stack([table.done, verdicts])
    return np.unique(codes, axis=0, return_inverse=True)[1].reshape(len(table))


def _differs_along_an_axis(points: NDArray[np.float64], kinds: NDArray[np.intp]) -> NDArray[np.bool_]:
    near = np.zeros(len(points), dtype=np.bool_)
    for axis in range(points.shape[1]):
        others = np.delete(points, axis, axis=1)
        order = np.lexsort((points[:, axis], *others.T))
        first, second = order[:-1], order[1:]
        neighbours = (others[first] == others[second]).all(axis=1)
        differ = neighbours & (kinds[first] != kinds[second])
        near[first[differ]] = True
        near[second[differ]] = True
    return near


def _differs_from_nearest(points: NDArray[np.float64], kinds: NDArray[np.intp]) -> NDArray[np.bool_]:
    from scipy.spatial import cKDTree

    count = min(2 * points.shape[1] + 1, len(points))
    _, nearest = cKDTree(points).query(points, k=np.arange(1, count + 1))
    # A point may come after its own duplicates; as its kind equals its own, it need not be taken out.
    return np.asarray((kinds[nearest] != kinds[:, None]).any(axis=1), dtype=np.bool_)
