"""What runs tell of a requirement's verdict at points where there is no run."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np

from dse.exploration.level_set import Array, LevelSet, Posterior, Rows, Shape, likeliest
from dse.exploration.region import Bools, most_telling, region, telling

_SCALE_OF = 16
_MOST = 2000


@dataclass(frozen=True, slots=True, eq=False)
class Shapes:
    """Of the region where a requirement has a margin, and of the margin."""

    judged: Shape
    margin: Shape


@dataclass(frozen=True, slots=True, eq=False)
class Belief:
    """Of one requirement: is there a margin, and is it positive? No *judged* where every run has a margin."""

    judged: LevelSet | None
    margin: LevelSet

    @classmethod
    def of(cls, points: Array, margins: Array, shapes: Shapes) -> Belief:
        """From *margins*, (n,), at *points* of the unit cube, (n, d), n at least 1; NaN where there is none.

        Of more than 2,000 those that tell most are taken.
        """
        judged = np.isfinite(margins)
        where = None if judged.all() else region(points, judged, shapes.judged)
        rows, values = _known(margins)
        few = telling(points[rows], values >= 0, _MOST)
        # With no margin anywhere, no run tells one.
        learnt = 1.0 if judged.any() else 0.0
        return cls(where, LevelSet.through(points[rows][few], values[few], shapes.margin, learnt))

    def at(self, points: Array) -> BeliefAt:
        """What is believed at *points*, (m, d)."""
        return BeliefAt(None if self.judged is None else self.judged.at(points), self.margin.at(points))


def shapes_of(points: Array, margins: Array) -> Shapes:
    """The shapes that fit *margins*, (n,), at *points*, (n, d), NaN where there is none."""
    rows, values = _known(margins)
    return Shapes(most_telling(points, np.isfinite(margins)), likeliest(points[rows], values))


@dataclass(frozen=True, slots=True, eq=False)
class BeliefAt:
    """A belief at m points."""

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


def misjudged(beliefs: Sequence[BeliefAt]) -> Array:
    """The probability that what is believed of all requirements together is wrong, (m,).

    They pass, one fails, or neither: one has no margin.
    """
    passing = np.prod([belief.passing() for belief in beliefs], axis=0)
    failing = 1 - np.prod([1 - belief.failing() for belief in beliefs], axis=0)
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


def _known(margins: Array) -> tuple[Bools, Array]:
    """Rows with a margin, and these, of either sign linear up to the median of the first, logarithmic beyond.

    What is far off counts little. Of all runs the median would shrink as they crowd at the boundary. With no margin
    anywhere, all are 0.
    """
    rows = np.isfinite(margins)
    if not rows.any():
        return ~rows, np.zeros(len(margins))
    size = np.abs(margins[rows][:_SCALE_OF])
    return rows, np.asarray(np.arcsinh(margins[rows] / (np.median(size) or size.max() or 1.0)), dtype=np.float64)
