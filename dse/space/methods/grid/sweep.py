"""One half of an exact count as a program: every node's grid of partial sums is a sum of moved grids of its sources.

A sweep runs over levels, from the root forward or from the terminal backward, up to the level where halves meet.
A grid is stored with the row lengths of the sums that the next step can make of it, so that to move it along any
axis is to move it as a whole, by one offset in memory.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dse.space.flat import Ints
from dse.space.methods.grid.axes import Layers, SumAxis, SumSpan
from dse.space.methods.grid.digits import WordArray, carry

_SAFE = 1 << 62


@dataclass(frozen=True, slots=True)
class Crop:
    """The sums of one axis that stay after a step: *length* from *first* on; those below join it if *gathered*."""

    first: int
    length: int
    gathered: bool


@dataclass(frozen=True, slots=True, eq=False)
class SweepStep:
    """Terms target += times * (source moved by offset), ascending by target, then source.

    *box* is the shape of the sums they make, *offset* counts cells of it, *crops* says what is kept, axis by axis.
    """

    target: Ints
    source: Ints
    offset: Ints
    times: Ints
    box: tuple[int, ...]
    crops: tuple[Crop, ...]

    def most_gathered(self) -> int:
        """Cells that may go into one when they are cropped."""
        return prod(crop.first + 1 for crop in self.crops if crop.gathered)


@dataclass(frozen=True, slots=True, eq=False)
class Sweep:
    """Steps between levels; shapes[level] is how a grid is stored, paths[level][node] the sum of its cells at most.

    The last shape is that of the sums alone; inner axes of the others are padded with zeros at their ends.
    """

    steps: tuple[SweepStep, ...]
    shapes: tuple[tuple[int, ...], ...]
    paths: tuple[NDArray[Any], ...]


@dataclass(frozen=True, slots=True)
class Schedule:
    """Grids (level, node) in an order in which each comes after its sources, and the most bytes alive at a time."""

    order: tuple[tuple[int, int], ...]
    memory: float


def forward(layers: Layers, sums: Sequence[SumAxis], spans: Sequence[Sequence[SumSpan]], cut: int) -> Sweep:
    """From the root to level *cut*; spans[axis][level] of the sums before."""
    return _sweep(layers, sums, spans, list(range(cut + 1)))


def backward(layers: Layers, sums: Sequence[SumAxis], spans: Sequence[Sequence[SumSpan]], cut: int) -> Sweep:
    """From the terminal to level *cut*; spans[axis][level] of the sums after."""
    return _sweep(layers, sums, spans, list(range(len(layers), cut - 1, -1)))


def cropped(boxes: Sequence[WordArray], crops: Sequence[Crop]) -> list[WordArray]:
    """What stays of the digits of a box along its axes from the second on; *boxes* are overwritten."""
    kept = list(boxes)
    for axis, crop in enumerate(crops, 1):
        before: tuple[Any, ...] = (slice(None),) * axis
        if crop.gathered and crop.first:
            for box in kept:
                box[(*before, crop.first)] += box[(*before, slice(0, crop.first))].sum(axis=axis, dtype=box.dtype)
            carry([box[(*before, crop.first)] for box in kept])
        kept = [box[(*before, slice(crop.first, crop.first + crop.length))] for box in kept]
    return kept


def schedule(sweep: Sweep, sizes: Sequence[float]) -> Schedule:
    """The more sparing of two orders, breadth or depth first; a grid of a level takes sizes[level] bytes."""
    return min((_walk(sweep, sizes, deep) for deep in (True, False)), key=lambda found: found.memory)


def _sweep(layers: Layers, sums: Sequence[SumAxis], spans: Sequence[Sequence[SumSpan]], levels: list[int]) -> Sweep:
    lengths = [tuple(axis[level].length for axis in spans) for level in levels]
    steps, shapes = [], []
    paths: list[NDArray[Any]] = [np.ones(1, np.int64)]
    for (here, there), length in zip(pairwise(levels), lengths, strict=False):
        layer = layers[min(here, there)]
        parent, value = np.nonzero(layer >= 0)
        child = layer[parent, value].astype(np.int64)
        weights = np.stack([axis.weights[min(here, there)][value] for axis in sums], axis=1)
        least, most = weights.min(axis=0).tolist(), weights.max(axis=0).tolist()
        box = tuple(n + high - low for n, low, high in zip(length, least, most, strict=True))
        crops = tuple(
            Crop(axis[there].low - axis[here].low - low, axis[there].length, axis[there].gathered)
            for axis, low in zip(spans, least, strict=True)
        )
        offset = (weights - least) @ np.array(strides(box), np.int64)
        source, target = (parent, child) if here < there else (child, parent)
        nodes = 1 if there == len(layers) else len(layers[there])
        steps.append(_step(target, source, offset, box, crops))
        shapes.append((length[0], *box[1:]))
        paths.append(_paths(steps[-1], paths[-1], nodes))
    return Sweep(tuple(steps), (*shapes, lengths[-1]), tuple(paths))


def strides(shape: tuple[int, ...]) -> list[int]:
    """Cells from one place to the next along each axis."""
    return [prod(shape[axis + 1 :]) for axis in range(len(shape))]


def _step(target: Ints, source: Ints, offset: Ints, box: tuple[int, ...], crops: tuple[Crop, ...]) -> SweepStep:
    order = np.lexsort((offset, source, target))
    target, source, offset = target[order], source[order], offset[order]
    new = np.ones(len(order), np.bool_)
    new[1:] = (np.diff(target) != 0) | (np.diff(source) != 0) | (np.diff(offset) != 0)
    first = np.flatnonzero(new)
    times = np.diff(np.append(first, len(order)))
    return SweepStep(target[first], source[first], offset[first], times, box, crops)


def _paths(step: SweepStep, paths: NDArray[Any], nodes: int) -> NDArray[Any]:
    if paths.dtype != object and int(paths.max()) * int(step.times.sum()) >= _SAFE:
        paths = paths.astype(object)
    found = np.zeros(nodes, paths.dtype)
    np.add.at(found, step.target, step.times * paths[step.source])
    return found


def _walk(sweep: Sweep, sizes: Sequence[float], deep: bool) -> Schedule:
    consumers: list[dict[int, list[int]]] = [{} for _ in sweep.shapes]
    missing: list[dict[int, int]] = [{} for _ in sweep.shapes]
    sources: list[dict[int, list[int]]] = [{} for _ in sweep.shapes]
    for level, step in enumerate(sweep.steps):
        pairs = np.unique(step.target * (int(step.source.max()) + 1) + step.source)
        targets, nodes = np.divmod(pairs, int(step.source.max()) + 1)
        for target, source in zip(targets.tolist(), nodes.tolist(), strict=True):
            consumers[level].setdefault(source, []).append(target)
            sources[level + 1].setdefault(target, []).append(source)
            missing[level + 1][target] = missing[level + 1].get(target, 0) + 1
    wanted = [{node: len(found) for node, found in level.items()} for level in consumers]
    ready, order, alive, peak = deque([(0, 0)]), [], 0.0, 0.0
    while ready:
        level, node = ready.pop() if deep else ready.popleft()
        order.append((level, node))
        alive += sizes[level]
        peak = max(peak, alive)
        for source in sources[level].get(node, ()):
            wanted[level - 1][source] -= 1
            if not wanted[level - 1][source]:
                alive -= sizes[level - 1]
        for target in consumers[level].get(node, ()):
            missing[level + 1][target] -= 1
            if not missing[level + 1][target]:
                ready.append((level + 1, target))
    return Schedule(tuple(order), peak)
