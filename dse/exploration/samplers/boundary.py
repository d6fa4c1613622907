"""Runs where the verdicts change."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar

from pydantic import Field

from dse.domain.bench import Verdict
from dse.domain.sampler import Brief, Candidate, Outcomes, Point
from dse.errors import fail
from dse.exploration.variables import scaled, unit_of
from dse.loading import SamplerSection

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from dse.exploration.level_set import Posterior

    Array = NDArray[np.float64]

_MOST_SAMPLES = 2000
_POOL = 2048
_FILLING = 8
_DIGITS = 6


class Boundary(SamplerSection):
    """*samples* runs of every configuration: the *first* fill the ranges, then *batch* at a time go where a verdict is
    in doubt, every eighth goes on filling.

    What is in doubt is told by Gaussian processes through the margins, and through the distances to the region where a
    requirement has no margin (it was not exercised, the run failed). In a study that is extended, runs that are there
    are among the samples.
    """

    name: ClassVar[str] = "boundary"
    once: ClassVar[bool] = False
    grid: ClassVar[None] = None
    examples: ClassVar[tuple[Mapping[str, Any], ...]] = ({"samples": 24}, {"samples": 11, "first": 4, "batch": 3})

    # The time of an ask grows with the third power.
    samples: int = Field(ge=1, le=_MOST_SAMPLES)
    first: int = Field(default=16, ge=1)
    batch: int = Field(default=8, ge=1)

    def start(self, brief: Brief) -> _Search:
        """Refused without a requirement."""
        if not brief.earlier.margins:
            raise fail("the sampler 'boundary' needs a requirement, and the bench has none", None, "take 'sobol'")
        return _Search(self, brief)


class _Search:
    def __init__(self, sampler: Boundary, brief: Brief) -> None:
        import numpy as np
        from scipy.stats import qmc

        self._sampler, self._brief = sampler, brief
        self._sequence = qmc.Sobol(len(brief.variables), seed=np.random.default_rng(brief.seed))
        # In their order. The first points of later blocks would not do: they share the leading bits of these.
        self._filling = _points(self._sequence.random(_POOL), brief)
        self._known = {name: _Known() for name in brief.configurations}
        columns = [brief.earlier.points[variable.name].tolist() for variable in brief.variables]
        for name, *point in zip(brief.earlier.configurations, *columns, strict=True):
            inside = all(v.low <= value <= v.high for v, value in zip(brief.variables, point, strict=True))
            if inside and name in self._known:
                self._known[name].there[tuple(point)] = None

    def ask(self) -> Sequence[Candidate]:
        """What is there and the first points; then a batch for each configuration."""
        pool = _points(self._sequence.random(_POOL), self._brief)
        return [Candidate(name, point) for name, known in self._known.items() for point in self._wanted(known, pool)]

    def tell(self, outcomes: Outcomes) -> None:
        """Keep it, by configuration."""
        import numpy as np

        rows: dict[str, list[int]] = {name: [] for name in self._known}
        for row, name in enumerate(outcomes.configurations):
            rows[name].append(row)
        judged = {name: np.array([v in _JUDGED for v in verdicts]) for name, verdicts in outcomes.verdicts.items()}
        for name, known in self._known.items():
            for requirement, margins in outcomes.margins.items():
                told = np.where(judged[requirement], margins, np.nan)[rows[name]].tolist()
                known.margins.setdefault(requirement, []).extend(told)

    def _wanted(self, known: _Known, pool: Sequence[Point]) -> list[Point]:
        left = self._sampler.samples - len(known.points)
        filling = [point for point in self._filling if point not in known.points and point not in known.there]
        filling = filling[: max(self._sampler.first, self._sampler.batch)]
        fresh = list(dict.fromkeys((*filling, *(p for p in pool if p not in known.points and p not in known.there))))
        if not known.points:
            wanted = [*known.there, *fresh[: max(self._sampler.first - len(known.there), 0)]]
        else:
            wanted = self._doubtful(known, fresh, min(self._sampler.batch, left)) if left and fresh else []
        wanted = wanted[:left]
        known.points.update(dict.fromkeys(wanted))
        return wanted

    def _doubtful(self, known: _Known, pool: Sequence[Point], count: int) -> list[Point]:
        import numpy as np

        at = self._unit(pool)
        points = self._unit(list(known.points))
        first = self._sampler.first
        beliefs = [_Belief.of(points, _compressed(np.array(margins), first), at) for margins in known.margins.values()]
        open_ = np.ones(len(pool), dtype=np.bool_)
        chosen: list[Point] = []
        for number in range(len(known.points), len(known.points) + min(count, len(pool))):
            # Compared by a few digits, so that the last bits of another machine do not matter: the first of equals,
            # in the order of the sequence, which fills the ranges.
            score = np.zeros(len(pool)) if number % _FILLING == 0 else np.round(_score(beliefs), _DIGITS)
            index = int(np.argmax(np.where(open_, score, -1.0)))
            open_[index] = False
            chosen.append(pool[index])
            for belief in beliefs:
                belief.include(index)
        return chosen

    def _unit(self, points: Sequence[Point]) -> Array:
        import numpy as np

        return unit_of(np.array(points), self._brief.variables)


def _points(unit: Array, brief: Brief) -> list[Point]:
    return [tuple(row) for row in scaled(unit, brief.variables, brief.correlations).tolist()]


_JUDGED = (Verdict.PASS, Verdict.FAIL)


@dataclass(slots=True)
class _Known:
    """Of one configuration: points that were *there*, those asked for, and margins by requirement, NaN for none."""

    there: dict[Point, None] = field(default_factory=dict)
    points: dict[Point, None] = field(default_factory=dict)
    margins: dict[str, list[float]] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class _Belief:
    """Of one requirement over the pool: is there a margin, and is it positive?"""

    judged: Posterior
    margin: Posterior

    @classmethod
    def of(cls, points: Array, margins: Array, at: Array) -> _Belief:
        import numpy as np

        from dse.exploration.level_set import LevelSet, border

        judged = np.isfinite(margins)
        there = border(points, judged).at(at)
        # With no margin anywhere, nothing is in doubt but where there is one.
        rows = judged if judged.any() else ~judged
        return cls(there, LevelSet(points[rows], np.nan_to_num(margins[rows])).at(at))

    def failing(self) -> Array:
        """The probability that the requirement fails."""
        return self.judged.positive() * (1 - self.margin.positive())

    def doubt(self) -> Array:
        """What a run would tell about whether there is a margin and, where there is, about its sign."""
        return self.judged.doubt() + self.judged.positive() * self.margin.doubt()

    def include(self, index: int) -> None:
        """Another run of the batch goes to point *index* of the pool."""
        self.judged.include(index)
        self.margin.include(index)


def _score(beliefs: Sequence[_Belief]) -> Array:
    """Doubt about any requirement where the others do not surely fail."""
    import numpy as np

    passing = [1 - belief.failing() for belief in beliefs]
    others = [np.prod(passing[:i] + passing[i + 1 :], axis=0) for i in range(len(passing))]
    doubts = [belief.doubt() * other for belief, other in zip(beliefs, others, strict=True)]
    return np.asarray(np.sum(doubts, axis=0), dtype=np.float64)


def _compressed(margins: Array, first: int) -> Array:
    """Of either sign, linear up to the median of the *first*, logarithmic beyond: what is far off counts little."""
    import numpy as np

    few = margins[:first] if np.isfinite(margins[:first]).any() else margins
    size = np.abs(few[np.isfinite(few)])
    return np.asarray(np.arcsinh(margins / ((np.median(size) if size.any() else 0.0) or 1.0)), dtype=np.float64)


SAMPLER = Boundary
