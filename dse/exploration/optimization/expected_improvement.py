"""Where designs are likely to be better, by what is known of others: Gaussian processes over choices and variables."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import cast

import numpy as np
from numpy.typing import NDArray

from dse.exploration.level_set import LevelSet, Shape, likeliest
from dse.exploration.optimization.designs import Cases, Design
from dse.exploration.optimization.fitness import Worth

Array = NDArray[np.float64]

_DIGITS = 6
"""Decimals of scores that are compared: the last bits of another machine do not matter."""

_TAIL = 0.05
"""What the sum of all objectives counts beside the worst one (Knowles 2006)."""

_FAR = -8.0
"""Standard deviations beyond which an improvement's expectation is taken from its asymptote."""


def encoded(designs: Sequence[Design], cases: Cases, alternatives: Mapping[str, tuple[str | None, ...]]) -> Array:
    """*designs* as points, (n, columns): the variables' places in the unit cube, then a column for each choice that can
    be made at a place, 1/√2 where it is; absent is a choice, too. Of two choices the second has none.

    So with lengths of their own for all columns, choices are related as by continuous relaxation (Halstrup 2016).
    """
    columns = [cases.units(designs)]
    for place, choices in alternatives.items():
        known = list(dict.fromkeys([*choices, None]))
        known = known[:1] if len(known) == 2 else known
        made = [design.architecture.choices.get(place) for design in designs]
        columns.append(np.array([[choice == each for each in known] for choice in made]) / np.sqrt(2.0))
    return np.hstack(columns)


def scalar(objectives: Array, weights: Array) -> Array:
    """Objectives, (n, m), as one, (n,), NaN where one is: Chebyshev's norm, augmented (Knowles 2006).

    Each is divided by its range first, and compressed where it jumps by orders of magnitude.
    """
    sound = objectives[np.isfinite(objectives).all(axis=1)]
    if not len(sound):
        return np.full(len(objectives), np.nan)
    middle = np.median(sound, axis=0)
    spread = np.median(np.abs(sound - middle), axis=0)
    even = np.arcsinh((objectives - middle) / np.where(spread > 0, spread, 1.0))
    if even.shape[1] == 1:
        return cast(Array, even[:, 0])
    least = np.nanmin(even, axis=0)
    width = np.nanmax(even, axis=0) - least
    weighted = weights * (even - least) / np.where(width > 0, width, 1.0)
    return cast(Array, weighted.max(axis=1) + _TAIL * weighted.sum(axis=1))


class ImprovementShapes:
    """The shapes of processes, by what they are of: found again when there is a quarter more to go by."""

    def __init__(self) -> None:
        self._known: dict[int, tuple[int, Shape]] = {}

    def through(self, what: int, points: Array, values: Array) -> LevelSet:
        """The process through *values*, (n,), at *points*, (n, d)."""
        number, shape = self._known.get(what, (0, None))
        if shape is None or len(shape.lengths) != points.shape[1] or 4 * len(points) > 5 * number:
            shape = likeliest(points, values)
            self._known[what] = len(points), shape
        return LevelSet.through(points, values, shape)


class Improvement:
    """How much *points*, (n, columns), of which so much is *known*, are likely to be improved on.

    *objective*, (n,), is what is to be small, NaN where there is none.
    """

    def __init__(self, points: Array, known: Worth, objective: Array, shapes: ImprovementShapes) -> None:
        varied = np.ptp(points, axis=0) > 0
        self._varied = varied if varied.any() else np.arange(points.shape[1]) < 1
        those = points[:, self._varied]
        self._requirements = [
            shapes.through(number, those[there], column[there])
            for number, column in enumerate(known.slack.T)
            if (there := np.isfinite(column)).any() and (column[there] <= 0).any()
        ]
        there = np.isfinite(objective)
        met = there & (known.violations == 0)
        self._least = float(objective[met].min()) if met.any() else None
        self._worth = shapes.through(-1, those[there], objective[there]) if met.any() else None

    def best(self, points: Array, number: int) -> list[int]:
        """The numbers of up to *number* of *points*, (m, columns), the most promising first.

        By expected improvement (Jones et al. 1998), times the probability that each requirement is met (Schonlau et al.
        1998); after each, as if it were known to be what it is believed to be. As long as no design meets all
        requirements, by the probability alone.
        """
        from scipy.special import log_ndtr

        those = points[:, self._varied]
        met = [one.at(those) for one in self._requirements]
        worth = self._worth.at(those) if self._worth else None
        least, found = self._least, list[int]()
        while len(found) < min(number, len(points)):
            score = sum((log_ndtr(one.mean / one.deviation) for one in met), np.zeros(len(points)))
            if worth is not None and least is not None:
                score = score + _log_improvement((least - worth.mean) / worth.deviation) + np.log(worth.deviation)
            score = np.round(score, _DIGITS)
            score[found] = -np.inf
            found.append(int(np.argmax(score)))
            for one in [*met, *([worth] if worth is not None else [])]:
                one.include(found[-1])
            if worth is not None and least is not None:
                least = min(least, float(worth.mean[found[-1]]))
        return found


def _log_improvement(z: Array) -> Array:
    """The logarithm of the expectation of max(z + normal, 0) (Ament et al. 2023)."""
    from scipy.special import ndtr

    near = np.maximum(z, _FAR)
    density = np.exp(-(near**2) / 2) / np.sqrt(2 * np.pi)
    exact = np.log(density + near * ndtr(near))
    far = np.minimum(z, _FAR)
    asymptote = -(far**2) / 2 - np.log(2 * np.pi) / 2 - 2 * np.log(-far)
    return cast(Array, np.where(z > _FAR, exact, asymptote))
