"""How large the numbers in the grids will be, foretold from means and variances of the sums (normal approximation).

Only the cost is estimated from it; what is counted never rests on it.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from dse.space.flat import Floats, Ints
from dse.space.methods.grid.axes import Axis, Layers


def heights(layers: Layers, sums: Sequence[Axis]) -> tuple[list[float], list[float]]:
    """Binary logarithm of the most ways to one cell of a level's grids, of paths before it and of paths after it."""
    before, after = [0.0], [0.0]
    state = _start(len(sums))
    for level, layer in enumerate(layers):
        parent, value = np.nonzero(layer >= 0)
        nodes = len(layers[level + 1]) if level + 1 < len(layers) else 1
        state = state.moved(parent, layer[parent, value], _weights(sums, level, value), nodes)
        before.append(state.height())
    state = _start(len(sums))
    for level in reversed(range(len(layers))):
        parent, value = np.nonzero(layers[level] >= 0)
        state = state.moved(layers[level][parent, value], parent, _weights(sums, level, value), len(layers[level]))
        after.append(state.height())
    return before, after[::-1]


class _Moments:
    """Paths to every node, up to 2^scale, and mean and variance of each sum over them."""

    def __init__(self, paths: Floats, mean: Floats, variance: Floats, scale: float) -> None:
        self.paths, self.mean, self.variance, self.scale = paths, mean, variance, scale

    def moved(self, source: NDArray[np.integer], target: NDArray[np.integer], weights: Floats, nodes: int) -> _Moments:
        share = self.paths[source]
        paths = np.bincount(target, share, nodes)
        safe = np.where(paths > 0, paths, 1.0)
        mean, variance = np.zeros((nodes, weights.shape[1])), np.zeros((nodes, weights.shape[1]))
        for axis in range(weights.shape[1]):
            sum_ = self.mean[source, axis] + weights[:, axis]
            mean[:, axis] = np.bincount(target, share * sum_, nodes) / safe
            spread = self.variance[source, axis] + (sum_ - mean[target, axis]) ** 2
            variance[:, axis] = np.bincount(target, share * spread, nodes) / safe
        most = float(paths.max())
        return _Moments(paths / most, mean, variance, self.scale + float(np.log2(most)))

    def height(self) -> float:
        there = self.paths > 0
        # As logarithms: the product over many sums is beyond any float.
        spread = np.log2(np.maximum(1.0, np.sqrt(2 * np.pi * self.variance[there]))).sum(axis=1)
        return self.scale + float((np.log2(self.paths[there]) - spread).max())


def _start(axes: int) -> _Moments:
    return _Moments(np.ones(1), np.zeros((1, axes)), np.zeros((1, axes)), 0.0)


def _weights(sums: Sequence[Axis], level: int, value: Ints) -> Floats:
    return np.stack([axis.weights[level][value] for axis in sums], axis=1).astype(np.float64)
