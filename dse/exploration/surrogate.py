"""What runs tell of a requirement's verdict at points where there is no run."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np

from dse.exploration.level_set import Array, LevelSet, Posterior, Rows, Shape, likeliest, thinned
from dse.exploration.region import informative, most_informative_shape, region

# How margins are compressed, in units of the median size of the first: plain, then more and more.
_COMPRESSED = (np.inf, 4.0, 1.0, 0.25)
_TYPICAL_OF = 16
_DIGITS = 4
_MOST = 2000


@dataclass(frozen=True, slots=True, eq=False)
class SurrogateShapes:
    """Of the region where a requirement has a margin, and of the margin, compressed beyond *scale*."""

    judged: Shape
    margin: Shape
    scale: float


@dataclass(frozen=True, slots=True, eq=False)
class Surrogate:
    """Of one requirement: is there a margin, and is it positive? No *judged* where every run has a margin."""

    judged: LevelSet | None
    margin: LevelSet

    @classmethod
    def of(cls, points: Array, margins: Array, shapes: SurrogateShapes) -> Surrogate:
        """From *margins*, (n,), at *points* of the unit cube, (n, d), n at least 1; NaN where there is none.

        Of more than 2,000 those that tell most are taken.
        """
        judged = np.isfinite(margins)
        where = None if judged.all() else region(points, judged, shapes.judged)
        # With no margin anywhere, no run tells one.
        rows, learnt = (judged, 1.0) if judged.any() else (~judged, 0.0)
        values = _compressed(np.nan_to_num(margins[rows]), shapes.scale)
        few = informative(points[rows], values >= 0, _MOST)
        return cls(where, LevelSet.through(points[rows][few], values[few], shapes.margin, learnt))

    def at(self, points: Array) -> SurrogateAt:
        """What is believed at *points*, (m, d)."""
        return SurrogateAt(None if self.judged is None else self.judged.at(points), self.margin.at(points))


def shapes_of(points: Array, margins: Array) -> SurrogateShapes:
    """The shapes that fit *margins*, (n,), at *points*, (n, d), NaN where there is none.

    Margins are compressed more and more as long as that raises the log density of each, held out, by all others.
    """
    judged = np.isfinite(margins)
    there, size = points[judged][thinned(judged.sum())], margins[judged][thinned(judged.sum())]
    region_shape, best, most = (
        most_informative_shape(points, judged),
        (Shape(np.ones(points.shape[1]), 1e-6), np.inf),
        -np.inf,
    )
    first = np.abs(margins[judged][:_TYPICAL_OF])
    typical = float(np.median(first) or first.max() or 1.0) if len(first) else 1.0
    for scale in (typical * factor for factor in (_COMPRESSED if len(first) else ())):
        values = _compressed(size, scale)
        shape = likeliest(there, values)
        density = LevelSet.through(there, values, shape).held_out() - np.log(np.hypot(size / scale, 1.0)).sum()
        if round(density, _DIGITS) <= most:
            break
        best, most = (shape, scale), round(density, _DIGITS)
    return SurrogateShapes(region_shape, *best)


@dataclass(frozen=True, slots=True, eq=False)
class SurrogateAt:
    """The surrogate at m points."""

    judged: Posterior | None
    margin: Posterior

    def has_margin(self) -> Array:
        """The probability that there is a margin, (m,)."""
        return np.ones(len(self.margin.mean)) if self.judged is None else self.judged.positive()

    def passing(self) -> Array:
        """The probability that the requirement is met, (m,)."""
        return self.has_margin() * self.margin.positive()

    def failing(self) -> Array:
        """The probability that it is not met although there is a margin, (m,)."""
        return self.has_margin() * (1 - self.margin.positive())

    def doubt(self) -> Array:
        """How much of a run's verdict is open, (m,): the variances of both bits, the sign's where there is one."""
        there, sign = self.has_margin(), self.margin.positive()
        return there * (1 - there) + there * sign * (1 - sign)

    def relief(self, asked: Rows, rows: Rows) -> Array:
        """By how much a run at each of the points *asked* lessens the doubt at *rows*, (asked, rows)."""
        lessened = self.has_margin()[rows] * self.margin.relief(asked, rows)
        return lessened if self.judged is None else lessened + self.judged.relief(asked, rows)

    def include(self, index: int) -> None:
        """Be as sure as if there were a run at that point, too."""
        self.margin.include(index)
        if self.judged is not None:
            self.judged.include(index)


def misjudged(surrogates: Sequence[SurrogateAt]) -> Array:
    """The probability that what is believed of all requirements together is wrong, (m,).

    They pass, one fails, or neither: one has no margin.
    """
    passing = np.prod([surrogate.passing() for surrogate in surrogates], axis=0)
    failing = 1 - np.prod([1 - surrogate.failing() for surrogate in surrogates], axis=0)
    return np.asarray(1 - np.maximum(np.maximum(passing, failing), 1 - passing - failing), dtype=np.float64)


@contextmanager
def single_threaded() -> Iterator[None]:
    """Linear algebra on one thread: so small, it is no faster on more, and on a busy machine they wait for each other.

    Sums also come in the same order on any number of processors.
    """
    import scipy.linalg  # noqa: F401  # loads its own library, which is limited only once it is there
    from threadpoolctl import threadpool_limits

    with threadpool_limits(limits=1, user_api="blas"):
        yield


def _compressed(margins: Array, scale: float) -> Array:
    """Of either sign linear up to *scale*, logarithmic beyond."""
    return margins if np.isinf(scale) else np.asarray(scale * np.arcsinh(margins / scale), dtype=np.float64)
