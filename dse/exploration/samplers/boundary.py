"""Runs where the verdicts change.

A Gaussian process goes through the margins of each requirement. The next run is the candidate after which the verdicts
of all doubtful points are expected to be clearest: p (1 - p), summed, decreases most.

Example: one variable on 0 .. 1, margins -0.3, 0.2 and -0.1 at 0, 0.5 and 1, and a length scale of 0.3.

    at                              0.1    0.3    0.5    0.8    0.9
    probability of a pass           0.01   0.57   1.00   0.58   0.29
    doubt that a run removes        0.40   0.78   0.00   0.92   0.77     (summed over 21 points)

The next run is at 0.8: the margin is as doubtful at 0.3, but more points near 0.8 are in doubt.

Cost: an ask of three requirements takes 0.3 s at 250 runs and 4.3 s at 1,950; a batch counts its own runs as known.
Measured against a grid, and against the processes of scikit-learn: docs/decisions/0025-boundary.md.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar

from pydantic import Field

from dse.domain.bench import Verdict
from dse.domain.sampler import Brief, Candidate, Outcomes, Placing, Point
from dse.errors import fail
from dse.exploration.variables import at_conditions, free, scaled, unit_of
from dse.loading import Plain, SamplerSection, Surroundings, read_number
from dse.units import DIMENSIONLESS

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from dse.exploration.surrogate import SurrogateAt, SurrogateShapes

    Array = NDArray[np.float64]

_MOST_SAMPLES = 2000
_POOL = 2048
# Half as many cost less accuracy, but missed a strip of 3 % of the ranges in two searches of ten.
_FILLING = 16
# A batch grows with what is known, which a few more runs change little: else many runs would take as many asks.
_GROWTH = 24
_CANDIDATES = 128
_DOUBTFUL = 512
_FITTED_AGAIN = 1.2
_SURE = 2
_DIGITS = 6


class Boundary(SamplerSection):
    """*samples* runs of every configuration: the *first* fill the ranges, then *batch* at a time, or more when many are
    there, go where they lessen the doubt about verdicts most; every sixteenth goes on filling.

    With an *accuracy* a configuration is done before that, once twice in a row no larger share of the ranges is
    believed to be misjudged. What is in doubt is told by Gaussian processes through the margins, and one that learns
    the region where a requirement has no margin (it was not exercised, the run failed). In a study that is extended,
    runs that are there are among the samples.
    """

    name: ClassVar[str] = "boundary"
    placing: ClassVar[Placing] = Placing.FIRST
    once: ClassVar[bool] = False
    grid: ClassVar[None] = None
    examples: ClassVar[tuple[Mapping[str, Any], ...]] = (
        {"samples": 24},
        {"samples": 11, "first": 4, "batch": 3},
        {"samples": 40, "accuracy": "2 %"},
    )

    # The time of an ask grows with the third power.
    samples: int = Field(ge=1, le=_MOST_SAMPLES)
    first: int = Field(default=16, ge=1)
    batch: int = Field(default=8, ge=1)
    accuracy: Plain = 0.0

    def settled(self, around: Surroundings) -> Boundary:
        """With the accuracy as a number; refused unless it is a share of the ranges."""
        where = around.place("accuracy")
        accuracy = read_number(self.accuracy, DIMENSIONLESS, where)
        if not 0 <= accuracy < 1:
            raise fail(f"an accuracy of {self.accuracy} is not a share of the ranges", where, "accuracy: 0.5 %")
        return self.model_copy(update={"accuracy": accuracy})

    def start(self, brief: Brief) -> _Search:
        """Refused without a requirement."""
        if not brief.earlier.margins:
            raise fail("the sampler 'boundary' needs a requirement, and the bench has none", None, "take 'sobol'")
        return _Search(self, brief)


class _Search:
    def __init__(self, sampler: Boundary, brief: Brief) -> None:
        self._sampler, self._brief = sampler, brief
        self._sequence = _Sequence(brief)
        # In their order. The first points of later blocks would not do: they share the leading bits of these.
        self._filling = self._sequence.draw()
        self._known = {name: _Known() for name in brief.configurations}
        for name, point in zip(brief.earlier.configurations, _rows(brief.earlier, brief), strict=True):
            if name in self._known and _fits(point, brief):
                self._known[name].there[point] = None

    def ask(self) -> Sequence[Candidate]:
        """What is there and the first points; then a batch for each configuration that is not done."""
        pool = self._sequence.draw()
        return [Candidate(name, point) for name, known in self._known.items() for point in self._wanted(known, pool)]

    def tell(self, outcomes: Outcomes) -> None:
        """Keep it, by configuration."""
        import numpy as np

        rows: dict[str, list[int]] = {name: [] for name in self._known}
        for row, name in enumerate(outcomes.configurations):
            rows[name].append(row)
        judged = {name: np.array([v in _JUDGED for v in verdicts]) for name, verdicts in outcomes.verdicts.items()}
        points = _rows(outcomes, self._brief)
        for name, known in self._known.items():
            known.told += [points[row] for row in rows[name]]
            for requirement, margins in outcomes.margins.items():
                told = np.where(judged[requirement], margins, np.nan)[rows[name]].tolist()
                known.margins.setdefault(requirement, []).extend(told)

    def _wanted(self, known: _Known, pool: Sequence[Point]) -> list[Point]:
        left = self._sampler.samples - len(known.points)
        if not known.points:
            more = self._sampler.first - len(known.there)
            wanted = [*known.there, *[p for p in self._filling if p not in known.there][: max(more, 0)]][:left]
        elif left and not known.is_done:
            wanted = self._doubtful(known, pool, left)
        else:
            wanted = []
        known.points.update(dict.fromkeys(wanted))
        return wanted

    def _doubtful(self, known: _Known, pool: Sequence[Point], left: int) -> list[Point]:
        from dse.exploration.surrogate import misjudged, single_threaded

        count = min(max(self._sampler.batch, len(known.points) // _GROWTH), left)
        filling = known.fresh(self._filling)[:count]
        candidates = list(dict.fromkeys((*filling, *known.fresh(pool))))
        if not candidates:
            return []
        with single_threaded():
            surrogates = self._surrogates(known, candidates)
            # At points that were drawn anew; where there is a run, nothing is misjudged.
            wrong = round(float(misjudged(surrogates)[len(filling) :].sum()) / len(pool), _DIGITS)
            known.sure = known.sure + 1 if wrong <= float(self._sampler.accuracy) else 0
            known.is_done = bool(self._sampler.accuracy) and known.sure >= _SURE
            return [] if known.is_done else self._batch(surrogates, candidates, len(known.points), count)

    def _surrogates(self, known: _Known, candidates: Sequence[Point]) -> list[SurrogateAt]:
        """Of each requirement, at *candidates*."""
        import numpy as np

        from dse.exploration.surrogate import Surrogate, shapes_of

        points, at = self._unit(known.told), self._unit(candidates)
        margins = {name: np.array(column) for name, column in known.margins.items()}
        if len(points) >= _FITTED_AGAIN * known.fitted:
            known.fitted = len(points)
            known.shapes = {name: shapes_of(points, column) for name, column in margins.items()}
        return [Surrogate.of(points, column, known.shapes[name]).at(at) for name, column in margins.items()]

    def _batch(
        self, surrogates: Sequence[SurrogateAt], candidates: Sequence[Point], there: int, count: int
    ) -> list[Point]:
        import numpy as np

        open_ = np.ones(len(candidates), dtype=np.bool_)
        chosen: list[Point] = []
        for number in range(there, there + min(count, len(candidates))):
            # The first of equals, in the order of the sequence, which fills the ranges.
            score = np.zeros(len(candidates)) if number % _FILLING == 0 else _score(surrogates)
            index = int(np.argmax(np.where(open_, score, -1.0)))
            open_[index] = False
            chosen.append(candidates[index])
            for surrogate in surrogates:
                surrogate.include(index)
        return chosen

    def _unit(self, points: Sequence[Point]) -> Array:
        import numpy as np

        return unit_of(np.array(points, dtype=np.float64), self._brief.variables)


class _Sequence:
    """Points of the brief's ranges, each at one of its conditions, a block at a time: a scrambled Sobol' sequence."""

    def __init__(self, brief: Brief) -> None:
        import numpy as np
        from scipy.stats import qmc

        self._brief, self._free = brief, free(brief)
        # With conditions, the last coordinate tells which.
        count = len(self._free) + bool(brief.conditions)
        self._sequence = qmc.Sobol(count, seed=np.random.default_rng(brief.seed))

    def draw(self) -> list[Point]:
        """The next that are allowed."""
        import numpy as np

        brief, unit = self._brief, self._sequence.random(_POOL)
        points = at_conditions(scaled(unit[:, : len(self._free)], self._free, brief.correlations), brief)
        if brief.conditions:
            which = (unit[:, -1] * len(brief.conditions)).astype(np.intp)
            points = points[np.arange(_POOL) * len(brief.conditions) + which]
        allowed = points if brief.allowed is None else points[brief.allowed(points)]
        return list(dict.fromkeys(tuple(row) for row in allowed.tolist()))


_JUDGED = (Verdict.PASS, Verdict.FAIL)


@dataclass(slots=True)
class _Known:
    """Of one configuration: points that were *there*, those asked for, what was *told* of them, NaN for no margin.

    A run is at other points than were asked for where its configuration does not have a variable.
    """

    there: dict[Point, None] = field(default_factory=dict)
    points: dict[Point, None] = field(default_factory=dict)
    told: list[Point] = field(default_factory=list)
    margins: dict[str, list[float]] = field(default_factory=dict)
    shapes: dict[str, SurrogateShapes] = field(default_factory=dict)
    fitted: int = 0
    sure: int = 0
    is_done: bool = False

    def fresh(self, points: Sequence[Point]) -> list[Point]:
        """Those of *points*, as a run would be at them, at which there is none."""
        asked, told = zip(*self.points, strict=True), zip(*self.told, strict=True)
        fixed = {i: now[0] for i, (was, now) in enumerate(zip(asked, told, strict=True)) if was != now}
        there = {*self.points, *self.told}
        moved = (tuple(fixed.get(i, value) for i, value in enumerate(point)) for point in points)
        return [point for point in dict.fromkeys(moved) if point not in there]


def _score(surrogates: Sequence[SurrogateAt]) -> Array:
    """How much less doubt about all verdicts a run at each point would leave; 0 where there is little doubt, (m,).

    Doubt counts where no other requirement surely fails. Rounded, so that the last bits of another machine do not
    matter.
    """
    import numpy as np

    passing = [1 - surrogate.failing() for surrogate in surrogates]
    others = [np.prod(passing[:i] + passing[i + 1 :], axis=0) for i in range(len(passing))]
    doubt = np.sum([surrogate.doubt() * other for surrogate, other in zip(surrogates, others, strict=True)], axis=0)
    order = np.argsort(-np.round(doubt, _DIGITS), kind="stable")[:_DOUBTFUL]
    asked = order[:_CANDIDATES]
    gains = [
        surrogate.relief(asked, order) @ np.broadcast_to(other, len(doubt))[order]
        for surrogate, other in zip(surrogates, others, strict=True)
    ]
    score = np.zeros(len(doubt))
    score[asked] = np.round(np.sum(gains, axis=0), _DIGITS)
    return score


def _rows(outcomes: Outcomes, brief: Brief) -> list[Point]:
    return list(zip(*(outcomes.points[variable.name].tolist() for variable in brief.variables), strict=True))


def _fits(point: Point, brief: Brief) -> bool:
    """Whether the study as it is now could ask for *point*."""
    import numpy as np

    for variable, value in zip(brief.variables, point, strict=True):
        if not variable.low <= value <= variable.high or (variable.values and value not in variable.values):
            return False
    return brief.allowed is None or bool(brief.allowed(np.array([point]))[0])


SAMPLER = Boundary
