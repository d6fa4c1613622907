"""Models of a metric that are sums of products, with one function in each product for each factor; and their indices.

Such are polynomial chaos and a Gaussian process whose kernel is a product. For independent groups of factors the mean
of a product is the product of means, so that Sobol' indices need no sampling: of ``f = sum(a_j prod(phi_gj(x_g)))``,
with the matrices ``S_g = E[phi_g phi_g']`` and the vectors ``b_g = E[phi_g]``, the variance is
``a' (prod(S_g) - prod(b_g b_g')) a``, what of it depends on group g ``a' ((S_g - b_g b_g') prod(S_h, h not g)) a``, and
what depends on two groups at once (Liu and Owen 2006) has such a difference for both; all products are elementwise.

Example: x1 x2 on the unit square is one product; S = 1/3 and b = 1/2 of each. The variance is 1/9 - 1/16 = 7/144, the
total index (1/3 - 1/4) 1/3 / (7/144) = 4/7, and (1/3 - 1/4)^2 / (7/144) = 1/7 depends on both.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import reduce
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from dse.analysis.data import Floats

FOLDS = 5
_SEED = 0
_HIGHEST, _NORM, _MOST_TERMS = 12, 0.8, 300
_MOST_SELECTED, _PATIENCE, _DIGITS = 80, 15, 9
_MOST_LIKELY, _STEPS, _APART = 150, 40, 1e3
_RELEVANCE, _LENGTH, _NOISE = (-7.0, 7.0), (-2.5, 1.5), (-16.0, 0.0)


class Terms(Protocol):
    """What the products of a model are made of."""

    def along(self, factor: int, places: Floats) -> Floats:
        """The function of *factor* in each product, at *places*, (n,): (n, terms)."""


@dataclass(frozen=True, slots=True, eq=False)
class Model:
    """Products, and their *weights*, (folds, terms), of models each of which did not see one part of the runs.

    *errors*, (n,), are those in runs not seen, where the values have the variance 1.
    """

    name: str
    terms: Terms
    weights: Floats
    errors: Floats


@dataclass(frozen=True, slots=True, eq=False)
class Group:
    """*factors*, by position, which depend on each other, at *places*, (m, factors), with their *chances*, (m,)."""

    factors: tuple[int, ...]
    places: Floats
    chances: Floats


def folds(points: NDArray[np.intp]) -> NDArray[np.intp]:
    """The part that each run is in, (n,): one for all runs at one of the *points* (`StudyData.points`)."""
    parts = np.random.default_rng(_SEED).permutation(int(points.max(initial=-1)) + 1) % FOLDS
    return np.asarray(parts[points], dtype=np.intp)


def _product(factors: Iterable[Floats]) -> Floats:
    found: Floats = reduce(np.multiply, factors)
    return found


class Indices:
    """Sobol' indices of sums of *terms* with *weights*, (models, terms), whose *groups* of factors are independent.

    Each array is (models,).
    """

    def __init__(self, terms: Terms, weights: Floats, groups: Sequence[Group]) -> None:
        self._weights = weights
        self._squares, self._means = [], []
        for group in groups:
            along = _product(terms.along(k, group.places[:, i]) for i, k in enumerate(group.factors))
            self._squares.append((along.T * group.chances) @ along)
            self._means.append(group.chances @ along)
        mean = _product(self._means)
        self._variance = self._of(_product(self._squares)) - (self._weights @ mean) ** 2

    def shared(self, *those: int) -> Floats:
        """The part of the variance that depends on all of these groups, and perhaps on more: for one, its total."""
        parts = [
            square - np.outer(mean, mean) if at in those else square
            for at, (square, mean) in enumerate(zip(self._squares, self._means, strict=True))
        ]
        return self._of(_product(parts)) / np.maximum(self._variance, 1e-12)

    def _of(self, matrix: Floats) -> Floats:
        return np.asarray(((self._weights @ matrix) * self._weights).sum(axis=1), dtype=np.float64)


@dataclass(frozen=True, slots=True, eq=False)
class _Legendre:
    """Products of Legendre polynomials of *degrees*, (terms, factors), orthonormal on 0 … 1."""

    degrees: NDArray[np.intp]

    def along(self, factor: int, places: Floats) -> Floats:
        x, degrees = 2 * places - 1, self.degrees[:, factor]
        found = [np.ones_like(x), x]
        for n in range(1, int(degrees.max(initial=0))):
            found.append(((2 * n + 1) * x * found[n] - n * found[n - 1]) / (n + 1))
        return np.stack(found, axis=1)[:, degrees] * np.sqrt(2 * degrees + 1)


def polynomial_chaos(places: Floats, values: Floats, part: NDArray[np.intp]) -> Model:
    """Through *values*, (n,), of variance 1 at *places*, (n, factors), all of which are numbers.

    Polynomials are those of a hyperbolic norm of the degrees (0.8) of at most 12, 300 at most, selected by orthogonal
    matching pursuit as long as the error of leaving out each run in turn becomes less (Blatman and Sudret 2011).
    """
    terms = _Legendre(_degrees(places.shape[1]))
    basis = _product(terms.along(k, column) for k, column in enumerate(places.T))
    weights, errors = np.zeros((FOLDS, len(terms.degrees))), np.empty(len(values))
    for number in range(FOLDS):
        train = part != number
        selected = _pursuit(basis[train], values[train])
        weights[number, selected] = np.linalg.lstsq(basis[train][:, selected], values[train])[0]
        errors[~train] = values[~train] - basis[~train] @ weights[number]
    used = weights.any(axis=0)
    return Model("polynomial chaos", _Legendre(terms.degrees[used]), weights[:, used], errors)


def _degrees(width: int) -> NDArray[np.intp]:
    found: list[list[int]] = [[0] * width]
    for highest in range(1, _HIGHEST + 1):
        rows: list[list[int]] = [[]]
        for _ in range(width):
            longer = [[*row, degree] for row in rows for degree in range(highest + 1)]
            rows = [row for row in longer if sum(each**_NORM for each in row) <= highest**_NORM + 1e-9]
            if len(rows) > _MOST_TERMS:
                return np.array(found, dtype=np.intp)
        found = rows
    return np.array(found, dtype=np.intp)


def _pursuit(basis: Floats, values: Floats) -> list[int]:
    """The columns of *basis* that err least where each run is left out in turn, the constant first."""
    count, left, rest, leverage = len(values), basis.copy(), values.copy(), np.zeros(len(values))
    least = _ROUNDING * (basis**2).sum(axis=0)
    selected: list[int] = []
    best, known = np.inf, 0
    for size in range(1, min(basis.shape[1], count // 2, _MOST_SELECTED) + 1):
        squares = (left**2).sum(axis=0)
        gains = np.abs(rest @ left) / np.sqrt(np.maximum(squares, 1e-300))
        gains[squares <= least] = -1.0
        chosen = int(np.argmax(np.round(gains, _DIGITS))) if selected else 0
        direction = left[:, chosen] / np.sqrt(squares[chosen])
        selected.append(chosen)
        rest = rest - direction * (direction @ rest)
        left -= np.outer(direction, direction @ left)
        leverage += direction**2
        error = round(float(((rest / np.maximum(1 - leverage, 1e-9)) ** 2).mean()) * count / (count - size), 12)
        if error < best:
            best, known = error, size
        elif size - known >= _PATIENCE:
            break
    return selected[:known]


_ROUNDING = 1e-6


@dataclass(frozen=True, slots=True, eq=False)
class _Kernels:
    """``1 + relevance kernel(distance / length)`` of each factor to each of *points*, (terms, factors).

    The kernel is Matern's with nu = 5/2, or 1/2 if *rough*. Other levels, and a factor that is absent from one of two
    runs, are infinitely far.
    """

    points: Floats
    is_choice: Sequence[bool]
    rough: bool
    relevance: Floats
    length: float

    def along(self, factor: int, places: Floats) -> Floats:
        near = _distances(places, self.points[:, factor], self.is_choice[factor]) / self.length
        return np.asarray(1 + self.relevance[factor] * _kernel(near, self.rough)[0], dtype=np.float64)


def gaussian_process(
    places: Floats, values: Floats, part: NDArray[np.intp], is_choice: Sequence[bool], rough: bool
) -> Model:
    """Through *values*, (n,), of variance 1 at *places*, (n, factors), NaN where a factor is absent.

    Its kernel is that of an analysis of variance, a product of 1 + a kernel for each factor (Durrande et al. 2013). How
    much each matters, the common length and the noise are the likeliest by 150 of the runs.
    """
    few = np.sort(np.random.default_rng(_SEED).permutation(len(values))[:_MOST_LIKELY])
    found = _likeliest(places[few], values[few], is_choice, rough)
    terms = _Kernels(places, is_choice, rough, np.exp(found[:-2]), float(np.exp(found[-2])))
    covariance = _product(terms.along(k, column) for k, column in enumerate(places.T))
    covariance[np.diag_indices_from(covariance)] += np.exp(found[-1]) * covariance[0, 0]
    inverse = np.linalg.inv(covariance)
    whole = inverse @ values
    weights, errors = np.empty((FOLDS, len(values))), np.empty(len(values))
    # Leaving out a part takes no other inverse (Rasmussen and Williams 2006, 5.4.2).
    for number in range(FOLDS):
        test = np.flatnonzero(part == number)
        errors[test] = np.linalg.solve(inverse[np.ix_(test, test)], whole[test])
        weights[number] = whole - inverse[:, test] @ errors[test]
    return Model(f"a{' rough' * rough} Gaussian process", terms, weights, errors)


def _likeliest(places: Floats, values: Floats, is_choice: Sequence[bool], rough: bool) -> Floats:
    """Logarithms of relevances, length and noise, to three digits: on every machine the same."""
    from scipy.optimize import minimize

    apart = [_distances(c, c, choice) for c, choice in zip(places.T, is_choice, strict=True)]
    count, identity = len(values), np.eye(len(values))

    def cost(logs: Floats) -> tuple[float, Floats]:
        relevance, length, noise = np.exp(logs[:-2]), np.exp(logs[-2]), np.exp(logs[-1])
        kernels = [_kernel(each / length, rough) for each in apart]
        sums = [1 + theta * near for theta, (near, _) in zip(relevance, kernels, strict=True)]
        prior = _product(sums) / float(np.prod(1 + relevance))
        inverse = np.linalg.inv(prior + noise * identity)
        weights = inverse @ values
        square = float(values @ weights)
        shape = (inverse - np.outer(weights, weights) * count / square) / 2
        slopes = []
        shaped, longer = shape * prior, np.zeros_like(prior)
        for theta, (near, slope), each in zip(relevance, kernels, sums, strict=True):
            slopes.append(float((shaped * (theta * near / each - theta / (1 + theta))).sum()))
            longer += theta * slope / each
        slopes += [float((shaped * longer).sum()), noise * float(np.trace(shape))]
        return (count * np.log(square / count) - np.linalg.slogdet(inverse)[1]) / 2, np.array(slopes)

    start = np.array([0.0] * len(apart) + [np.log(0.3), np.log(1e-3)])
    bounds = [_RELEVANCE] * len(apart) + [_LENGTH, _NOISE]
    found = minimize(cost, start, jac=True, method="L-BFGS-B", bounds=bounds, options={"maxiter": _STEPS})
    return np.round(found.x, 3)


def _distances(first: Floats, second: Floats, is_choice: bool) -> Floats:
    apart = np.abs(first[:, None] - second)
    if is_choice:
        apart = np.where(apart > 0, _APART, 0.0)
    absent = np.isnan(first)[:, None], np.isnan(second)
    return np.where(absent[0] | absent[1], np.where(absent[0] & absent[1], 0.0, _APART), apart)


def _kernel(near: Floats, rough: bool) -> tuple[Floats, Floats]:
    """The kernel, and its derivative by the logarithm of the length."""
    if rough:
        found = np.exp(-near)
        return found, near * found
    near = np.sqrt(5) * near
    fall = np.exp(-near)
    return (1 + near + near**2 / 3) * fall, near**2 * (1 + near) / 3 * fall
