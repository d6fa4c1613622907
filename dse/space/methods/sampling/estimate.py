"""How many valid rows there are, and how often each value occurs in them, estimated with an honest interval.

Rows drawn from the tilted diagram count 1 / probability if they are valid. Each batch of them is drawn in strata, and
its first halves are crossed with all second halves that start from the same node, so that a few thousand draws speak
for millions of rows (a two-sample U-statistic: Hoeffding 1948; Lee 1990). Batches are independent and unbiased; the
interval is Student's, over the means of the batches, whose number was settled by a pilot that is thrown away.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import ceil, exp, floor, log, sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dse.space.flat import FlatSpace, Floats, Ints, Linear, Rows
from dse.space.methods.mdd.diagram import DecisionDiagram, count, occurrences
from dse.space.methods.sampling.sample import (
    MOST_DRAWN_CELLS,
    floor_share,
    meets,
    rows_at_once,
    sample,
    tilted_walks,
    walk,
)
from dse.space.methods.sampling.segments import draw, halves
from dse.space.methods.sampling.tilt import EmptyError, Tilt, TooRareError, slopes, tilt
from dse.space.methods.sampling.uniform import generator
from dse.space.methods.tally import Tally

RELATIVE_HALF_WIDTH = 0.004
MOST_ESTIMATE_DRAWS = 8_000_000

_BATCH = 4096
_PILOT = 24
_BATCHES = 40
"""Batches at least: with fewer, the interval rests on too little."""
_SPARE = 1.2
"""More batches than the pilot asks for, as it may have been lucky."""
_VAGUE = 0.3
"""A relative half-width above which the mean is not near enough to normal for an interval."""
_CROSSED = 1024
_ROWS_AT_A_TIME = 256
_WIDEST = 600.0
_NORMAL = 1.959963984540054

EstimateBatch = Callable[[np.random.Generator], float]
"""A draw of an unbiased estimate, in a unit of its own."""


@dataclass(frozen=True, slots=True, eq=False)
class Shares:
    """For each variable, shape (values + 1,): the share of valid rows that take a value, and its 95 % half-width."""

    shares: tuple[Floats, ...]
    half_widths: tuple[Floats, ...]


@dataclass(frozen=True, slots=True, eq=False)
class _Halves:
    """Halves of rows: the *node* in the middle, *sums* of shape (rules, rows), logarithms of what they count."""

    node: NDArray[np.int32]
    sums: Ints
    energy: Floats

    def taken(self, places: NDArray[np.intp]) -> _Halves:
        return _Halves(self.node[places], self.sums[:, places], self.energy[places])


def estimate(
    diagram: DecisionDiagram,
    seed: int,
    relative: float = RELATIVE_HALF_WIDTH,
    most_draws: int = MOST_ESTIMATE_DRAWS,
    size: int | None = None,
) -> Tally:
    """The number of rows that meet all rules, with a 95 % interval of about *relative* to either side.

    Exact if the layers hold all rules that can be broken, or if it is proven that there is none. Otherwise as many
    rows are drawn as a pilot says *relative* needs, *most_draws* at most, when the interval may be wider, and
    fewer of a deep diagram; in batches of *size*, or smaller ones, of which there are some 60 at least.
    Raises TooRareError if too few of them are valid to state an interval.
    """
    size = size or _BATCH
    try:
        tilted = tilt(diagram)
    except EmptyError:
        return Tally(0)
    wide = not diagram.expanded and bool(diagram.flat.wides())
    if not tilted.linears and not wide:
        return Tally(count(diagram))
    depth = len(diagram.layers) + 1
    size = min(size, rows_at_once(diagram)) if wide else size
    most_draws = min(most_draws, MOST_DRAWN_CELLS // depth)
    batch, log_unit = _by_rows(diagram, tilted, size) if wide else _by_halves(diagram, tilted, size)
    pilot, main = generator(seed).spawn(2)
    first = np.array([batch(pilot) for _ in range(_PILOT)])
    mean = float(first.mean())
    scatter = float(first.std(ddof=1)) / mean if mean > 0 else 1.0
    wanted = ceil(_SPARE * (_student(_BATCHES) * scatter / relative) ** 2)
    batches = max(_BATCHES, min(wanted, most_draws // size))
    means = np.array([batch(main) for _ in range(batches)])
    mean = float(means.mean())
    half = _student(batches) * float(means.std(ddof=1)) / sqrt(batches)
    if half >= _VAGUE * mean:
        raise TooRareError
    value, low, high = (_scaled(log_unit, number) for number in (mean, mean - half, mean + half))
    # At least one is valid, or no interval could be stated, and no more than the diagram holds.
    most = count(diagram)
    inside = [min(max(end, 1), most) for end in (round(value), floor(low), ceil(high))]
    return Tally(inside[0], False, inside[1], inside[2])


def estimate_occurrences(diagram: DecisionDiagram, seed: int, number: int = 10_000) -> Shares:
    """How often each value occurs among the valid rows, from *number* uniform ones; Wilson's intervals.

    Exact, with half-widths 0, if the layers hold all rules. A half-width is the distance to the far end of the
    interval, so it is not 0 for a value that was never seen. Raises EmptyError and TooRareError like `sample`.
    """
    if diagram.expanded or not (diagram.flat.linears() or diagram.flat.wides()):
        if diagram.empty:
            raise EmptyError
        total = count(diagram)
        return exact_shares(occurrences(diagram), total)
    return estimated_shares(diagram.flat, sample(diagram, number, seed))


def estimated_shares(flat: FlatSpace, rows: Rows) -> Shares:
    """The shares of *rows* that were drawn, with Wilson's intervals."""
    shares = [times / len(rows) for times in taken(flat, rows)]
    return Shares(tuple(shares), tuple(_wilson(share, len(rows)) for share in shares))


def taken(flat: FlatSpace, rows: Rows) -> list[Ints]:
    """How many of *rows* take each value, by variable, shape (values + 1,)."""
    lengths = [len(variable.values) + 1 for variable in flat.variables]
    return [np.bincount(column % length, minlength=length) for column, length in zip(rows.T, lengths, strict=True)]


def exact_shares(times: Iterable[Sequence[int]], total: int) -> Shares:
    """Shares from how often each value is taken, by variable; one that is not 0 never becomes 0 by rounding."""
    least = np.nextafter(0.0, 1.0)
    shares = [np.array([max(float(Fraction(n, total)), least) if n else 0.0 for n in found]) for found in times]
    return Shares(tuple(shares), tuple(np.zeros_like(share) for share in shares))


def _by_halves(diagram: DecisionDiagram, tilted: Tilt, size: int) -> tuple[EstimateBatch, float]:
    """A batch of crossed halves, and the logarithm of its unit."""
    first, second = halves(diagram, tilted)
    slope = slopes(tilted)
    rules = len(tilted.linears)

    def batch(random: np.random.Generator) -> float:
        _, middle, head = draw(first, np.zeros(size, np.int32), rules, random)
        places, _, tail = draw(second, middle, rules, random)
        # Drawn in strata, the second halves are in order; crossed must be what is at random.
        mixed = random.permutation(size)
        heads = _Halves(middle, head, -(slope @ head) - anchor)
        after = _Halves(middle[places], tail, -(slope @ tail))
        return _crossed(tilted.linears, heads, after.taken(mixed)) / size

    anchor = float(tilted.multipliers @ np.array([float(cut.high) for cut in tilted.cuts]))
    return batch, tilted.log_bound


def _by_rows(diagram: DecisionDiagram, tilted: Tilt, size: int) -> tuple[EstimateBatch, float]:
    """The same for rows drawn decision by decision, as the rules that are no sums need them."""
    walks = tilted_walks(diagram, tilted)

    def batch(random: np.random.Generator) -> float:
        walked = walk(walks, random, size)
        return float(floor_share(walks, walked)[meets(walks, walked.rows)].sum()) / size

    return batch, -walks.log_floor


def _crossed(linears: tuple[Linear, ...], heads: _Halves, tails: _Halves) -> float:
    """The sum over the heads of what each counts, averaged over tails from the same node."""
    heads, tails = (half.taken(np.argsort(half.node, kind="stable")) for half in (heads, tails))
    ends = np.flatnonzero(np.append(np.diff(heads.node) != 0, True)) + 1
    total = 0.0
    for start, end in zip([0, *ends[:-1].tolist()], ends.tolist(), strict=True):
        # A group of thousands gains little from pairs that it can do without.
        for low in range(start, end, _CROSSED):
            group = np.arange(low, min(low + _CROSSED, end))
            total += _pairs(linears, heads.taken(group), tails.taken(group)) / len(group)
    return total


def _pairs(linears: tuple[Linear, ...], heads: _Halves, tails: _Halves) -> float:
    """The sum of what all pairs count that meet the rules."""
    top = float(tails.energy.max())
    spread = top - float(tails.energy.min())
    if spread > _WIDEST or float(heads.energy.max()) + top > _WIDEST + spread:
        raise TooRareError
    exact = np.dtype(np.float32 if spread < 60 else np.float64)
    tail_counts: NDArray[Any] = np.exp(tails.energy - top).astype(exact)
    head_counts = np.exp(heads.energy + top)
    total = 0.0
    for start in range(0, len(head_counts), _ROWS_AT_A_TIME):
        rows = slice(start, start + _ROWS_AT_A_TIME)
        valid = np.ones((len(head_counts[rows]), len(tail_counts)), np.bool_)
        for linear, head, tail in zip(linears, heads.sums[:, rows], tails.sums, strict=True):
            if linear.high is not None:
                valid &= _narrow(tail) <= _narrow(linear.high - head)[:, None]
            if linear.low is not None:
                valid &= _narrow(tail) >= _narrow(linear.low - head)[:, None]
        total += float(head_counts[rows] @ (valid.astype(exact) @ tail_counts))
    return total


def _narrow(sums: Ints) -> NDArray[np.int32] | Ints:
    """In 32 bits if they hold it: compared in half the time."""
    return sums.astype(np.int32) if len(sums) and int(np.abs(sums).max()) < 1 << 31 else sums


def _scaled(log_unit: float, number: float) -> Fraction:
    """exp(*log_unit*) * *number*, which may be larger than any float."""
    whole = round(log_unit / log(2))
    return Fraction(exp(log_unit - whole * log(2)) * number) * Fraction(2) ** whole


def _student(batches: int) -> float:
    """The 97.5 % quantile of Student's distribution (Abramowitz and Stegun 26.7.5), to 5 digits from 40 batches on."""
    z, freedom = _NORMAL, batches - 1
    return z + (z**3 + z) / (4 * freedom) + (5 * z**5 + 16 * z**3 + 3 * z) / (96 * freedom**2)


def _wilson(share: Floats, number: int) -> Floats:
    """Distance from *share* to the far end of Wilson's 95 % interval."""
    square = _NORMAL**2 / number
    centre = (share + square / 2) / (1 + square)
    reach = _NORMAL / (1 + square) * np.sqrt(share * (1 - share) / number + square / (4 * number))
    found: Floats = reach + np.abs(centre - share)
    return found
