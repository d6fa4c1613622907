"""How many valid rows there are, and how often each value occurs in them, estimated with an honest interval.

Rows drawn from the tilted diagram count 1 / probability if they are valid. Batches of them are independent and
unbiased; the interval is Student's, over the means of the batches, whose number was settled by a pilot that is thrown
away.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import ceil, exp, floor, log, sqrt

import numpy as np

from dse.space.flat import FlatSpace, Floats, Ints, Rows
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
from dse.space.methods.sampling.tilt import EmptyError, TooRareError, tilt
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
_NORMAL = 1.959963984540054


@dataclass(frozen=True, slots=True, eq=False)
class Shares:
    """For each variable, shape (values + 1,): the share of valid rows that take a value, and its 95 % half-width."""

    shares: tuple[Floats, ...]
    half_widths: tuple[Floats, ...]


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
    size = min(size, rows_at_once(diagram))
    most_draws = min(most_draws, MOST_DRAWN_CELLS // depth)
    walks = tilted_walks(diagram, tilted)

    def batch(random: np.random.Generator) -> float:
        walked = walk(walks, random, size)
        return float(floor_share(walks, walked)[meets(walks, walked.rows)].sum()) / size

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
    value, low, high = (_scaled(-walks.log_floor, number) for number in (mean, mean - half, mean + half))
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
