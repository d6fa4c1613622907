"""A tilted diagram in few steps: several layers at once, with what they add to the sums, drawn in strata.

A segment lists, for each node it starts from, every node and sums it can lead to, with the number of ways. To draw
from it is one step where the layers would need many. Rows that stand at a node are spread evenly over what can
follow, in random order, so no segment alone contributes to the error of a mean (Latin hypercube sampling: McKay,
Beckman and Conover 1979).

Example of what halves are for: four first halves with the sums 0, 1, 2, 3 and four second halves with the same; the
whole sum must be at most 3. Crossed they make 16 rows, of which 10 are valid: eight half draws tell as much as
sixteen rows do.

Cost: at most 50,000 entries for each segment. An estimate by halves takes a third to a sixth of the time of one by
rows on 54 decisions, and its interval is narrower (docs/decisions/0007-design-space-engine.md).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import log

import numpy as np
from numpy.typing import NDArray

from dse.space.flat import Floats, Ints
from dse.space.methods.listing.bounds import stacked
from dse.space.methods.mdd.diagram import DecisionDiagram
from dse.space.methods.mdd.distinct import distinct
from dse.space.methods.sampling.tilt import Masses, Tilt, slopes

MOST_ENTRIES = 50_000


@dataclass(frozen=True, slots=True, eq=False)
class DiagramSegment:
    """Where a run of layers can lead, entries in order of the node they start from.

    *cumulative*, shape (entries,), ascends: the number of the node plus the probability, from that node, of this
    entry and those before it. *below* is the node after the run, *sums*, shape (sums, entries), what it adds.
    """

    cumulative: Floats
    below: NDArray[np.int32]
    sums: Ints


Segments = tuple[DiagramSegment, ...]


@dataclass(frozen=True, slots=True, eq=False)
class _Paths:
    """Ways through some layers: from a node of the first to a node after the last, with sums, *ways* many."""

    source: NDArray[np.int64]
    node: NDArray[np.int32]
    sums: Ints
    ways: Floats


def halves(diagram: DecisionDiagram, tilted: Tilt, most_entries: int = MOST_ENTRIES) -> tuple[Segments, Segments]:
    """The layers up to a narrow place near the middle, and those from there on."""
    depth = len(diagram.layers)
    middle = range(depth * 2 // 5, depth * 3 // 5 + 1)
    half = min(middle, key=lambda k: (len(tilted.masses[k].mantissa), abs(2 * k - depth)))
    return _segments(diagram, tilted, (0, half), most_entries), _segments(diagram, tilted, (half, depth), most_entries)


def draw(
    parts: Segments, node: NDArray[np.int32], rules: int, random: np.random.Generator
) -> tuple[NDArray[np.intp], NDArray[np.int32], Ints]:
    """Continue rows that stand at *node*, shape (rows,), through the segments, each distributed as the tilt has it.

    Returns where each row stood in *node*, as the rows change places; the node each is led to; and the sums on the
    way, shape (rules, rows).
    """
    number = len(node)
    places = np.arange(number)
    sums = np.zeros((rules, number), np.int64)
    for part in parts:
        shuffled = random.permutation(number)
        order = shuffled[np.argsort(node[shuffled], kind="stable")]
        start = node[order]
        ends = np.flatnonzero(np.append(np.diff(start) != 0, True)) + 1
        sizes = np.diff(ends, prepend=0)
        strata = np.arange(number) - np.repeat(ends - sizes, sizes) + random.random(number)
        wanted = start + strata / np.repeat(sizes, sizes)
        entry = np.minimum(np.searchsorted(part.cumulative, wanted, side="right"), len(part.below) - 1)
        node = part.below[entry]
        places, sums = places[order], sums[:, order] + part.sums[:, entry]
    return places, node, sums


def _segments(diagram: DecisionDiagram, tilted: Tilt, run: tuple[int, int], most_entries: int) -> Segments:
    """A run of layers in segments of at most *most_entries*, or of one layer where that is not enough."""
    depth, end = run
    weights = stacked(diagram, [linear.weights for linear in tilted.linears])
    found: list[DiagramSegment] = []
    while depth < end:
        paths = _longest(diagram.layers[depth:end], weights[depth:end], most_entries)
        best = _best_end(paths)
        after = depth + best + 1
        found.append(_segment(paths[best], tilted, tilted.masses[depth], tilted.masses[after]))
        depth = after
    return tuple(found)


def _longest(layers: Sequence[NDArray[np.int32]], weights: Sequence[Ints], most_entries: int) -> list[_Paths]:
    """Paths through the first layer, the first two and so on, while they are no more than allowed."""
    start = np.arange(len(layers[0]))
    paths = _Paths(
        start, start.astype(np.int32), np.zeros((len(weights[0]), len(start)), np.int64), np.ones(len(start))
    )
    found: list[_Paths] = []
    for layer, weight in zip(layers, weights, strict=True):
        if found and len(paths.node) * layer.shape[1] > 8 * most_entries:
            break
        children = layer[paths.node]
        entry, value = np.nonzero(children >= 0)
        sums = paths.sums[:, entry] + weight[:, value]
        paths = _merged(_Paths(paths.source[entry], children[entry, value], sums, paths.ways[entry]))
        if found and len(paths.node) > most_entries:
            break
        found.append(paths)
    return found


def _merged(paths: _Paths) -> _Paths:
    """Paths that start, end and add alike as one, sorted by where they start."""
    first, classes = distinct([paths.source, paths.node.astype(np.int64), *paths.sums], len(paths.node))
    ways: Floats = np.bincount(classes, paths.ways).astype(np.float64)
    return _Paths(paths.source[first], paths.node[first], paths.sums[:, first], ways)


def _best_end(paths: Sequence[_Paths]) -> int:
    """Where to end a segment: in the second half of what is possible, where there are fewest nodes to go on from."""
    ends = range(len(paths) // 2, len(paths))
    return min(ends, key=lambda end: (int(paths[end].node.max()), -end))


def _segment(paths: _Paths, tilted: Tilt, above: Masses, below: Masses) -> DiagramSegment:
    energy = np.log(paths.ways) + slopes(tilted) @ paths.sums.astype(np.float64)
    energy += _logs(below)[paths.node] - _logs(above)[paths.source]
    chance = np.exp(energy)
    starts = np.searchsorted(paths.source, np.arange(len(above.mantissa) + 1))
    cumulative = np.empty(len(chance))
    for node, (start, end) in enumerate(pairwise(starts.tolist())):
        own = np.cumsum(chance[start:end])
        cumulative[start:end] = node + own / own[-1]
    return DiagramSegment(cumulative, paths.node, paths.sums)


def _logs(masses: Masses) -> Floats:
    logs: Floats = np.log(masses.mantissa) + masses.exponent * log(2)
    return logs
