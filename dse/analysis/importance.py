"""What each factor has to do with a metric, with all it does together with others, by a model of the runs.

The model is a radial formula or a forest, whichever predicts runs better that it has not seen; its factors are mixed up
in these (`Mixing`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from dse.analysis.data import Floats, StudyData, withheld
from dse.analysis.extra import extra
from dse.analysis.first_order import going_together
from dse.analysis.mixing import Mixing, Pair, Part, Predict
from dse.analysis.probability import Interval
from dse.analysis.radial import MOST_RUNS, centres_of, columns_of, drawn, features, formulas
from dse.errors import DseError

LEAST_EXPLAINED = 0.5
"""A model that predicts less of the variance says too little."""

_LEAST = 50
_LEAST_DEFINED = 0.9
_MOST = 5000
_FOLDS = 5
_TREES = 100
_ENOUGH = 0.98
"""Of the variance predicted by a formula; a forest, which takes far longer, would say the same."""
_MIXES = 4
_SEED = 0


@dataclass(frozen=True, slots=True)
class Importance:
    """Of a *factor*: its part in the variance of a metric, with all it does together with others."""

    factor: str
    share: Interval


@dataclass(frozen=True, slots=True)
class Together:
    """The part of the variance that depends on both *one* and *other*, and perhaps on more."""

    one: str
    other: str
    share: Interval


@dataclass(frozen=True, slots=True)
class Importances:
    """Of all factors, and of pairs of those that matter most, by a *model* in words.

    *explained* is the share of the variance that it predicts of runs it has not seen.
    """

    factors: tuple[Importance, ...]
    pairs: tuple[Together, ...]
    model: str
    explained: float
    runs: int


def importances(data: StudyData, metric: str) -> Importances:
    """From the runs in which *metric* is defined, of 5,000 drawn at most; where runs lack factors, by a forest only.

    Factors that go together are mixed up together, and share a total. Intervals are 1.96 standard errors of the mean of
    five parts of the runs to either side. DseError if fewer than 50 runs or nine of ten define the metric, if it never
    changes, or if less than half of its variance is predicted.
    """
    there, values = data.response(metric, _LEAST)
    require_everywhere(data, metric)
    found = list(_models(there, values))
    best = max(found, key=lambda each: round(each.explained, 9))
    if best.explained < LEAST_EXPLAINED:
        told = f"{best.model} predicts {max(best.explained, 0.0):.0%} of its variance"
        raise withheld(metric, f"{told}: too little to say what matters together with others")
    return best


def require_everywhere(data: StudyData, metric: str) -> None:
    """DseError unless nearly all runs define *metric*, and these lie at many points.

    Factors that are mixed up would ask for runs that do not define it, or for what lies between few points.
    """
    defined = int(np.isfinite(data.metrics[metric]).sum())
    if defined < _LEAST_DEFINED * len(data):
        told = f"it is defined in {defined} of {len(data)} runs only"
        raise withheld(metric, f"{told}: what matters together is told of metrics that are nearly everywhere")
    if not data.on_grid and data.different < _LEAST:
        raise withheld(metric, f"variables have {data.different} different values in all: {_LEAST} are needed")


def mixed_groups(data: StudyData) -> list[list[int]]:
    """For each factor its position and those of all that go together with it, directly or not."""
    groups = {factor.name: {k} for k, factor in enumerate(data.factors)}
    for one, other in going_together(data):
        joined = groups[one] | groups[other]
        groups |= {data.factors[k].name: joined for k in joined}
    return [sorted(groups[factor.name]) for factor in data.factors]


def _models(data: StudyData, values: Floats) -> Iterator[Importances]:
    is_whole = not np.isnan(data.places).any()
    if is_whole:
        yield (formula := _by_formula(data, values))
        if formula.explained >= _ENOUGH:
            return
    try:
        yield _by_forest(data, values)
    except DseError:
        if not is_whole:
            raise


def _by_formula(data: StudyData, values: Floats) -> Importances:
    rows = drawn(np.arange(len(values)), MOST_RUNS)
    points, y = features(data.places[rows], data.factors), values[rows]
    y = (y - y.mean()) / (y.std() or 1.0)
    columns = columns_of(data.factors, mixed_groups(data))
    (found,) = formulas(points, y[:, None], centres_of(points), data.weights[rows], columns)
    return _told(data, "a formula", found.explained, len(rows), found.totals, found.pairs)


def _by_forest(data: StudyData, values: Floats) -> Importances:
    forests: Any = extra("sklearn.ensemble", "scikit-learn")
    folds = extra("sklearn.model_selection", "scikit-learn").KFold(_FOLDS, shuffle=True, random_state=_SEED)
    rows = drawn(np.arange(len(values)), _MOST)
    x, y, weights = data.places[rows], values[rows], data.weights[rows]
    parts = []
    for train, test in folds.split(x):
        forest = forests.RandomForestRegressor(_TREES, max_features=0.7, random_state=_SEED).fit(x[train], y[train])
        parts.append(Part(_predict(forest), x[test], y[test, None], weights[test]))
    mixing = Mixing(mixed_groups(data), parts, _MIXES)
    return _told(data, "a forest", float(mixing.explained[0]), len(rows), mixing.totals(0), mixing.pairs(0))


def _predict(forest: Any) -> Predict:
    """What `forest.predict` gives, tree by tree without checks that take longer than the trees do."""
    trees = [tree.tree_ for tree in forest.estimators_]

    def predict(points: Floats) -> Floats:
        given, total = np.asarray(points, dtype=np.float32), np.zeros((len(points), 1))
        for tree in trees:
            total += tree.predict(given)
        return total / len(trees)

    return predict


def _told(
    data: StudyData, model: str, explained: float, runs: int, totals: Sequence[Interval], pairs: Sequence[Pair]
) -> Importances:
    names = [factor.name for factor in data.factors]
    return Importances(
        tuple(map(Importance, names, totals)),
        tuple(Together(names[pair.one], names[pair.other], pair.share) for pair in pairs),
        model,
        explained,
        runs,
    )
