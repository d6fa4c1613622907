"""How much worse a metric is predicted when factors are mixed up: what they do together with others included.

Permutation importance (Breiman 2001) on runs that a model has not seen. For independent factors and a perfect
prediction, half of the error that mixing adds is the factor's total Sobol' index; what mixing two factors at once
changes beyond each of them by itself is what depends on both (Liu and Owen 2006).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from dse.analysis.data import Floats
from dse.analysis.probability import Interval

_NORMAL = 1.96
_MOST_TOGETHER = 3
_SEED = 0

Predict = Callable[[Floats], Floats]
"""Values (n, responses) at points (n, columns)."""


@dataclass(frozen=True, slots=True)
class Pair:
    """What of the variance depends on both of two factors, by their positions, and perhaps on more."""

    one: int
    other: int
    share: Interval


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """The runs that the model *predict* has not seen: *points*, *values*, (n, responses), and what each counts."""

    predict: Predict
    points: Floats
    values: Floats
    weights: Floats


class Mixing:
    """Factors, each some *columns* of the points, mixed up in *parts* of the runs, *mixes* times each.

    Factors that go together have the same columns: one of them mixed by itself would ask for designs that are none.
    """

    def __init__(self, columns: Sequence[Sequence[int]], parts: Sequence[Part], mixes: int = 1) -> None:
        self._columns, self._parts, self._mixes = columns, parts, mixes
        values = np.concatenate([part.values for part in parts])
        weights = np.concatenate([part.weights for part in parts])
        middle = np.average(values, axis=0, weights=weights)
        variance = np.average((values - middle) ** 2, axis=0, weights=weights)
        self._variance = np.where(variance > 0, variance, 1.0)
        self._told = [part.predict(part.points) for part in parts]
        self._usual = np.array([_square(*each) for each in zip(parts, self._told, strict=True)])
        self._once: list[list[Floats]] = []
        self._alone = [self._added(one) for one in columns]
        self._both: dict[tuple[int, int], Floats] = {}

    @property
    def explained(self) -> Floats:
        """The share of the variance that is predicted, (responses,)."""
        weights = [part.weights.sum() for part in self._parts]
        return np.asarray(1 - np.average(self._usual, axis=0, weights=weights) / self._variance)

    def totals(self, response: int) -> tuple[Interval, ...]:
        """The part of the variance that each factor has to do with, as the parts tell."""
        return tuple(_interval(alone[:, response]) for alone in self._alone)

    def pairs(self, response: int) -> tuple[Pair, ...]:
        """Of the three factors that matter most, what depends on two of them at once, most first."""
        totals = self.totals(response)
        most = sorted(range(len(totals)), key=lambda k: -round(totals[k].value, 9))[:_MOST_TOGETHER]
        found = []
        for one, other in combinations(sorted(most), 2):
            if {*self._columns[one]} & {*self._columns[other]}:
                continue
            if (one, other) not in self._both:
                self._both[one, other] = self._shared(one, other)
            found.append(Pair(one, other, _interval(self._both[one, other][:, response])))
        return tuple(sorted(found, key=lambda pair: -round(pair.share.value, 9)))

    def _added(self, columns: Sequence[int]) -> Floats:
        """Half of what mixing *columns* adds to the squared error, as a part of the variance, (parts, responses)."""
        wrong = np.empty((len(self._parts), len(self._variance)))
        self._once.append([])
        for number, part in enumerate(self._parts):
            told = [part.predict(points) for points in self._mixed(part, columns, self._mixes)]
            wrong[number] = np.mean([_square(part, each) for each in told], axis=0)
            self._once[-1].append(told[0])
        return np.asarray((wrong - self._usual) / (2 * self._variance), dtype=np.float64)

    def _shared(self, one: int, other: int) -> Floats:
        """A quarter of the mean square of what is left where both are mixed, as a part of the variance: (parts, …).

        Of what is predicted; where nothing depends on both, it is 0 without any chance.
        """
        columns = [*self._columns[one], *self._columns[other]]
        found = []
        for part, told, first, second in zip(self._parts, self._told, self._once[one], self._once[other], strict=True):
            (mixed,) = self._mixed(part, columns, 1)
            left = (told - first - second + part.predict(mixed)) ** 2
            found.append(np.average(left, axis=0, weights=part.weights) / (4 * self._variance))
        return np.asarray(found, dtype=np.float64)

    @staticmethod
    def _mixed(part: Part, columns: Sequence[int], times: int) -> Iterator[Floats]:
        # The same runs in place of each other, whatever is mixed: differences are then of what is mixed.
        random, chance = np.random.default_rng(_SEED), part.weights / part.weights.sum()
        for _ in range(times):
            mixed = part.points.copy()
            mixed[:, columns] = part.points[random.choice(len(chance), len(chance), p=chance)][:, columns]
            yield mixed


def _square(part: Part, told: Floats) -> Floats:
    """The mean square of the errors where that is *told* of the part, (responses,)."""
    return np.asarray(np.average((told - part.values) ** 2, axis=0, weights=part.weights), dtype=np.float64)


def _interval(added: Floats) -> Interval:
    """The mean over the parts, and 1.96 of its standard errors to either side."""
    mean, half = float(added.mean()), _NORMAL * float(added.std(ddof=1)) / len(added) ** 0.5
    return Interval(*np.clip([mean, mean - half, mean + half], 0.0, 1.0).tolist())
