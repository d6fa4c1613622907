"""Runs a sweep a level at a time: for many nodes with small grids, where a call for each of them would cost most.

Terms with one offset go together, in rounds in which no target occurs twice.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import prod

import numpy as np

from dse.space.flat import Ints
from dse.space.methods.budget import TooMuchError
from dse.space.methods.grid.digits import LONGEST, WordArray, carry, digits_for, split, word
from dse.space.methods.grid.nodes import GridNode, SumGrid, Swept
from dse.space.methods.grid.sweep import Sweep, SweepStep, cropped


def run_levels(sweep: Sweep) -> Swept:
    """All grids of a sweep, as `nodes.run` makes them; TooMuchError if more than 2^24 equal terms meet."""
    start = np.zeros((1, prod(sweep.shapes[0])), np.uint16)
    start[0, 0] = 1
    digits, largest = [start], [1]
    met: dict[GridNode, int] = {(0, 0): 1}
    for level, (step, paths) in enumerate(zip(sweep.steps, sweep.paths[1:], strict=True), 1):
        terms = int(np.bincount(step.target, step.times).max())
        if terms >= LONGEST:
            raise TooMuchError("too many equal terms")
        bound = min(int(paths.max()), terms * step.most_gathered() * max(largest))
        sums = _added(digits, step, len(paths), bound)
        boxes = cropped([total.reshape(len(total), *step.box) for total in sums], step.crops)
        while len(boxes) > 1 and not boxes[-1].any():
            boxes.pop()
        digits = [np.zeros((len(paths), *sweep.shapes[level]), box.dtype) for box in boxes]
        for stored, box in zip(digits, boxes, strict=True):
            stored[(slice(None), *(slice(0, crop.length) for crop in step.crops))] = box
        digits = [stored.reshape(len(paths), -1) for stored in digits]
        largest = digits[0].max(axis=1).tolist() if len(digits) == 1 else paths.tolist()
        met.update(((level, node), number) for node, number in enumerate(largest))
    grids = {
        node: SumGrid(tuple(digit[node] for digit in digits), number) for node, number in enumerate(largest) if number
    }
    return Swept(grids, met)


def memory_of_levels(sweep: Sweep, words: Sequence[int]) -> float:
    """Most bytes alive at a time, if a number of a level takes words[level] bytes."""
    most = 0.0
    for level, step in enumerate(sweep.steps, 1):
        before = len(sweep.paths[level - 1]) * prod(sweep.shapes[level - 1]) * words[level - 1]
        after = len(sweep.paths[level]) * prod(step.box) * words[level]
        most = max(most, 2.0 * before + 2.0 * after)
    return most


def _added(digits: list[WordArray], step: SweepStep, nodes: int, bound: int) -> list[WordArray]:
    """Sums of the terms, shape (nodes, cells of the box) each digit; not carried."""
    kind, cells = word(bound) or np.uint64, prod(step.box)
    sums: list[WordArray] = [np.zeros((nodes, cells), kind) for _ in range(digits_for(bound))]
    parts = split(digits[0], len(sums)) if len(digits) == 1 < len(sums) else digits
    for chosen in _rounds(step):
        target, source, times = step.target[chosen], step.source[chosen], step.times[chosen]
        offset = int(step.offset[chosen[0]])
        for total, part in zip(sums, parts, strict=False):
            stop = min(offset + part.shape[1], cells)
            moved = part[source, : stop - offset].astype(kind, copy=False)
            if int(times.max()) > 1:
                moved *= times[:, None].astype(kind)
            total[target, offset:stop] += moved
    carry(sums)
    return sums


def _rounds(step: SweepStep) -> list[Ints]:
    """Numbers of terms, those of a round with one offset and distinct targets."""
    order = np.lexsort((step.target, step.offset))
    target, offset = step.target[order], step.offset[order]
    fresh = np.ones(len(order), np.bool_)
    fresh[1:] = (np.diff(target) != 0) | (np.diff(offset) != 0)
    first = np.flatnonzero(fresh)
    rank = np.arange(len(order)) - np.repeat(first, np.diff(np.append(first, len(order))))
    by_round = np.lexsort((rank, offset))
    rank, offset = rank[by_round], offset[by_round]
    borders = np.flatnonzero((np.diff(rank) != 0) | (np.diff(offset) != 0)) + 1
    return np.split(order[by_round], borders)
