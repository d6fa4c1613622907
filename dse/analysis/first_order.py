"""How much of a metric's variance each factor explains by itself, from whatever runs there are.

First-order Sobol' indices from given data (Plischke, Borgonovo, Smith 2013): the variance of the means of bins, by the
adjusted coefficient of determination (Ezekiel 1930), so that chance among bins is no share.

A point of the variables that several configurations were run at is one observation, the mean of these runs: it says
no more of a variable than one run would, but for what configurations do.

    16 points at 5 configurations that make no difference: 16 observations, not 80
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from dse.analysis.bins import binned
from dse.analysis.cells import effective
from dse.analysis.data import Floats, Rows, StudyData, distinct
from dse.analysis.memoize import memoized
from dse.analysis.phrases import listed
from dse.analysis.probability import Interval

LEAST = 40
"""Fewer runs than that are not asked for shares: of 24 the intervals held the truth in 86 of 100, of 40 in 94."""

_BINS = (2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64)
_LEAST_A_BIN, _LEAST_BINNED = 6, 20
_NORMAL = 1.96
_ASSOCIATED = 0.3
_LEAST_FOR_COURSE = 100
_LEAST_BINS = 6
_TURN, _SURE, _DOUBTED = 0.1, 3.0, 0.25
_COURSES = {(1,): "rising", (-1,): "falling", (1, -1): "with a peak", (-1, 1): "with a valley"}
_ROUNDING = 1e-12
_MOST_LEVELS = 12


@dataclass(frozen=True, slots=True)
class Share:
    """Of the variance of a metric over the space, what *factor* explains by itself, from *runs* runs that have it."""

    factor: str
    share: Interval
    runs: int


@memoized
def first_order_shares(data: StudyData, metric: str) -> tuple[Share, ...]:
    """The share of each factor, in the order of the factors, of what varies where the metric is defined.

    Shares add up to 1 at most where factors are independent; what they leave is due to several factors together, or to
    bins that are too wide for few runs. Intervals are 1.96 standard deviations to either side, by the jackknife.
    A factor of which fewer than 40 observations have a value is left out, and so are `inseparable` ones. Raises
    DseError, as `StudyData.response` does, and `StudyData.evenly`.
    """
    there, values = data.evenly(metric, LEAST).response(metric, LEAST)
    left_out = inseparable(there)
    found = []
    for k, factor in enumerate(there.factors):
        along = observations(there, k)
        y, weights = along.means(values)
        if factor.name in left_out or len(y) < LEAST or not np.ptp(y):
            continue
        bins = _best_bins(_binnings(there, k), y, weights)
        if not bins.any():
            continue
        freedom = effective(weights)
        between = along.between(values)
        estimate = between * _explained(bins, y, weights, freedom)
        spread = between * _NORMAL * _deviation(bins, y, weights, freedom)
        share = Interval(*np.clip([estimate, estimate - spread, estimate + spread], 0.0, 1.0).tolist())
        found.append(Share(factor.name, share, int(along.rows.sum())))
    return tuple(found)


@dataclass(frozen=True, slots=True, eq=False)
class Observations:
    """What was observed along a factor: the n *rows* that have a value, the observation of each of them, its *places*
    (m) and the *weights* of the runs."""

    rows: Rows
    of_row: NDArray[np.intp]
    places: Floats
    weights: Floats

    def means(self, values: Floats) -> tuple[Floats, Floats]:
        """The mean of *values* in each observation, and its weight."""
        weights = np.bincount(self.of_row, self.weights)
        total = np.bincount(self.of_row, self.weights * values[self.rows])
        alike = np.bincount(self.of_row, values[self.rows]) / np.bincount(self.of_row)
        means = np.where(weights > 0, total / np.where(weights > 0, weights, 1.0), alike)
        return np.asarray(means, dtype=np.float64), np.asarray(weights, dtype=np.float64)

    def between(self, values: Floats) -> float:
        """The share of the variance of *values* that is between observations, and not within them."""
        if len(self.places) == len(self.of_row):
            return 1.0
        whole = _unexplained(np.zeros_like(self.of_row), values[self.rows], self.weights)
        return 1 - _unexplained(self.of_row, values[self.rows], self.weights) / whole if whole > 0 else 1.0


@memoized
def observations(data: StudyData, k: int) -> Observations:
    """Along factor *k*: runs, or those together that have the same values of all variables of its role.

    Of a choice each run is one, and where variables are on a grid, or have certain values in all combinations.
    """
    rows = ~np.isnan(data.places[:, k])
    places, weights, one = data.places[rows], data.weights[rows], data.factors[k].variable
    if one is not None and not data.on_grid:
        variables = {at: each.variable for at, each in enumerate(data.factors) if each.variable}
        alike = [at for at, variable in variables.items() if variable.role is one.role]
        first, of_row = distinct(places[:, alike])
        if len(first) < math.prod(len(variables[at].values) or len(places) for at in alike):
            return Observations(rows, of_row, places[first, k], weights)
    return Observations(rows, np.arange(len(places), dtype=np.intp), places[:, k], weights)


def few_points(data: StudyData) -> dict[str, int]:
    """The variables that have too few observations for shares, though enough runs, with their number."""
    found = {factor.name: observations(data, k) for k, factor in enumerate(data.factors)}
    return {name: len(each.places) for name, each in found.items() if len(each.places) < LEAST <= each.rows.sum()}


@memoized
def courses(data: StudyData, metric: str) -> dict[str, str]:
    """``rising``, ``falling``, ``with a peak``, ``with a valley`` or ``up and down``: what the mean of a metric does
    along each factor that is a number. Nothing is said of one where chance would look the same.

    Means are those of the fewest bins, six or a variable's few values, that explain no less than chance. From bin to
    bin a turn counts if it is more than a tenth of their range and three standard deviations; where some other way
    back is more than a quarter of it, nothing is said, nor from fewer than 100 observations. Raises DseError, as
    `first_order_shares` does.
    """
    there, values = data.evenly(metric, LEAST).response(metric, LEAST)
    found = {}
    for k, factor in enumerate(there.factors):
        y, weights = observations(there, k).means(values)
        if factor.is_choice or len(y) < _LEAST_FOR_COURSE:
            continue
        bins = _best_bins(_binnings(there, k), y, weights, np.sqrt(2 / len(y)), _LEAST_BINS)
        total = np.bincount(bins, weights)
        if not total.all():
            continue
        variances = _unexplained(bins, y, weights) * np.bincount(bins, weights**2) / total**2
        legs = _legs(np.bincount(bins, weights * y) / total, variances)
        if legs:
            found[factor.name] = _COURSES.get(legs, "up and down")
    return found


def _legs(means: Floats, variances: Floats) -> tuple[int, ...]:
    """Which ways the means go from turn to turn, 1 up and -1 down; none where that is not known."""
    legs: list[int] = []
    ends, most, back = [0], float(np.ptp(means)), 0.0
    for at in range(1, len(means)):
        rise = means[at] - means[ends[-1]]
        if legs and rise * legs[-1] >= 0:
            ends[-1] = at
        elif abs(rise) > max(_TURN * most, _SURE * np.sqrt(variances[at] + variances[ends[-1]])):
            legs.append(1 if rise > 0 else -1)
            ends.append(at)
    for start, end, way in zip(ends, [*ends[1:-1], len(means) - 1], legs, strict=False):
        leg = way * means[start : end + 1]
        back = max(back, float((np.maximum.accumulate(leg) - leg).max()))
    return tuple(legs) if back <= _DOUBTED * most else ()


@memoized
def aliased(data: StudyData) -> tuple[tuple[str, ...], ...]:
    """Groups of factors that always change together in these runs, so that no effect can be attributed to one of them.

    Each value of one goes with one value of the other. Of two numbers, also the order of the values has to agree: in a
    random sample each value occurs once, with one value of every other variable.
    """
    columns = _ranks(data)
    groups: list[list[int]] = []
    for k, column in enumerate(columns):
        if len(data) and column.any():
            same = (group for group in groups if _goes_with(data, columns, group[0], k))
            group = next(same, None)
            if group is None:
                groups.append([k])
            else:
                group.append(k)
    return tuple(tuple(data.factors[k].name for k in group) for group in groups if len(group) > 1)


@memoized
def interacting(data: StudyData) -> tuple[tuple[str, str, str], ...]:
    """Factors whose value two others determine together, and neither of them alone; the two first, then the factor.

    What such a factor does cannot be told from an interaction of the two. In a 2^(3-1) fraction with C = AB that is so
    for each of A, B and C. All combinations of the two occur: where each run has values of its own, as in a random
    sample, any two determine everything. Factors of more than 12 values, and `aliased` ones, are not looked at.
    """
    groups = {name for group in aliased(data) for name in group}
    few = {
        k: column
        for k, column in enumerate(_ranks(data))
        if len(data) and 0 < column.max() < _MOST_LEVELS and data.factors[k].name not in groups
    }
    rows = np.unique(np.array([*few.values()], dtype=np.intp).reshape(len(few), len(data)), axis=1)
    columns = dict(zip(few, rows, strict=True))
    found: dict[int, tuple[str, str, str]] = {}
    for one, other in combinations(columns, 2):
        both = columns[one] * (columns[other].max() + 1) + columns[other]
        if not np.bincount(both).all() or both.max() + 1 < (columns[one].max() + 1) * (columns[other].max() + 1):
            continue
        for k in columns.keys() - {one, other} - found.keys():
            alone = (_is_function(columns[each], columns[k]) for each in (one, other))
            if _is_function(both, columns[k]) and not any(alone):
                found[k] = (data.factors[one].name, data.factors[other].name, data.factors[k].name)
    return tuple(found[k] for k in sorted(found))


def inseparable(data: StudyData) -> set[str]:
    """Factors that are `aliased`, or aliased with an interaction (`interacting`)."""
    return {*(name for group in aliased(data) for name in group), *(each[2] for each in interacting(data))}


def alias_sentences(data: StudyData, metric: str) -> tuple[str, ...]:
    """For each group of factors of the runs that define *metric* of which no share is given, why not."""
    there = data.response(metric, 1)[0]
    together = (
        f"{listed(group)} always change together in these runs, so their effects cannot be separated"
        for group in aliased(there)
    )
    interactions = (
        f"{factor} follows from {one} and {other} in these runs, "
        "so its effect cannot be separated from their interaction"
        for one, other, factor in interacting(there)
    )
    few = few_points(there)
    points = (
        f"there are {count} different values of {listed([name for name in few if few[name] == count])} in these runs, "
        f"and {LEAST} are needed"
        for count in sorted({*few.values()})
    )
    return (*together, *interactions, *points)


def _ranks(data: StudyData) -> list[NDArray[np.intp]]:
    """The values of each factor as 0, 1, … in their order."""
    return [np.unique(column, return_inverse=True)[1].reshape(-1) for column in data.places.T]


def _is_function(of: NDArray[np.intp], values: NDArray[np.intp]) -> bool:
    """Whether equal numbers *of* have equal *values*."""
    first = np.empty(int(of.max()) + 1, dtype=np.intp)
    first[of] = values
    return bool((first[of] == values).all())


def _goes_with(data: StudyData, columns: Sequence[NDArray[np.intp]], one: int, other: int) -> bool:
    """Whether the values of two factors, by their ranks, determine each other."""
    pairs = np.unique(np.stack([columns[one], columns[other]]), axis=1)
    if not pairs.shape[1] == pairs[0].max() + 1 == pairs[1].max() + 1:
        return False
    slopes = np.diff(pairs[1])  # the first row ascends
    return (
        data.factors[one].is_choice or data.factors[other].is_choice or bool((slopes > 0).all() or (slopes < 0).all())
    )


@memoized
def going_together(data: StudyData) -> tuple[tuple[str, str], ...]:
    """Pairs of factors that are not independent in these runs: what one of them explains, the other does as well.

    By Cramér's V of four bins each, corrected for chance (Bergsma 2013), of more than 0.3; none in fewer than 20 runs.
    """
    pairs, found = [], []
    for k, factor in enumerate(data.factors):
        rows, bins = binned(data.places[:, k], factor, 4)
        everywhere = np.full(len(data), -1)
        everywhere[rows] = bins
        found.append(everywhere)
        for j in range(k):
            both = (found[j] >= 0) & (found[k] >= 0)
            if both.sum() >= _LEAST_BINNED and _cramers_v(found[k][both], found[j][both]) > _ASSOCIATED:
                pairs.append((data.factors[j].name, factor.name))
    return tuple(pairs)


@memoized
def _binnings(data: StudyData, k: int) -> tuple[NDArray[np.intp], ...]:
    """The bins of the `observations` along factor *k*, few and then more, as many as these bear."""
    places = observations(data, k).places
    found = [binned(places, data.factors[k], _BINS[0])[1]]
    for most in _BINS[1:]:
        bins = binned(places, data.factors[k], most)[1]
        if len(bins) < max(_LEAST_A_BIN * (int(bins.max(initial=0)) + 1), _LEAST_BINNED):
            break
        if not np.array_equal(bins, found[-1]):
            found.append(bins)
    return tuple(found)


def _best_bins(
    binnings: Sequence[NDArray[np.intp]], values: Floats, weights: Floats, tolerance: float = 0.0, least: int = 0
) -> NDArray[np.intp]:
    """As many bins as leave least unexplained, each bin having its price (generalised cross-validation); or the fewest,
    *least* if there are, that leave no more than that and the share *tolerance* of it."""
    counts = [int(bins.max(initial=0)) + 1 for bins in binnings]
    left = [
        _unexplained(bins, values, weights) / max(1 - count / max(effective(weights), 1), 1e-9) ** 2
        for bins, count in zip(binnings, counts, strict=True)
    ]
    enough = min(left) * (1 + tolerance + 1e-9)
    first = next(place for place, one in enumerate(left) if one <= enough)
    return binnings[max(first, next((place for place, count in enumerate(counts) if count >= least), len(counts) - 1))]


def _unexplained(bins: NDArray[np.intp], y: Floats, weights: Floats) -> float:
    """The variance within bins; those without weight have none."""
    total = np.bincount(bins, weights)
    means = np.bincount(bins, weights * y) / np.where(total > 0, total, 1.0)
    return float((weights * (y - means[bins]) ** 2).sum() / max(weights.sum(), 1e-300))


def _explained(bins: NDArray[np.intp], y: Floats, weights: Floats, freedom: float) -> float:
    count = int(bins.max()) + 1
    total = _unexplained(np.zeros_like(bins), y, weights)
    if total <= 0 or freedom <= count:
        return 0.0
    return 1 - _unexplained(bins, y, weights) / total * (freedom - 1) / (freedom - count)


def _deviation(bins: NDArray[np.intp], y: Floats, weights: Floats, freedom: float) -> float:
    """Standard deviation of what is explained, by what it is without each run (the jackknife, Efron 1982)."""
    count, runs = int(bins.max()) + 1, len(y)
    whole = _left_out(np.zeros_like(bins), y, weights)
    if freedom <= count:
        return 0.0
    # A run without which all others are alike.
    changes = whole > _ROUNDING * whole.max()
    ratio = np.where(changes, _left_out(bins, y, weights) / np.where(changes, whole, 1.0), 1.0)
    return float(np.sqrt((runs - 1) * ratio.var()) * (freedom - 1) / (freedom - count))


def _left_out(bins: NDArray[np.intp], y: Floats, weights: Floats) -> Floats:
    """The weighted squares within bins without each run in turn, (n,)."""
    total = np.bincount(bins, weights)
    means = np.bincount(bins, weights * y) / np.where(total > 0, total, 1.0)
    squares, own = weights * (y - means[bins]) ** 2, total[bins]
    # Without a run its bin has another mean.
    rest = own - weights
    alone = rest <= _ROUNDING * own
    gone = np.where(alone, squares, squares * own / np.where(alone, 1.0, rest))
    return np.asarray(squares.sum() - gone, dtype=np.float64)


def _cramers_v(a: NDArray[np.intp], b: NDArray[np.intp]) -> float:
    rows, columns = int(a.max()) + 1, int(b.max()) + 1
    table = np.bincount(a * columns + b, minlength=rows * columns).reshape(rows, columns).astype(np.float64)
    table = table[table.any(axis=1)][:, table.any(axis=0)]
    n, (rows, columns) = len(a), table.shape
    expected = np.outer(table.sum(axis=1), table.sum(axis=0)) / n
    square = ((table - expected) ** 2 / expected).sum() / n - (rows - 1) * (columns - 1) / (n - 1)
    least = min(rows - (rows - 1) ** 2 / (n - 1), columns - (columns - 1) ** 2 / (n - 1)) - 1
    return float(np.sqrt(max(square, 0.0) / least)) if least > 0 else 0.0
