"""Runs a sweep a level at a time: for many nodes with small grids, where a call for each of them would cost most.

Terms with one offset go together, in rounds in which no target occurs twice.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import prod

import numpy as np

from dse.space.budget import TooMuchError
from dse.space.flat import Ints
from dse.space.grid.nodes import Grid, Node, Swept
from dse.space.grid.sweep import Step, Sweep, cropped
from dse.space.grid.words import LONGEST, Words, reduce, word


def run_levels(sweep: Sweep, modulus: int | None = None) -> Swept:
    """All grids of a sweep, as `nodes.run` makes them; TooMuchError if more than 2^24 equal terms meet."""
    grids: Words = np.zeros((1, prod(sweep.shapes[0])), np.uint16)
    grids[0, 0] = 1
    largest = [1]
    met: dict[Node, int] = {(0, 0): 1}
    for level, (step, paths) in enumerate(zip(sweep.steps, sweep.paths[1:], strict=True), 1):
        terms = int(np.bincount(step.target, step.times).max())
        if terms >= LONGEST:
            raise TooMuchError("too many equal terms")
        bound = min(int(paths.max()), terms * step.most_gathered() * max(largest))
        sums = np.zeros((len(paths), prod(step.box)), np.uint64 if modulus else word(bound))
        _add(sums, grids, step)
        reduce(sums, modulus)
        kept = cropped(sums.reshape(len(sums), *step.box), step.crops, modulus)
        stored = np.zeros((len(kept), *sweep.shapes[level]), kept.dtype)
        stored[(slice(None), *(slice(0, crop.length) for crop in step.crops))] = kept
        grids = stored.reshape(len(kept), -1)
        largest = grids.max(axis=1).tolist()
        met.update(((level, node), number) for node, number in enumerate(largest))
    return Swept({node: Grid(grids[node], number) for node, number in enumerate(largest) if number}, met)


def memory_of_levels(sweep: Sweep, words: Sequence[int]) -> float:
    """Most bytes alive at a time, if a number of a level takes words[level] bytes."""
    most = 0.0
    for level, step in enumerate(sweep.steps, 1):
        before = len(sweep.paths[level - 1]) * prod(sweep.shapes[level - 1]) * words[level - 1]
        after = len(sweep.paths[level]) * prod(step.box) * words[level]
        most = max(most, 2.0 * before + 2.0 * after)
    return most


def _add(sums: Words, grids: Words, step: Step) -> None:
    """Add the terms up, shape (nodes, cells of the box)."""
    for chosen in _rounds(step):
        target, source, times = step.target[chosen], step.source[chosen], step.times[chosen]
        offset = int(step.offset[chosen[0]])
        stop = min(offset + grids.shape[1], sums.shape[1])
        moved = grids[source, : stop - offset].astype(sums.dtype, copy=False)
        if int(times.max()) > 1:
            moved *= times[:, None].astype(sums.dtype)
        sums[target, offset:stop] += moved


def _rounds(step: Step) -> list[Ints]:
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
