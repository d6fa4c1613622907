"""The rows of least sum under bounds, again and again: what depends on the diagram alone is prepared once.

The Lagrangian bound says what no row can be below, and its multipliers make the surrogate cut that the complete search
prunes by. A beam finds a row that is at least good. Between the two the bound of the objective is let out until enough
rows are within; inside a walk it follows the last row that is good enough.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from dse.errors import fail
from dse.space.flat import Ints, Linear, Rows, Wide
from dse.space.methods.listing.blocks import RowListing
from dse.space.methods.listing.bounds import Cut, cuts_of, divisor, fits, surrogates, tightest
from dse.space.methods.listing.recheck import recheck
from dse.space.methods.listing.walk import Rounds
from dse.space.methods.mdd.diagram import DecisionDiagram, extremes
from dse.space.methods.optimum.relaxation import Relaxation, Relaxed, beam

_STEPS = 8
"""The first bound tried lets in one part in so many of the gap between what is proven and what was found,"""

_FINE = 512
"""or of what the objective can range over, if nothing was found;"""

_WIDER = 2
"""the next so many times as much."""

SumWeights = Mapping[int, Ints]


@dataclass(frozen=True, slots=True, eq=False)
class RankedRows:
    """Rows, shape (rows, variables), best first, and the objective of each; whole numbers if it is linear."""

    rows: Rows
    values: tuple[int, ...] | tuple[Fraction, ...]


class Optimizer:
    """Finds rows of a diagram for objectives put together of *objectives*, within bounds on these.

    Weights are as in `Linear`. `best` spends *rounds*. Raises DseError if weights are too large for whole numbers of
    64 bits.
    """

    def __init__(
        self, diagram: DecisionDiagram, objectives: Sequence[SumWeights], rounds: Rounds | None = None
    ) -> None:
        _insist_on_room(objectives)
        self.diagram = diagram
        self.objectives = objectives
        self._rounds = rounds
        outside = () if diagram.expanded else diagram.flat.linears()
        self._cuts = tightest(cuts_of([linear for linear in outside if fits(linear)]))
        self._recheck = recheck(diagram.flat)
        self._relaxation: Relaxation | None = None
        if not diagram.empty:
            self._relaxation = Relaxation(diagram, [*objectives, *(cut.weights for cut in self._cuts)])

    def ends(self, objective: int) -> tuple[int, int]:
        """Least and greatest of an objective over all paths; the diagram must not be empty."""
        assert self._relaxation is not None  # noqa: S101 - told above
        return self._relaxation.ends(objective)

    def best(
        self,
        factors: Sequence[int],
        number: int,
        highs: Sequence[int | None] | None = None,
    ) -> RankedRows:
        """The *number* valid rows of least *factors* times the objectives, or all if there are fewer.

        Each objective is at most its *highs*, None for no bound. Of equal rows those come first that the list has
        first. Raises TooMuchError when the rounds are spent.
        """
        rows, values = _nothing(self.diagram)
        if self._relaxation is None or number < 1:
            return RankedRows(rows, ())
        if self._rounds is not None:
            self._rounds.spend()
        total = combined(self.objectives, factors)
        _insist_on_room([total])
        unit = divisor(total)
        aim = {variable: weights // unit for variable, weights in total.items()}
        limits = self._limits(highs)
        toward = [*factors, *[0] * len(self._cuts)]
        relaxed = self._relaxation.bound(toward, limits)
        low, top = -(-relaxed.low // unit), int(extremes(self.diagram, aim)[1][0][0])
        if highs is not None:
            top = min(top, self._allowed(factors, limits) // unit)
        good = self._beam(relaxed, toward, limits)
        known = np.sort(sums(aim, good[self._recheck.valid(good)]))
        cap = int(known[number - 1]) if len(known) >= number else top
        step = max((cap - low) // _STEPS if cap < top else (top - low) // _FINE, 1)
        bound = cap if cap <= low else min(low + step, cap)
        proofs = [relaxed] if cap < top else [relaxed, *(proof for _, proof in self._refutations(limits))]
        cuts = self._pruning(Cut(aim, bound), limits, relaxed.unit * unit, proofs)
        while low <= top and cuts:
            found, reached, complete = self._within(_moved(cuts, bound), number, low)
            if not complete:
                # Enough are this good. Of those that are better, and may be left out here, all are found again.
                last = reached == reached[-1]
                rows, values, bound = found[last], reached[last], int(reached[-1]) - 1
                continue
            rows, values = np.concatenate((found, rows))[:number], np.concatenate((reached, values))[:number]
            if len(rows) == number or bound >= top:
                break
            rows, values = _nothing(self.diagram)
            step *= _WIDER
            bound = min(bound + step, cap) if bound < cap else top
        return RankedRows(rows, tuple(unit * value for value in values.tolist()))

    def listing(
        self, highs: Sequence[int | None] | None, wides: Sequence[Wide] = (), rounds: Rounds | None = None
    ) -> RowListing | None:
        """The valid rows within bounds on the objectives and *wides*; None if the Lagrangian bounds refute them."""
        if self._relaxation is None:
            return None
        limits = self._limits(highs)
        proofs = [proof for _, proof in self._refutations(limits)]
        cuts = self._pruning(Cut({}, 0), limits, 1, [Relaxed(0, 1, (0,) * len(limits)), *proofs])
        return RowListing(self.diagram, cuts, wides, rounds=rounds) if cuts else None

    def least(self, objective: int, highs: Sequence[int | None]) -> int:
        """A value that no valid row within the bounds is below in one objective; the diagram must not be empty."""
        assert self._relaxation is not None  # noqa: S101 - told above
        limits = self._limits(highs)
        return self._relaxation.bound([int(place == objective) for place in range(len(limits))], limits).low

    def some(self, factors: Sequence[int], highs: Sequence[int | None]) -> Rows:
        """Some valid rows within the bounds that are good by *factors* times the objectives; perhaps none."""
        if self._relaxation is None:
            return _nothing(self.diagram)[0]
        limits = self._limits(highs)
        toward = [*factors, *[0] * len(self._cuts)]
        rows = self._beam(self._relaxation.bound(toward, limits), toward, limits)
        return rows[self._recheck.valid(rows)]

    def _beam(self, relaxed: Relaxed, factors: Sequence[int], limits: Sequence[int | None]) -> Rows:
        assert self._relaxation is not None  # noqa: S101 - there are paths
        toward = [relaxed.unit * factor + more for factor, more in zip(factors, relaxed.multipliers, strict=True)]
        return beam(self._relaxation, toward, limits)

    def _limits(self, highs: Sequence[int | None] | None) -> list[int | None]:
        """The bounds on the objectives and all cuts; what no path can exceed, or reach, needs no more digits."""
        assert self._relaxation is not None  # noqa: S101 - there are paths
        limits = [*(highs or [None] * len(self.objectives)), *(cut.high for cut in self._cuts)]
        ends = map(self._relaxation.ends, range(len(limits)))
        return [None if h is None else max(low - 1, min(h, high)) for h, (low, high) in zip(limits, ends, strict=True)]

    def _allowed(self, factors: Sequence[int], limits: Sequence[int | None]) -> int:
        """What *factors* times the objectives can be at most, from the bounds on these alone."""
        total = 0
        for place, factor in enumerate(factors):
            low, high = self.ends(place)
            limit = limits[place]
            total += max(factor * low, factor * (high if limit is None else limit))
        return total

    def _refutations(self, limits: Sequence[int | None]) -> list[tuple[list[int], Relaxed]]:
        """For each bound what the bounds on the others leave of it: where these are hard to meet, this tells."""
        assert self._relaxation is not None  # noqa: S101 - there are paths
        places = [place for place, high in enumerate(limits) if high is not None]
        toward = [[int(place == other) for other in range(len(limits))] for place in places]
        return [(factors, self._relaxation.bound(factors, limits)) for factors in toward]

    def _pruning(self, aim: Cut, limits: Sequence[int | None], unit: int, proofs: Sequence[Relaxed]) -> list[Cut]:
        """The aim, all bounds, and what follows from them together by the *proofs*; empty if nothing meets them.

        The first proof is that of the aim times *unit*, the others are those of each of the bounds in turn.
        """
        weights = [*self.objectives, *(cut.weights for cut in self._cuts)]
        bounded = [place for place, high in enumerate(limits) if high is not None]
        cuts = [aim, *(Cut(weights[place], high) for place, high in enumerate(limits) if high is not None)]
        # Near the best the one proof does; where nothing is known the search needs all there is.
        made = surrogates(self.diagram.flat, cuts) if len(proofs) > 1 else []
        for target, proof in enumerate(proofs):
            if target and proof.low > cuts[target].high:
                return []
            multipliers = {number: proof.multipliers[place] for number, place in enumerate(bounded, 1)}
            multipliers[target] = multipliers.get(target, 0) + (proof.unit if target else unit)
            multipliers = {number: multiplier for number, multiplier in multipliers.items() if multiplier}
            if len(multipliers) > 1:
                common = combined([cuts[number].weights for number in multipliers], list(multipliers.values()))
                high = sum(multiplier * cuts[number].high for number, multiplier in multipliers.items())
                made.append(Cut(common, high, multipliers))
        return [*cuts, *made]

    def _within(self, cuts: Sequence[Cut], number: int, low: int) -> tuple[Rows, Ints, bool]:
        """Of the rows within the cuts the *number* of least sum of the first, by it and then in the order of the list.

        No valid row is below *low*. The last is false if *number* rows were found so much better than the bound that
        a walk with another bound should go on from there.
        """
        listing = RowListing(self.diagram, cuts, movable=1, rounds=self._rounds)
        rows, values = _nothing(self.diagram)
        aim, bound = cuts[0].weights, cuts[0].high
        for block in listing:
            reached = sums(aim, block)
            # What was listed before the bound was lowered last may be beyond it.
            good = reached <= bound
            rows, values = np.concatenate((rows, block[good])), np.concatenate((values, reached[good]))
            order = np.argsort(values, kind="stable")[:number]
            rows, values = rows[order], values[order]
            if len(values) < number or values[-1] > bound:
                continue
            if values[-1] <= low:
                break
            if 2 * (int(values[-1]) - low) < cuts[0].high - low:
                return rows, values, False
            listing.walk.tighten(0, bound - int(values[-1]) + 1)
            bound = int(values[-1]) - 1
        return rows, values, True


def best(
    diagram: DecisionDiagram,
    weights: SumWeights,
    number: int,
    *,
    largest: bool = False,
    rounds: Rounds | None = None,
) -> RankedRows:
    """The *number* valid rows of least (or largest) sum of weights[variable][value], or all if there are fewer.

    Weights are as in `Linear`. Raises DseError if they are too large for whole numbers of 64 bits, TooMuchError when
    *rounds* are spent.
    """
    sign = -1 if largest else 1
    aim = {variable: sign * values for variable, values in weights.items()}
    found = Optimizer(diagram, [aim], rounds).best([1], number)
    return RankedRows(found.rows, tuple(sign * int(value) for value in found.values))


def sums(weights: SumWeights, rows: Rows) -> Ints:
    """The sum of weights[variable][value] of each row, shape (rows,)."""
    total = np.zeros(len(rows), np.int64)
    for variable, values in weights.items():
        total += values[rows[:, variable]]
    return total


def combined(objectives: Sequence[SumWeights], factors: Sequence[int]) -> dict[int, Ints]:
    """The weights of *factors* times the objectives."""
    total: dict[int, Ints] = {}
    for objective, factor in zip(objectives, factors, strict=True):
        for variable, weights in objective.items() if factor else ():
            total[variable] = total.get(variable, np.zeros_like(weights)) + factor * weights
    return total


def _moved(cuts: Sequence[Cut], bound: int) -> list[Cut]:
    """With another bound on the first of *cuts*, and on those made with it."""
    more = bound - cuts[0].high
    return [
        Cut(
            cut.weights,
            cut.high + more * (cut.multipliers.get(0, 0) if cut.multipliers else int(place == 0)),
            cut.multipliers,
        )
        for place, cut in enumerate(cuts)
    ]


def _insist_on_room(objectives: Sequence[SumWeights]) -> None:
    if not all(fits(Linear(weights, None, None)) for weights in objectives):
        raise fail("the numbers of the objective have too many digits", hint="round the properties it is made of")


def _nothing(diagram: DecisionDiagram) -> tuple[Rows, Ints]:
    return np.zeros((0, len(diagram.order)), np.int16), np.zeros(0, np.int64)
