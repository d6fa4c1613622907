"""The Lagrangian bound of a sum under cuts, over the paths of a diagram, and the multipliers that give it.

The bound is a concave function of the multipliers; every path gives a plane above it, and the best multipliers under
the planes known so far give the next path (Kelley, The cutting-plane method, 1960). A plane is the sums of a path:
it stays true when bounds change or other sums are made least, and later questions start from what earlier ones found.
The planes are met in floating point; the multipliers are then rounded, and what they prove is worked out in integers.
A beam along the bound finds good rows quickly, without a proof.

Example: paths of cost and mass (1, 6), (2, 4) and (5, 1); least cost with mass <= 3.

    multiplier u gives the bound min(1 + 3 u, 2 + u, 5 - 2 u), as mass - 3 is 3, 1 and -2
    u = 1 is best: no row within the bound costs less than 3. The true least cost is 5

Cost: at most 60 paths, each one pass over the diagram, and a linear program of as many rows.
Measured: docs/decisions/0007-design-space-engine.md.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from dse.space.flat import ABSENT, Floats, Ints, Rows
from dse.space.methods.listing.bounds import least, stacked
from dse.space.methods.mdd.diagram import DecisionDiagram

_PATHS = 60
"""Paths looked for in one question at most;"""

_KEPT = 400
"""of all that were found, the last so many are kept."""

_SMALL = 1 << 22
"""How large rounded sums are allowed to become for the sake of precision."""

_SAFE = 1 << 61
_FAR = np.iinfo(np.int64).max // 4

_HARDEST = 1e3
"""Multipliers in units of the ranges of what is made least and of the cut: beyond, a cut is out of reach."""


@dataclass(frozen=True, slots=True, eq=False)
class Relaxed:
    """No path within the cuts has a sum below *low*; *unit* times the sum plus *multipliers* times the cuts proves it.

    Multipliers are whole and at least 0, one for each cut.
    """

    low: int
    unit: int
    multipliers: tuple[int, ...]


class Relaxation:
    """Paths of a diagram that is not empty, by their sums; answers do depend on which questions were asked before."""

    def __init__(self, diagram: DecisionDiagram, sums: Sequence[Mapping[int, Ints]]) -> None:
        self.diagram = diagram
        self.weights = stacked(diagram, sums)
        self._reach = np.array([sum(int(np.abs(part).max()) for part in weights.values()) for weights in sums], object)
        self._paths: list[tuple[int, ...]] = []
        for place in range(len(sums)):
            toward = [int(place == other) for other in range(len(sums))]
            self._paths.append(self._least(toward))
            self._paths.append(self._least([-factor for factor in toward]))

    def ends(self, place: int) -> tuple[int, int]:
        """Least and greatest of a sum over all paths."""
        return self._paths[2 * place][place], self._paths[2 * place + 1][place]

    def bound(self, factors: Sequence[int], highs: Sequence[int | None]) -> Relaxed:
        """The bound on the sum of *factors* times the sums, where each sum is at most its *highs*; None is no bound."""
        cuts = [place for place, high in enumerate(highs) if high is not None]
        limits = np.array([highs[place] for place in cuts], np.float64)
        ends = np.array([self.ends(place) for place in cuts], np.float64).reshape(len(cuts), 2)
        spreads = np.maximum(ends[:, 1] - ends[:, 0], 1.0)
        ranges = sum(abs(factor) * (self.ends(p)[1] - self.ends(p)[0]) for p, factor in enumerate(factors)) or 1
        most = sum(max(factor * end for end in self.ends(p)) for p, factor in enumerate(factors))
        found = self._proof(factors, highs, [0.0] * len(highs))
        for _ in range(_PATHS if cuts else 0):
            ceiling, free = _highest(np.array(self._paths, np.float64), factors, cuts, limits, spreads, float(ranges))
            multipliers = [0.0] * len(highs)
            for place, multiplier in zip(cuts, free, strict=True):
                multipliers[place] = float(multiplier)
            made = self._proof(factors, highs, multipliers)
            gained = made.low - found.low
            if gained > 0 or (made.low == found.low and any(made.multipliers) and not any(found.multipliers)):
                found = made
            # A whole number above the ceiling cannot be proven.
            if found.low > most or found.low >= ceiling - 1e-3 or self._paths[-1] in self._paths[:-1]:
                break
        self._paths = [*self._paths[: 2 * len(highs)], *dict.fromkeys(self._paths[2 * len(highs) :][-_KEPT:])]
        return found

    @cached_property
    def remaining(self) -> list[Ints]:
        """The least of each sum over the completions of each node: per layer, the end included, shape (sums, nodes)."""
        return least(self.diagram, self.weights, len(self._reach))

    def _proof(self, factors: Sequence[int], highs: Sequence[int | None], multipliers: Sequence[float]) -> Relaxed:
        """What rounded multipliers prove; the path that limits it is remembered."""
        size = sum(
            (abs(factor) + multiplier) * float(reach)
            for factor, multiplier, reach in zip(factors, multipliers, self._reach, strict=True)
        )
        unit = max(round(_SMALL / max(size, 1.0)), 1)
        whole = tuple(round(multiplier * unit) for multiplier in multipliers)
        toward = [unit * factor + multiplier for factor, multiplier in zip(factors, whole, strict=True)]
        if sum(abs(factor) * reach for factor, reach in zip(toward, self._reach, strict=True)) >= _SAFE:
            whole = (0,) * len(whole)
            toward, unit = list(factors), 1
        path = self._least(toward)
        self._paths.append(path)
        total = sum(factor * amount for factor, amount in zip(toward, path, strict=True))
        total -= sum(m * high for m, high in zip(whole, highs, strict=True) if high is not None)
        return Relaxed(-(-total // unit), unit, whole)

    def _least(self, factors: Sequence[int]) -> tuple[int, ...]:
        """The sums of the path where *factors* times them is least."""
        toward = np.array(factors, np.int64)
        reached = np.zeros(1, np.int64)
        choices = []
        for layer, weights in zip(reversed(self.diagram.layers), reversed(self.weights), strict=True):
            # The child -1 finds what is out of reach at the end.
            through = np.append(reached, _FAR)[layer] + toward @ weights
            choice = through.argmin(axis=1)
            choices.append(choice)
            reached = through[np.arange(len(layer)), choice]
        total = np.zeros(len(toward), np.int64)
        node = 0
        for layer, weights, choice in zip(self.diagram.layers, self.weights, reversed(choices), strict=True):
            value = choice[node]
            total += weights[:, value]
            node = layer[node, value]
        return tuple(total.tolist())


def _highest(
    paths: Floats, factors: Sequence[int], cuts: Sequence[int], limits: Floats, spreads: Floats, ranges: float
) -> tuple[float, Floats]:
    """The highest point below the planes of all paths: its height, and the multipliers of the cuts there."""
    from scipy.optimize import linprog

    excess = (paths[:, cuts] - limits) / spreads
    heights = paths @ np.array(factors, np.float64) / ranges
    planes = np.hstack((np.ones((len(paths), 1)), -excess))
    sides = [(None, None)] + [(0.0, _HARDEST)] * len(cuts)
    aim = np.zeros(len(cuts) + 1)
    aim[0] = -1.0
    solved = linprog(aim, A_ub=planes, b_ub=heights, bounds=sides, method="highs")
    if solved.status != 0 or solved.x is None:
        return float("inf"), np.zeros(len(cuts))
    return float(solved.x[0]) * ranges, solved.x[1:] * ranges / spreads


BEAM_WIDTH = 256
"""Partial rows that are followed."""


def beam(relaxation: Relaxation, factors: Sequence[int], highs: Sequence[int | None], width: int = BEAM_WIDTH) -> Rows:
    """At most *width* rows of small *factors* times the sums, each sum at most its *highs*; shape (rows, variables).

    A partial row counts what its best completion comes to. There may be better rows, and rows although none is found.
    Of the rules only those in the layers are looked at.
    """
    diagram = relaxation.diagram
    toward = np.array(factors, np.int64)
    bounded = [place for place, high in enumerate(highs) if high is not None]
    limits = np.array([high for high in highs if high is not None], np.int64)[:, None]
    remaining = [part[bounded] for part in relaxation.remaining]
    ahead = least(diagram, [(toward @ weights)[None, :] for weights in relaxation.weights], 1)
    nodes = np.zeros(1, np.int32)
    totals = np.zeros((len(bounded), 1), np.int64)
    scores = np.zeros(1, np.int64)
    trail: list[tuple[Ints, Ints]] = []
    for depth, (layer, weights) in enumerate(zip(diagram.layers, relaxation.weights, strict=True)):
        parents, values = np.nonzero(layer[nodes] >= 0)
        children = layer[nodes[parents], values]
        grown = totals[:, parents] + weights[bounded][:, values]
        keep = np.flatnonzero((grown + remaining[depth + 1][:, children] <= limits).all(axis=0))
        gained = scores[parents[keep]] + (toward @ weights)[values[keep]]
        order = np.argsort(gained + ahead[depth + 1][0, children[keep]], kind="stable")[:width]
        keep = keep[order]
        nodes, totals, scores = children[keep], grown[:, keep], gained[order]
        trail.append((parents[keep], values[keep]))
    columns = np.empty((len(diagram.order), len(nodes)), np.int16)
    places = np.arange(len(nodes))
    for depth in range(len(trail) - 1, -1, -1):
        parents, values = trail[depth]
        column = values[places]
        columns[diagram.order[depth]] = np.where(column == diagram.layers[depth].shape[1] - 1, ABSENT, column)
        places = parents[places]
    return np.ascontiguousarray(columns.T)
