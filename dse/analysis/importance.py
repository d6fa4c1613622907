"""What each factor has to do with a metric, with all it does together with others: total Sobol' indices of a model.

The model is polynomial chaos or a Gaussian process, whichever predicts runs better that it has not seen. Its indices
are integrals over the space, not over errors; what it leaves unexplained is part of each interval.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from dse.analysis.data import Floats, StudyData, withheld
from dse.analysis.first_order import Share, first_order_shares as given_data_shares, interacting
from dse.analysis.memoize import memoized
from dse.analysis.phrases import listed, percent
from dse.analysis.probability import Interval
from dse.analysis.radial import drawn
from dse.analysis.separable import FOLDS, Group, Indices, Model, folds, gaussian_process, polynomial_chaos
from dse.errors import DseError
from dse.exploration import single_threaded

_LEAST_EXPLAINED, _AIM = 0.9, 0.92
"""Of the variance: what a model that explains less leaves open is more than most totals; and what more runs aim at."""

_LEAST = 50
_LEAST_DEFINED = 0.9
_MOST = 500
_ENOUGH = 0.99
"""Of the variance: another model would say the same, and takes longer."""
_MOST_TOGETHER = 3
_PARTS = range(FOLDS)
_NODES = 64
_FEW_VALUES = 12
_CHANCE = 0.01
_STUDENT = 2.78
"""97.5 % of Student's t with four degrees of freedom."""
_ABSENT, _ROUNDING = -1.0, 1e-9
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

    @property
    def joint(self) -> tuple[str, ...]:
        """What factors that depend on each other in these runs have in all: they have no totals of their own."""
        several = [each for each in self.factors if len(each.factors) > 1]
        return tuple(
            f"{listed(each.factors)} depend on each other in these runs, and have {percent(each.share.value)} in all"
            for each in several
        )


@memoized
def importances(data: StudyData, metric: str) -> Importances:
    """From the evenly drawn runs in which *metric* is defined, of 500 at most.

    Factors that depend on each other in these runs have one total. An interval is 2.78 standard errors to either side,
    by the jackknife over five parts of the runs, and the share of the variance that is unexplained. DseError if fewer
    than 50 runs or nine of ten define the metric, if it never changes, if all factors depend on each other, or if less
    than 90 % of its variance is explained.
    """
    fitted = _fitted(data, metric)
    there, model, explained, groups = fitted.data, fitted.model, fitted.explained, fitted.groups
    if not fitted.is_enough:
        with single_threaded():
            enough = _enough(there, fitted.values, explained)
        is_plain = all(factor.is_decided and not factor.is_choice for factor in there.factors)
        raise withheld(metric, _too_little(model, explained, enough, fitted.runs), _HINT if is_plain else "")
    unexplained, indices = 1 - explained, _indices(there, model, groups)
    names_ = [tuple(there.factors[k].name for k in group) for group in groups]
    totals = [_interval([each.shared(at) for each in indices], unexplained) for at in range(len(groups))]
    most = sorted(range(len(groups)), key=lambda at: -round(totals[at].value, 9))[:_MOST_TOGETHER]
    pairs = [
        Together(names_[one], names_[other], _interval([each.shared(one, other) for each in indices], unexplained))
        for one, other in combinations(sorted(most), 2)
    ]
    pairs.sort(key=lambda pair: -round(pair.share.value, 9))
    return Importances(tuple(map(Importance, names_, totals)), tuple(pairs), model.name, explained, len(there))


@memoized
def model_first_order_shares(data: StudyData, metric: str) -> tuple[Share, ...]:
    """What each factor explains by itself, from given data; of judged metrics no more than its total, if there is one.

    Raises DseError, as `given_data_shares` does.
    """
    found = given_data_shares(data, metric)
    if metric not in data.judged_metrics:
        return found
    try:
        if not _fitted(data, metric).is_enough:
            return found
        totals = {name: each.share for each in importances(data, metric).factors for name in each.factors}
    except DseError:
        return found
    return tuple(replace(each, share=_at_most(each.share, totals.get(each.factor, each.share))) for each in found)


@dataclass(frozen=True, slots=True, eq=False)
class _Fitted:
    """The *model* of the *values* of *data*, drawn evenly from all *runs*; *groups* of its factors are independent."""

    data: StudyData
    values: Floats
    runs: int
    groups: list[tuple[int, ...]]
    model: Model
    explained: float

    @property
    def is_enough(self) -> bool:
        """Whether the model explains enough of the variance."""
        return self.explained >= _LEAST_EXPLAINED


@memoized
def _fitted(data: StudyData, metric: str) -> _Fitted:
    """Raises DseError, as `importances` does, but not if too little is explained."""
    data = data.evenly(metric, _LEAST)
    there, values = data.response(metric, _LEAST)
    if len(values) < _LEAST_DEFINED * len(data):
        told = f"it is defined in {len(values)} of {len(data)} runs only"
        raise withheld(metric, f"{told}: joint importance is given for metrics that are defined nearly everywhere")
    if not data.on_grid and data.different < _LEAST:
        raise withheld(metric, f"variables have {data.different} different values in all: {_LEAST} are needed")
    runs, rows = len(values), drawn(np.arange(len(values)), _MOST)
    there, values = there.part(rows), values[rows]
    groups = _dependent(there)
    if len(groups) == 1:
        names = listed([factor.name for factor in there.factors])
        raise withheld(metric, f"{names} depend on each other in these runs: they have all of its variance together")
    with single_threaded():
        model, explained = _best(there, values)
    return _Fitted(there, values, runs, groups, model, explained)


def _at_most(share: Interval, total: Interval) -> Interval:
    return Interval(*map(min, (share.value, share.low, share.high), (total.value, total.value, total.high)))


def _dependent(data: StudyData) -> list[tuple[int, ...]]:
    """The factors, by position, in groups that are independent of each other in these runs.

    Two depend on each other if a constraint names both, or if some `_scores` correlate as they do by chance in one of
    100 studies. Runs that share the values of both, as those at each condition do, are one, but not of two choices. So
    do three of which two determine the third (`interacting`).
    """
    from scipy.special import chdtrc

    group, names = np.arange(len(data.factors)), [factor.name for factor in data.factors]
    named = [{name for name in names if name in constraint} for constraint in data.definition.constraints]
    pairs = list(combinations(range(len(group)), 2))
    for one, other in pairs:
        both = data.places[:, [one, other]]
        if not (data.factors[one].is_choice and data.factors[other].is_choice):
            both = np.unique(np.nan_to_num(both, nan=_ABSENT), axis=0)
        first, second = (_scores(both[:, i], data.factors[k].is_choice) for i, k in enumerate((one, other)))
        freedom = first.shape[1] * second.shape[1]
        chance = chdtrc(freedom, len(both) * float(((first.T @ second) ** 2).sum())) if freedom else 1.0
        if chance < _CHANCE / len(pairs) or any({names[one], names[other]} <= each for each in named):
            group[group == group[other]] = group[one]
    for together in interacting(data):
        group[np.isin(group, group[[names.index(name) for name in together]])] = group[names.index(together[0])]
    return [tuple(np.flatnonzero(group == each).tolist()) for each in dict.fromkeys(group.tolist())]


def _scores(column: Floats, is_choice: bool) -> Floats:
    """Orthonormal columns of mean 0: of a number its rank, the square of that and whether it is absent; of a choice its
    levels. Of two choices, n times the sum of their squared correlations is Pearson's chi-squared."""
    if is_choice:
        scores = (column[:, None] == np.unique(column)).astype(np.float64)
    else:
        absent = column == _ABSENT
        rank = np.searchsorted(np.sort(column[~absent]), column) / max(int((~absent).sum()), 1) - 0.5
        scores = np.stack([np.where(absent, 0, rank), np.where(absent, 0, rank**2), absent], axis=1)
    found, sizes, _ = np.linalg.svd(scores - scores.mean(axis=0), full_matrices=False)
    return np.asarray(found[:, sizes > _ROUNDING * len(column)], dtype=np.float64)


def _models(data: StudyData, values: Floats) -> Iterator[Model]:
    part, is_choice = folds(data.points), [factor.is_choice for factor in data.factors]
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
        is_chance = len(found) > 1 and max(each for _, each in found) < _CHANCE_EXPLAINED
        if explained >= _ENOUGH or is_chance:
            break
    return max(found, key=lambda each: each[1])


def _indices(data: StudyData, model: Model, groups: Sequence[tuple[int, ...]]) -> list[Indices]:
    """Of the models without each part of the runs."""
    measured = [_measure(data, group) for group in groups]
    parts = [
        [Group(g, places, chances[n]) for g, (places, chances) in zip(groups, measured, strict=True)] for n in _PARTS
    ]
    if all((chances == chances[0]).all() for _, chances in measured):
        return [Indices(model.terms, model.weights, parts[0])]
    return [Indices(model.terms, model.weights[[n]], parts[n]) for n in _PARTS]


def _measure(data: StudyData, group: tuple[int, ...]) -> tuple[Floats, Floats]:
    """Places, (m, factors), and their chances without each part of the runs, (folds, m).

    A number that may have any value, and is independent of all others, is everywhere in its range.
    """
    variable = data.factors[group[0]].variable
    places, which = np.unique(data.places[:, group], axis=0, return_inverse=True)
    if len(group) == 1 and variable is not None and not variable.values and len(places) > _FEW_VALUES:
        nodes, chances = np.polynomial.legendre.leggauss(_NODES)
        return (nodes[:, None] + 1) / 2, np.tile(chances / 2, (FOLDS, 1))
    part = folds(data.points)
    counts = [np.bincount(which.reshape(-1), data.weights * (part != n), len(places)) for n in _PARTS]
    return places, np.stack([each / each.sum() for each in counts])


def _interval(parts: Sequence[Floats], unexplained: float) -> Interval:
    values = np.concatenate(parts)
    mean = float(values.mean())
    half = _STUDENT * float(((values - mean) ** 2).sum() * (FOLDS - 1) / FOLDS) ** 0.5 + unexplained
    return Interval(*np.clip([mean, mean - half, mean + half], 0.0, 1.0).tolist())


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


def _too_little(model: Model, explained: float, enough: float, runs: int) -> str:
    more = "half as many runs explain hardly less"
    if enough <= runs:
        more = f"{_MOST:,} of the {runs:,} runs were used"
    elif math.isfinite(enough):
        digits = 10 ** (int(math.log10(enough)) - 1)
        more = f"about {math.ceil(enough / digits) * digits:,} runs would do"
    told = f"only {math.floor(100 * max(explained, 0.0))} % of its variance is explained by {model.name}"
    return f"{told} in held-out runs, {percent(_LEAST_EXPLAINED)} are needed: {more}"
