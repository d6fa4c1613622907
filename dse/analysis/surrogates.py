"""Formulas that stand for simulations, each with the error it makes on runs it has not seen."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from dse.analysis.data import Factor, Floats, StudyData, withheld
from dse.analysis.extra import extra
from dse.errors import DseError, Problem, closest, fail

_FOLDS = 5
_LEAST_FOREST = 30
_LEAST_PROCESS = 10
_MOST_PROCESS = 500
_SEED = 0


@dataclass(frozen=True, slots=True, eq=False)
class Surrogate:
    """A *kind* of model of *metric*, from *runs* runs.

    *error* is the root mean square of its errors (SI), *explained* the share of the variance it predicts, both on runs
    that were left out when the model that predicts them was made (5 parts in turn). Of a negative share, the mean of
    all runs would be a better prediction.
    """

    kind: str
    metric: str
    factors: tuple[Factor, ...]
    error: float
    explained: float
    runs: int
    model: Any

    def predict(self, places: Floats) -> Floats:
        """The metric (SI) at *places*, (n, k), 0 … 1 as in `StudyData`: (n,). DseError outside of them."""
        if places.size and (np.isnan(places).any() or places.min() < 0 or places.max() > 1):
            raise withheld(self.metric, "a surrogate says nothing outside of the ranges, nor where a factor is absent")
        return np.asarray(self.model.predict(_features(places, self.factors)), dtype=np.float64)


def fit(data: StudyData, metric: str, kind: str) -> Surrogate:
    """A ``quadratic``, a Gaussian ``process`` or a ``forest``, from the runs in which *metric* is defined.

    DseError for too few runs (or too many: a process), a metric that never changes, and factors that some runs lack.
    """
    if kind not in KINDS:
        raise fail(f"there is no surrogate '{kind}'", None, closest(kind, KINDS))
    there, values = data.response(metric, 2)
    if not there.factors:
        raise withheld(metric, "runs do not differ in anything a surrogate could be a formula of")
    absent = [
        factor.name for factor, column in zip(there.factors, there.places.T, strict=True) if np.isnan(column).any()
    ]
    if absent:
        what = f"some runs lack {absent[0]}, and a surrogate needs all factors in every run"
        raise withheld(metric, what, "look at the runs of one configuration")
    x = _features(there.places, there.factors)
    _refuse(kind, metric, *x.shape)
    selection = extra("sklearn.model_selection", "scikit-learn")
    folds = selection.KFold(_FOLDS, shuffle=True, random_state=_SEED)
    predicted = np.empty(len(values))
    for train, test in folds.split(x):
        predicted[test] = KINDS[kind](x.shape[1]).fit(x[train], values[train]).predict(x[test])
    square = float(((predicted - values) ** 2).mean())
    model = KINDS[kind](x.shape[1]).fit(x, values)
    return Surrogate(kind, metric, there.factors, square**0.5, 1 - square / float(values.var()), len(values), model)


def best_surrogate(data: StudyData, metric: str) -> Surrogate:
    """The one of all kinds that there are runs for that errs least. DseError as `fit`, if there are runs for none."""
    problems: list[Problem] = []
    fitted: list[Surrogate] = []
    for kind in KINDS:
        try:
            fitted.append(fit(data, metric, kind))
        except DseError as error:
            problems += error.problems
    if not fitted:
        raise DseError(*problems)
    return min(fitted, key=lambda each: round(each.error, 12))


def _features(places: Floats, factors: tuple[Factor, ...]) -> Floats:
    """Numbers from -1 to 1; of a choice a column for each level but the first."""
    columns: list[Floats] = []
    for factor, column in zip(factors, places.T, strict=True):
        if not factor.is_choice:
            columns.append(2 * column - 1)
            continue
        level = np.minimum((column * len(factor.levels)).astype(int), len(factor.levels) - 1)
        columns += [(level == number).astype(np.float64) for number in range(1, len(factor.levels))]
    return np.array(columns, dtype=np.float64).T


def _refuse(kind: str, metric: str, runs: int, columns: int) -> None:
    terms = (columns + 1) * (columns + 2) // 2
    least = {"quadratic": 2 * terms, "process": max(_LEAST_PROCESS, 5 * columns), "forest": _LEAST_FOREST}[kind]
    if runs < least:
        raise withheld(metric, f"a {kind} of {columns} variables needs {least} runs, and there are {runs}")
    if kind == "process" and runs > _MOST_PROCESS:
        raise withheld(
            metric, f"a Gaussian process of {runs} runs takes too long: at most {_MOST_PROCESS}", "take a forest"
        )


def _quadratic(_: int) -> Any:
    pipeline, linear = extra("sklearn.pipeline", "scikit-learn"), extra("sklearn.linear_model", "scikit-learn")
    polynomial = extra("sklearn.preprocessing", "scikit-learn").PolynomialFeatures(2)
    return pipeline.make_pipeline(polynomial, linear.LinearRegression(fit_intercept=False))


def _process(columns: int) -> Any:
    process = extra("sklearn.gaussian_process", "scikit-learn")
    kernels = process.kernels
    kernel = kernels.ConstantKernel() * kernels.Matern([1.0] * columns, (0.05, 100.0), nu=2.5)
    kernel += kernels.WhiteKernel(1e-4, (1e-10, 1.0))
    return _Quiet(process.GaussianProcessRegressor(kernel, normalize_y=True, random_state=_SEED))


def _forest(_: int) -> Any:
    ensemble = extra("sklearn.ensemble", "scikit-learn")
    return ensemble.RandomForestRegressor(200, min_samples_leaf=2, max_features=0.7, random_state=_SEED)


class _Quiet:
    """A model that may say that a length lies at the end of what was tried; its error on other runs says how bad."""

    def __init__(self, model: Any) -> None:
        self._model = model

    def fit(self, x: Floats, values: Floats) -> _Quiet:
        """Without warnings of convergence."""
        import warnings

        with warnings.catch_warnings():
            warnings.simplefilter("ignore", extra("sklearn.exceptions", "scikit-learn").ConvergenceWarning)
            self._model.fit(x, values)
        return self

    def predict(self, x: Floats) -> Floats:
        """As the model does."""
        return np.asarray(self._model.predict(x), dtype=np.float64)


KINDS = {"quadratic": _quadratic, "process": _process, "forest": _forest}
