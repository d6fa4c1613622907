"""A diagram with the sum rules and the `Wide` rules inside its layers: then every question is a walk over paths.

A state is a node of the given diagram, the partial sums, and the folds so far. What cannot be met any more is cut
off, what can no longer fail is forgotten, and sums that behave alike are one; the reduction merges the rest.

Example: x in {1, 2, 4}, y in {0, 3}, x + y <= 4. After x the partial sums are 1, 2 and 4. With 1 both values of y
fit; with 2 and with 4 only y = 0 does. So 2 and 4 behave alike: layer y has two nodes, and there are 2 + 1 + 1 paths.

Cost: as for the diagram, but states multiply with each sum: one sum over 54 decisions takes more than the 150,000
nodes allowed in everyday use, two more than 10 million. The grids count those (`dse.space.methods.grid.exact`), and
samples are estimates. Measured: docs/decisions/0007-design-space-engine.md.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dse.space.flat import Bools, Ints, Wide
from dse.space.methods.mdd.diagram import MOST_DIAGRAM_NODES, DecisionDiagram, reduced
from dse.space.methods.mdd.folds import Rest, added, contributions, interval, is_bounded, judged, rests
from dse.space.methods.mdd.growth import Growth
from dse.space.methods.mdd.thresholds import Bounded, bounded, settled


def expand(diagram: DecisionDiagram, most_nodes: int = MOST_DIAGRAM_NODES) -> DecisionDiagram:
    """Exactly the rows that meet all rules, in the same order; TooWideError beyond *most_nodes* before reduction."""
    flat = diagram.flat
    if diagram.expanded or diagram.empty or not (flat.linears() or flat.wides()):
        return replace(diagram, expanded=True)
    sums = [bounded(diagram, linear) for linear in flat.linears()]
    sums = [rule for rule in sums if rule.low is not None or rule.high is not None]
    wides = [_watched(diagram, wide) for wide in flat.wides()]
    states = np.zeros((1, 1), np.int64)
    start = [np.zeros(1, np.int64) for _ in sums] + [column for watched in wides for column in _start(watched)]
    after, kept = _settled(sums, wides, 0, states[0], start, -1)
    states = np.array([states[0], *after])[:, kept]
    growth = Growth(most_nodes)
    for depth, layer in enumerate(diagram.layers):
        if not states.shape[1]:
            break
        states = growth.grow(states, layer.shape[1], partial(_successors, diagram, sums, wides, depth))
    layers = growth.layers if states.shape[1] else None
    return reduced(flat, diagram.order, layers, expanded=True)


@dataclass(slots=True)
class _Numbers:
    """Integers of any size as small ones: states are rows of machine words."""

    values: list[int] = field(default_factory=list)
    number_of: dict[int, int] = field(default_factory=dict)

    def number(self, values: NDArray[Any]) -> Ints:
        found = np.empty(len(values), np.int64)
        for place, value in enumerate(values.tolist()):
            found[place] = number = self.number_of.setdefault(value, len(self.values))
            if number == len(self.values):
                self.values.append(value)
        return found

    def value(self, numbers: Ints) -> NDArray[Any]:
        found = np.empty(len(numbers), object)
        found[:] = [self.values[number] for number in numbers.tolist()]
        return found


@dataclass(frozen=True, slots=True, eq=False)
class _Watched:
    """A rule over folds: *last* is the layer that decides it at the latest; *numbers* where 64 bits may not do."""

    wide: Wide
    last: int
    rests: list[list[Rest]]
    numbers: _Numbers | None


def _watched(diagram: DecisionDiagram, wide: Wide) -> _Watched:
    depth_of = {variable: depth for depth, variable in enumerate(diagram.order)}
    last = max((depth_of[variable] for fold in wide.folds for variable in fold.values), default=-1)
    if is_bounded(wide):
        return _Watched(wide, last, [rests(diagram, fold) for fold in wide.folds], None)
    return _Watched(wide, last, [], _Numbers())


def _start(watched: _Watched) -> list[Ints]:
    """One column that says whether the rule holds already, then its folds."""
    columns = [np.zeros(1, np.int64)]
    for fold in watched.wide.folds:
        if watched.numbers is None:
            columns.append(np.full(1, fold.start, np.int64))
        else:
            columns.append(watched.numbers.number(np.array([fold.start], object)))
    return columns


def _successors(
    diagram: DecisionDiagram, sums: Sequence[Bounded], wides: Sequence[_Watched], depth: int, states: Ints
) -> tuple[Ints, list[Ints]]:
    layer, variable = diagram.layers[depth], diagram.order[depth]
    children = layer[states[0]]
    pairs = np.flatnonzero(children >= 0)
    source, value = np.divmod(pairs, layer.shape[1])
    nodes = children.ravel()[pairs].astype(np.int64)
    columns = [column[source] for column in states[1:]]
    for place, rule in enumerate(sums):
        weights = rule.weights.get(variable)
        if weights is not None:
            columns[place] = columns[place] + weights[value]
    place = len(sums)
    for watched in wides:
        for fold in watched.wide.folds:
            place += 1
            if variable not in fold.values:
                continue
            values = contributions(fold, variable, layer.shape[1])
            if watched.numbers is None:
                columns[place] = added(fold.gather, columns[place], values[value])
            else:
                folded = watched.numbers.value(columns[place])
                columns[place] = watched.numbers.number(added(fold.gather, folded, values.astype(object)[value]))
        place += 1
    after, kept = _settled(sums, wides, depth + 1, nodes, columns, depth)
    alive = np.flatnonzero(kept)
    return pairs[alive], [nodes[alive], *(column[alive] for column in after)]


def _settled(
    sums: Sequence[Bounded], wides: Sequence[_Watched], layer: int, nodes: Ints, columns: Sequence[Ints], read: int
) -> tuple[list[Ints], Bools]:
    """The columns without what no longer matters at *nodes* of *layer*, and which states can still meet the rules.

    *read* is the last layer whose variable is in the columns.
    """
    kept = np.ones(len(nodes), np.bool_)
    after: list[Ints] = []
    for rule, column in zip(sums, columns, strict=False):
        alike, possible = settled(rule, layer, column, nodes)
        kept &= possible
        after.append(alike)
    place = len(sums)
    for watched in wides:
        size = 1 + len(watched.wide.folds)
        sure, *folds = columns[place : place + size]
        place += size
        holds = sure > 0
        may_hold, may_fail = _judged(watched, layer, nodes, folds, holds | ~kept, read)
        kept &= holds | may_hold
        holds = holds | ~may_fail
        after.append(holds.astype(np.int64))
        after += [np.where(holds, 0, column) for column in folds]
    return after, kept


def _judged(
    watched: _Watched, layer: int, nodes: Ints, folds: Sequence[Ints], skip: Bools, read: int
) -> tuple[Bools, Bools]:
    """May hold, may fail; both for states that *skip* leaves out."""
    may_hold = np.ones(len(nodes), np.bool_)
    may_fail = np.ones(len(nodes), np.bool_)
    open_ = np.flatnonzero(~skip)
    if read < watched.last and watched.numbers is not None:
        return may_hold, may_fail
    if not len(open_):
        return may_hold, may_fail
    parts = [column[open_] for column in folds]
    if read >= watched.last:
        # Everything is folded: the exact judge decides, once for each outcome.
        exact = parts if watched.numbers is None else [watched.numbers.value(part) for part in parts]
        verdict = judged(watched.wide, exact) if exact else np.full(len(open_), watched.wide.judge.holds(()))
        may_hold[open_], may_fail[open_] = verdict, ~verdict
        return may_hold, may_fail
    ends = [
        interval(fold.gather, part, rest[layer], nodes[open_])
        for fold, part, rest in zip(watched.wide.folds, parts, watched.rests, strict=True)
    ]
    may_hold[open_], may_fail[open_] = watched.wide.judge.bounds([low for low, _ in ends], [high for _, high in ends])
    return may_hold, may_fail
