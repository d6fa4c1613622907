"""What each factor has to do with a metric, with all it does together with others: total Sobol' indices of a model.

The model is polynomial chaos or a Gaussian process, whichever predicts runs better that it has not seen. Its indices
are integrals over the space, not over errors; what it leaves unexplained is part of each interval.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from dse.analysis.bins import binned
from dse.analysis.data import Floats, StudyData, withheld
from dse.analysis.first_order import first_order_shares
from dse.analysis.once import once
from dse.analysis.phrases import listed, percent
from dse.analysis.probability import Interval
from dse.analysis.radial import drawn
from dse.analysis.separable import FOLDS, Group, Indices, Model, folds, gaussian_process, polynomial_chaos
from dse.errors import DseError

_LEAST_EXPLAINED, _AIM = 0.9, 0.92
"""Of the variance: what a model that explains less leaves open is more than most totals; and what more runs aim at."""

_LEAST = 50
_LEAST_DEFINED = 0.9
_MOST = 1000
_ENOUGH = 0.98
"""Of the variance: another model would say the same, and takes longer."""
_MOST_TOGETHER = 3
_NODES = 64
_FEW_VALUES = 12
_BINS = 4
_CHANCE = 1e-4
_NORMAL = 1.96
_MOST_TIMES, _CHANCE_EXPLAINED = 100, 0.05
_HINT = "next: dse explore STUDY with the sampler 'sobol_indices', which needs no model"


@dataclass(frozen=True, slots=True)
class Importance:
    """Of *factors*, one or several that depend on each other: their total Sobol' index, *share*."""

    factors: tuple[str, ...]
    share: Interval


@dataclass(frozen=True, slots=True)
class Together:
    """The part of the variance that depends on both *one* and *other*, and perhaps on more."""

    one: tuple[str, ...]
    other: tuple[str, ...]
    share: Interval


@dataclass(frozen=True, slots=True)
class Importances:
    """Of all factors, and of pairs of those that matter most, by a *model* in words.

    *explained* is the share of the variance that it predicts of runs it has not seen (Q2).
    """

    factors: tuple[Importance, ...]
    pairs: tuple[Together, ...]
    model: str
    explained: float
    runs: int

    @property
    def source(self) -> str:
        """The model with what it explains: ``polynomial chaos that explains 96 % of it in held-out runs``."""
        return f"{self.model} that explains {percent(self.explained)} of it in held-out runs"


@once
def importances(data: StudyData, metric: str) -> Importances:
    """From the runs in which *metric* is defined, of 1,000 drawn at most.

    Factors that depend on each other in these runs have one total. An interval is 1.96 standard errors to either side,
    by the jackknife over five parts of the runs, and the share of the variance that is unexplained. No total is less
    than the factor's first-order index. DseError if fewer than 50 runs or nine of ten define the metric, if it never
    changes, if all factors depend on each other, or if less than 90 % of its variance is explained.
    """
    there, values = data.response(metric, _LEAST)
    require_everywhere(data, metric)
    rows = drawn(np.arange(len(values)), _MOST)
    there, values = there.part(rows), values[rows]
    groups = _dependent(there)
    if len(groups) == 1:
        names = listed([factor.name for factor in there.factors])
        raise withheld(metric, f"{names} depend on each other in these runs: they have all of its variance together")
    model, explained = _best(there, values)
    if explained < _LEAST_EXPLAINED:
        raise _too_little(there, metric, model, explained, _enough(there, values, explained))
    indices = Indices(model, [_group(there, group) for group in groups])
    names_ = [tuple(there.factors[k].name for k in group) for group in groups]
    first = {each.factor: each.share.value for each in first_order_shares(data, metric)}
    totals = [
        _interval(indices.shared(at), 1 - explained, max(first.get(name, 0.0) for name in names))
        for at, names in enumerate(names_)
    ]
    most = sorted(range(len(groups)), key=lambda at: -round(totals[at].value, 9))[:_MOST_TOGETHER]
    pairs = [
        Together(names_[one], names_[other], _interval(indices.shared(one, other), 1 - explained))
        for one, other in combinations(sorted(most), 2)
    ]
    pairs.sort(key=lambda pair: -round(pair.share.value, 9))
    return Importances(tuple(map(Importance, names_, totals)), tuple(pairs), model.name, explained, len(there))


def require_everywhere(data: StudyData, metric: str) -> None:
    """DseError unless nearly all runs define *metric*, and these lie at many points.

    Integrals over the space would be over what does not define it, or over what lies between few points.
    """
    defined = int(np.isfinite(data.metrics[metric]).sum())
    if defined < _LEAST_DEFINED * len(data):
        told = f"it is defined in {defined} of {len(data)} runs only"
        raise withheld(metric, f"{told}: what matters together is told of metrics that are nearly everywhere")
    if not data.on_grid and data.different < _LEAST:
        raise withheld(metric, f"variables have {data.different} different values in all: {_LEAST} are needed")


def _dependent(data: StudyData) -> list[tuple[int, ...]]:
    """The factors, by position, in groups that are independent of each other in these runs.

    Two depend on each other if chance makes their four bins each so uneven in one of 10,000 studies (chi-squared). That
    a factor is absent is one of its values; runs that share the values of both, as those at each condition do, are one.
    """
    from scipy.special import chdtrc

    bins = []
    for column, factor in zip(data.places.T, data.factors, strict=True):
        present, found = binned(column, factor, _BINS)
        bins.append(np.zeros(len(column), dtype=np.intp))
        bins[-1][present] = found + 1
    group = np.arange(len(bins))
    for one, other in combinations(range(len(bins)), 2):
        rows = np.arange(len(data))
        if not (data.factors[one].is_choice and data.factors[other].is_choice):
            rows = np.unique(np.nan_to_num(data.places[:, [one, other]], nan=-1.0), axis=0, return_index=True)[1]
        table = np.zeros((bins[one].max() + 1, bins[other].max() + 1))
        np.add.at(table, (bins[one][rows], bins[other][rows]), 1.0)
        table = table[table.any(axis=1)][:, table.any(axis=0)]
        expected = np.outer(table.sum(axis=1), table.sum(axis=0)) / len(rows)
        freedom = (table.shape[0] - 1) * (table.shape[1] - 1)
        if freedom and chdtrc(freedom, ((table - expected) ** 2 / expected).sum()) < _CHANCE:
            group[group == group[other]] = group[one]
    return [tuple(np.flatnonzero(group == each).tolist()) for each in dict.fromkeys(group.tolist())]


def _models(data: StudyData, values: Floats) -> Iterator[Model]:
    part, is_choice = folds(len(data)), [factor.is_choice for factor in data.factors]
    y = values - np.average(values, weights=data.weights)
    y /= np.average(y**2, weights=data.weights) ** 0.5 or 1.0
    if not any(is_choice) and not np.isnan(data.places).any():
        yield polynomial_chaos(data.places, y, part)
    for rough in (False, True):
        yield gaussian_process(data.places, y, part, is_choice, rough)


def _best(data: StudyData, values: Floats) -> tuple[Model, float]:
    """The model that explains most of the variance, and what share of it in runs that it has not seen."""
    found: list[tuple[Model, float]] = []
    for model in _models(data, values):
        explained = 1 - float(np.average(model.errors**2, weights=data.weights))
        found.append((model, round(explained, 9)))
        if explained >= _ENOUGH:
            break
    return max(found, key=lambda each: each[1])


def _group(data: StudyData, factors: tuple[int, ...]) -> Group:
    """A number that may have any value is everywhere in its range; else values are those of the runs."""
    column = data.places[:, factors[0]]
    variable = data.factors[factors[0]].variable
    if len(factors) == 1 and variable is not None and not variable.values and len(np.unique(column)) > _FEW_VALUES:
        nodes, chances = np.polynomial.legendre.leggauss(_NODES)
        return Group(factors, (nodes[:, None] + 1) / 2, chances / 2)
    places, which = np.unique(data.places[:, factors], axis=0, return_inverse=True)
    return Group(factors, places, np.bincount(which.reshape(-1), data.weights) / data.weights.sum())


def _interval(parts: Floats, unexplained: float, least: float = 0.0) -> Interval:
    """Of an index that is at *least* so much."""
    mean = float(parts.mean())
    half = _NORMAL * float(((parts - mean) ** 2).sum() * (FOLDS - 1) / FOLDS) ** 0.5
    half += unexplained
    value = min(max(mean, least, 0.0), 1.0)
    return Interval(value, min(max(mean - half, 0.0), value), max(min(mean + half, 1.0), value))


def _enough(data: StudyData, values: Floats, explained: float) -> float:
    """How many runs would explain 92 %, if what is unexplained falls as from half of the runs to all of them."""
    if explained < _CHANCE_EXPLAINED:
        return math.inf
    first = drawn(np.arange(len(data)), len(data) // 2)
    halves = [first, np.setdiff1d(np.arange(len(data)), first)]
    half = float(np.mean([_best(data.part(rows), values[rows])[1] for rows in halves]))
    falls = math.log2(max(1 - half, 1e-9) / (1 - explained))
    times = math.log2((1 - explained) / (1 - _AIM)) / falls if falls > 0 else math.inf
    return len(data) * 2**times if times < math.log2(_MOST_TIMES) else math.inf


def _too_little(data: StudyData, metric: str, model: Model, explained: float, enough: float) -> DseError:
    told = (
        f"only {math.floor(100 * max(explained, 0.0))} % of its variance is explained by {model.name} in held-out runs"
    )
    more = "more runs like these would hardly help"
    if math.isfinite(enough):
        digits = 10 ** (int(math.log10(enough)) - 1)
        more = f"about {math.ceil(enough / digits) * digits:,} runs would do"
    is_plain = all(factor.is_decided and not factor.is_choice for factor in data.factors)
    return withheld(metric, f"{told}, {percent(_LEAST_EXPLAINED)} are needed: {more}", _HINT if is_plain else "")
