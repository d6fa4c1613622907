"""How much worse a metric is predicted when a factor is mixed up: what it does together with others included.

Permutation importance (Breiman 2001) of a forest, on runs that it has not seen. For independent factors and a perfect
prediction, half of the error that mixing adds is the factor's total Sobol' index.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dse.analysis.data import StudyData, withheld
from dse.analysis.extra import extra
from dse.analysis.probability import Interval

_LEAST = 50
_MOST = 5000
_FOLDS = 5
_TREES = 100
_MIXES = 4
_NORMAL = 1.96
_LEAST_EXPLAINED = 0.5
_SEED = 0


@dataclass(frozen=True, slots=True)
class Importance:
    """Of a *factor*: its part in the variance of a metric, with all it does together with others."""

    factor: str
    share: Interval


@dataclass(frozen=True, slots=True)
class Importances:
    """Of all factors; *explained* is the share of the variance that the forest predicts of runs it has not seen."""

    factors: tuple[Importance, ...]
    explained: float
    runs: int


def importances(data: StudyData, metric: str) -> Importances:
    """From the runs in which *metric* is defined, of more than 5,000 every so-manieth; runs may lack factors.

    Intervals are 1.96 standard errors of the mean over five parts of the runs to either side. DseError if fewer than 50
    runs define the metric, if it never changes, or if the forest predicts less than half of its variance.
    """
    forests = extra("sklearn.ensemble", "scikit-learn")
    folds = extra("sklearn.model_selection", "scikit-learn").KFold(_FOLDS, shuffle=True, random_state=_SEED)
    there, values = data.response(metric, _LEAST)
    stride = -(-len(values) // _MOST)
    x, y = there.places[::stride], values[::stride]
    random = np.random.default_rng(_SEED)
    variance = float(y.var())
    added, squares = np.empty((_FOLDS, len(there.factors))), []
    for fold, (train, test) in enumerate(folds.split(x)):
        forest = forests.RandomForestRegressor(_TREES, max_features=0.7, random_state=_SEED).fit(x[train], y[train])
        usual = float(((forest.predict(x[test]) - y[test]) ** 2).mean())
        squares.append(usual)
        for k in range(x.shape[1]):
            mixed = np.concatenate([x[test]] * _MIXES)
            mixed[:, k] = np.concatenate([random.permutation(x[test, k]) for _ in range(_MIXES)])
            wrong = float(((forest.predict(mixed) - np.concatenate([y[test]] * _MIXES)) ** 2).mean())
            added[fold, k] = (wrong - usual) / (2 * variance)
    explained = 1 - float(np.mean(squares)) / variance
    if explained < _LEAST_EXPLAINED:
        told = f"a forest predicts {max(explained, 0.0):.0%} of its variance"
        raise withheld(metric, f"{told}: too little to say what matters together with others")
    means, spreads = added.mean(axis=0), _NORMAL * added.std(axis=0, ddof=1) / np.sqrt(_FOLDS)
    found = [
        Importance(factor.name, Interval(*np.clip([mean, mean - spread, mean + spread], 0.0, None).tolist()))
        for factor, mean, spread in zip(there.factors, means, spreads, strict=True)
    ]
    return Importances(tuple(found), explained, len(y))
