"""Which sums matter to an exact count, at which level its halves meet, and what that costs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import inf, log2, prod

import numpy as np
from numpy.typing import NDArray

from dse.space.flat import Floats, Ints
from dse.space.methods.budget import Cost, TooMuchError
from dse.space.methods.grid.axes import Layers, SumAxis, SumSpan, axes, pruned, reached, spans
from dse.space.methods.grid.digits import DIGIT_BITS
from dse.space.methods.grid.halves import Side
from dse.space.methods.grid.levels import memory_of_levels, run_levels
from dse.space.methods.grid.nodes import GridNode, Swept, run
from dse.space.methods.grid.sweep import Schedule, Sweep, backward, forward, schedule
from dse.space.methods.mdd.diagram import DecisionDiagram

_CALL = 15_000
"""What a term costs besides its cells, in additions of a cell, if grids are added one by one."""

_AT_ONCE = 4
"""What a cell costs, in additions, if the grids of a level are added at once."""

_MEETING = 24
"""What a cell costs where the halves meet, in additions."""

_PAIR = 150_000
"""What a pair of grids costs besides its cells where the halves meet, in additions."""

_CUTS = 8
"""How many cuts are tried, the cheapest first, until one fits into memory."""

_WORTH_CAPS = 1e8
"""Work from which on bounds from grids of fewer sums pay."""

_FINEST = 1e15
"""Cells of one grid beyond which not even the cost is worked out."""

_MOST_BITS = 60.0
"""Binary logarithm of the cells of one grid beyond which they are not multiplied out: no work allows them."""


@dataclass(frozen=True, slots=True, eq=False)
class Counting:
    """What is to be counted: a diagram without hopeless edges; the sums that matter, that of most places first."""

    diagram: DecisionDiagram
    sums: tuple[SumAxis, ...]
    before: tuple[Sequence[SumSpan], ...]
    after: tuple[Sequence[SumSpan], ...]

    @property
    def layers(self) -> Layers:
        """Of the diagram; nodes that lead nowhere may remain."""
        return self.diagram.layers

    def ahead(self, level: int) -> Side:
        """The sums of what lies before a level."""
        return Side(tuple(axis[level] for axis in self.before))

    def behind(self, level: int) -> Side:
        """The sums of what lies after a level."""
        return Side(tuple(axis[level] for axis in self.after))


@dataclass(frozen=True, slots=True)
class Execution:
    """How to run a sweep: grid by grid in an order or, *schedule* None, level by level; *memory* in bytes."""

    schedule: Schedule | None
    memory: float


@dataclass(frozen=True, slots=True, eq=False)
class Split:
    """Sweeps from both ends to the level *cut*, and how to run them."""

    cut: int
    sweeps: tuple[Sweep, Sweep]
    executions: tuple[Execution, Execution]
    cost: Cost


def counting(diagram: DecisionDiagram) -> Counting | DecisionDiagram:
    """What is to be counted; a diagram alone if it holds no rule any more. TooMuchError for a rule that is no sum."""
    if diagram.empty or diagram.expanded:
        return diagram
    if diagram.flat.wides():
        raise TooMuchError("a rule is no sum")
    sums = axes(diagram)
    if not sums:
        return _nothing(diagram) if sums is None else diagram
    layers = pruned(diagram.layers, sums)
    if not (layers[0] >= 0).any():
        return _nothing(diagram)
    left: list[tuple[SumAxis, list[SumSpan], list[SumSpan]]] = []
    for axis in sums:
        reach = reached(layers, axis.weights)
        least, most = int(reach.least_after[0][0]), int(reach.most_after[0][0])
        # Without the hopeless edges nothing may be left of a rule.
        if most > axis.high or (axis.low is not None and least < axis.low):
            both = spans(layers, axis, reach)
            if both is None:
                return _nothing(diagram)
            left.append((axis, *both))
    trimmed = replace(diagram, layers=layers)
    if not left:
        return trimmed
    left.sort(key=lambda entry: -max(span.length for span in entry[1]))
    sums_left, before, after = zip(*left, strict=True)
    return Counting(trimmed, sums_left, before, after)


def split(problem: Counting, most_memory: float, most_work: float) -> Split:
    """At the cut of least work whose memory is allowed; TooMuchError if there is none."""
    layers = problem.layers
    _insist_on_a_cut(problem)
    rising, falling = heights(layers, problem.sums)
    works = _works(problem, rising, falling)
    if min(works) > most_work or min(works) == inf:
        raise TooMuchError(f"some {min(works):.0e} additions")
    least = float("inf")
    for cut in sorted(range(len(works)), key=works.__getitem__)[:_CUTS]:
        if works[cut] > most_work:
            break
        if prod(problem.ahead(cut).shape) > _FINEST:
            raise TooMuchError("grids of more than 1e15 cells")
        before, after = (
            forward(layers, problem.sums, problem.before, cut),
            backward(layers, problem.sums, problem.after, cut),
        )
        own, other = words(rising[: cut + 1]), words(falling[: cut - len(layers) - 2 : -1])
        waiting = prod(before.shapes[-1]) * own[-1] * len(before.paths[-1])
        arriving = prod(after.shapes[-1]) * other[-1] * len(after.paths[-1])
        if waiting + arriving > most_memory:
            least = min(least, waiting + arriving)
            continue
        both = execution(before, own, most_memory), execution(after, other, most_memory)
        meeting = waiting + arriving + 4 * 8 * prod(after.shapes[-1])
        memory = max(both[0].memory, waiting + both[1].memory, meeting)
        if memory <= most_memory:
            return Split(cut, (before, after), both, Cost(works[cut], memory))
        least = min(least, memory)
    raise TooMuchError(f"some {least:.0e} bytes")


def execution(sweep: Sweep, sizes: Sequence[int], most_memory: float) -> Execution:
    """The faster way that memory allows; a number of a level takes sizes[level] bytes."""
    one_by_one = at_once = 0.0
    for step, size in zip(sweep.steps, sizes[1:], strict=True):
        cells = prod(step.box) * size / 4
        one_by_one += len(step.target) * (cells + _CALL)
        at_once += len(step.target) * cells * _AT_ONCE
    memory = memory_of_levels(sweep, sizes)
    if at_once <= one_by_one and memory <= most_memory / 2:
        return Execution(None, memory)
    found = schedule(sweep, [prod(shape) * size for shape, size in zip(sweep.shapes, sizes, strict=True)])
    return Execution(found, found.memory)


def execute(sweep: Sweep, chosen: Execution, caps: Sequence[Mapping[GridNode, int]] = ()) -> Swept:
    """All grids of a sweep."""
    return run_levels(sweep) if chosen.schedule is None else run(sweep, chosen.schedule, caps)


def caps(problem: Counting, found: Split) -> tuple[Sequence[Mapping[GridNode, int]], Sequence[Mapping[GridNode, int]]]:
    """The largest numbers in the grids of all sums but one, if that pays: no finer grid has larger ones."""
    largest: tuple[list[Mapping[GridNode, int]], list[Mapping[GridNode, int]]] = ([], [])
    if found.cost.work < _WORTH_CAPS or len(problem.sums) == 1:
        return largest
    for left_out in range(len(problem.sums)):
        kept = [axis for axis in range(len(problem.sums)) if axis != left_out]
        sums = [problem.sums[axis] for axis in kept]
        before = forward(problem.layers, sums, [problem.before[axis] for axis in kept], found.cut)
        after = backward(problem.layers, sums, [problem.after[axis] for axis in kept], found.cut)
        for sweep, known in zip((before, after), largest, strict=True):
            known.append(execute(sweep, execution(sweep, [8] * len(sweep.shapes), found.cost.memory)).largest)
    return largest


def words(heights_: Sequence[float]) -> list[int]:
    """Bytes of a number up to 2^height, as a rule."""
    return [2 if h < 12 else 4 if h < 31 else 8 if h < 63 else 8 * (int(h) // DIGIT_BITS + 1) for h in heights_]


def _nothing(diagram: DecisionDiagram) -> DecisionDiagram:
    return replace(diagram, layers=tuple(layer[:0] for layer in diagram.layers), empty=True)


def _insist_on_a_cut(problem: Counting) -> None:
    """TooMuchError if wherever the halves meet, some grid on the way is beyond all measure."""
    levels = range(len(problem.layers) + 1)
    ahead = next((level for level in levels if _bits(problem.ahead(level).shape) > _MOST_BITS), len(levels))
    behind = next((level for level in reversed(levels) if _bits(problem.behind(level).shape) > _MOST_BITS), -1)
    # The halves may meet after the last grid that is too fine for the one and before the first for the other.
    if behind + 1 > ahead - 1:
        raise TooMuchError(f"grids of more than 2^{_MOST_BITS:.0f} cells")


def _bits(shape: Sequence[int]) -> float:
    return sum(map(log2, shape))


def _works(problem: Counting, rising: Sequence[float], falling: Sequence[float]) -> list[float]:
    """Additions by the level at which the halves meet."""
    ours, theirs, meetings = [0.0], [0.0], []
    sizes = list(zip(words(rising), words(falling), strict=True))
    for level, layer in enumerate(problem.layers):
        terms, used = int((layer >= 0).sum()), (layer >= 0).any(axis=0)
        steps = [int(axis.weights[level][used].max() - axis.weights[level][used].min()) for axis in problem.sums]
        ours.append(terms * _term(problem.ahead(level), steps, sizes[level + 1][0]))
        theirs.append(terms * _term(problem.behind(level + 1), steps, sizes[level][1]))
    for level, (own, other) in enumerate(sizes):
        nodes = 1 if level == len(problem.layers) else len(problem.layers[level])
        shape = problem.ahead(level).shape
        cells = prod(shape) * max(1.0, own * other / 64) if _bits(shape) <= _MOST_BITS else inf
        meetings.append(nodes * (_MEETING * cells + _PAIR))
    return [sum(ours[: cut + 1]) + sum(theirs[cut + 1 :]) + meetings[cut] for cut in range(len(sizes))]


def _term(side: Side, steps: Sequence[int], size: int) -> float:
    box = [length + step for length, step in zip(side.shape, steps, strict=True)]
    cells = prod(box) if _bits(box) <= _MOST_BITS else inf
    # Several digits are split and carried.
    work = cells * size / (4 if size <= 8 else 2)
    return min(work + _CALL, work * _AT_ONCE)


def heights(layers: Layers, sums: Sequence[SumAxis]) -> tuple[list[float], list[float]]:
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


def _weights(sums: Sequence[SumAxis], level: int, value: Ints) -> Floats:
    return np.stack([axis.weights[level][value] for axis in sums], axis=1).astype(np.float64)
