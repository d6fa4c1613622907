"""Runs a sweep: grids are added up block by block, so that what is written stays in the cache of a core.

A grid takes the least word its numbers surely fit: they are at most what the terms' largest numbers add up to, at
most the number of paths, and at most what a grid of fewer sums shows at the same node.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from math import prod

import numpy as np

from dse.space.methods.budget import TooMuchError
from dse.space.methods.grid.digits import DIGIT_BITS, LONGEST, Digits, WordArray, carry, digits_for, split, word
from dse.space.methods.grid.sweep import Schedule, Sweep, SweepStep, cropped

GridNode = tuple[int, int]
"""Level and number."""

BLOCK_BYTES = 1 << 19
"""Bytes added up at a time; they fit into the nearer caches of a core."""

_HEADROOM = 16
"""A grid moves to a smaller word only if a few of its kind will still fit there when they are added."""

_SHARED = 1 << 20
"""Cells from which on the work on one grid is divided among cores."""


@dataclass(frozen=True, slots=True, eq=False)
class SumGrid:
    """Ways to each sum, flat, in the shape of its level; *largest* bounds the numbers."""

    digits: Digits
    largest: int


@dataclass(frozen=True, slots=True, eq=False)
class Swept:
    """The grids of the last level by node, and the largest numbers met at every node on the way."""

    grids: Mapping[int, SumGrid]
    largest: Mapping[GridNode, int]


@dataclass(frozen=True, slots=True)
class _Term:
    grid: SumGrid
    offset: int
    times: int


def run(sweep: Sweep, schedule: Schedule, caps: Sequence[Mapping[GridNode, int]] = ()) -> Swept:
    """All grids of a sweep in the order of *schedule*; *caps* bound their numbers from what is known otherwise.

    A node without a grid has no path within the bounds. TooMuchError if more than 2^24 equal terms meet.
    """
    firsts = [np.searchsorted(step.target, np.arange(int(step.target.max(initial=-1)) + 2)) for step in sweep.steps]
    waiting = _uses(sweep)
    start = np.zeros(prod(sweep.shapes[0]), np.uint16)
    start[0] = 1
    grids: dict[GridNode, SumGrid] = {(0, 0): SumGrid((start,), 1)}
    largest: dict[GridNode, int] = {(0, 0): 1}
    with ThreadPoolExecutor(min(4, os.cpu_count() or 1)) as pool:
        for level, node in schedule.order[1:]:
            step, first = sweep.steps[level - 1], firsts[level - 1]
            chosen = slice(int(first[node]), int(first[node + 1]))
            sources = step.source[chosen].tolist()
            rest = step.offset[chosen].tolist(), step.times[chosen].tolist()
            terms = [_Term(grids[level - 1, source], *both) for source, *both in zip(sources, *rest, strict=True)]
            known = (cap[level, node] for cap in caps)
            most = step.most_gathered() * sum(term.times * term.grid.largest for term in terms)
            bound = min(int(sweep.paths[level][node]), most, *known)
            grid = _combine(terms, step, sweep.shapes[level], bound, pool)
            grids[level, node], largest[level, node] = grid, grid.largest
            for source in set(sources):
                waiting[level - 1, source] -= 1
                if not waiting[level - 1, source]:
                    del grids[level - 1, source]
    last = len(sweep.steps)
    return Swept({node: grid for (level, node), grid in grids.items() if level == last}, largest)


def _uses(sweep: Sweep) -> dict[GridNode, int]:
    """How many grids each grid is a source of."""
    found: dict[GridNode, int] = {}
    for level, step in enumerate(sweep.steps):
        for source, _ in {*zip(step.source.tolist(), step.target.tolist(), strict=True)}:
            found[level, source] = found.get((level, source), 0) + 1
    return found


def _combine(terms: Sequence[_Term], step: SweepStep, shape: tuple[int, ...], bound: int, pool: Executor) -> SumGrid:
    """The sum of the terms, cropped and stored in *shape*."""
    terms = [term for term in terms if term.grid.largest]
    if sum(term.times for term in terms) >= LONGEST:
        raise TooMuchError("too many equal terms")
    kind = word(bound) or np.uint64
    digits = tuple(np.zeros(shape, kind) for _ in range(digits_for(bound)))
    plane, outer = prod(step.box[1:]), step.crops[0]
    thick = max(1, BLOCK_BYTES // (plane * np.dtype(kind).itemsize))
    fill = partial(_fill, digits, terms, step, thick)
    last = outer.first + outer.length
    if outer.length * plane >= _SHARED:
        parts = 8
        edges = [outer.first + part * outer.length // parts for part in range(parts + 1)]
        list(pool.map(fill, edges[:-1], edges[1:]))
    else:
        fill(outer.first, last)
    if outer.gathered:
        lowest = [digit[_window(step, 0, 1)] for digit in digits]
        for begin in range(0, outer.first, thick):
            block = _added(digits, terms, step, begin, min(begin + thick, outer.first))
            for place, part in zip(lowest, block, strict=True):
                np.add(place, part.sum(axis=0, keepdims=True, dtype=kind), out=place)
            carry(lowest)
    return _trimmed(tuple(digit.reshape(-1) for digit in digits), bound)


def _fill(digits: Digits, terms: Sequence[_Term], step: SweepStep, thick: int, begin: int, end: int) -> None:
    """Planes begin..end - 1 of the box, into their places."""
    first = step.crops[0].first
    for start in range(begin, end, thick):
        stop = min(start + thick, end)
        for digit, part in zip(digits, _added(digits, terms, step, start, stop), strict=True):
            digit[_window(step, start - first, stop - first)] = part


def _window(step: SweepStep, start: int, stop: int) -> tuple[slice, ...]:
    """Outer planes start..stop - 1 of a stored grid, without the padding."""
    return (slice(start, stop), *(slice(0, crop.length) for crop in step.crops[1:]))


def _added(digits: Digits, terms: Sequence[_Term], step: SweepStep, start: int, stop: int) -> list[WordArray]:
    """Planes start..stop - 1 of the box, cropped along the inner axes."""
    plane = prod(step.box[1:])
    begin, end = start * plane, stop * plane
    kind = digits[0].dtype
    sums: list[WordArray] = [np.zeros(end - begin, kind) for _ in digits]
    for term in terms:
        low, high = max(begin - term.offset, 0), min(end - term.offset, len(term.grid.digits[0]))
        if low >= high:
            continue
        parts = [digit[low:high] for digit in term.grid.digits]
        if len(parts) == 1 and len(sums) > 1:
            parts = split(parts[0], len(sums))
        window = slice(low + term.offset - begin, high + term.offset - begin)
        for total, part in zip(sums, parts, strict=False):
            place = total[window]
            np.add(place, part if term.times == 1 else np.multiply(part, term.times, dtype=kind), out=place)
    carry(sums)
    boxes = [total.reshape(stop - start, *step.box[1:]) for total in sums]
    return cropped(boxes, step.crops[1:])


def _trimmed(digits: Digits, bound: int) -> SumGrid:
    """Without digits that are 0, in the least word."""
    while len(digits) > 1 and not digits[-1].any():
        digits = digits[:-1]
    if len(digits) > 1:
        return SumGrid(digits, min(bound, ((int(digits[-1].max()) + 1) << (DIGIT_BITS * (len(digits) - 1))) - 1))
    largest = int(digits[0].max(initial=0))
    kind = word(largest * _HEADROOM)
    if kind is not None and np.dtype(kind).itemsize < digits[0].itemsize:
        return SumGrid((digits[0].astype(kind),), largest)
    return SumGrid(digits, largest)
