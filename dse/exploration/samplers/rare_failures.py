"""Runs that fail, however rare they are: how large their share of the space is, and the mildest of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, ClassVar

from pydantic import Field

from dse.domain.bench import Verdict
from dse.domain.sampler import Brief, Candidate, Outcomes, Placing, Point
from dse.errors import closest, fail
from dse.exploration.variables import scaled, unit_of
from dse.loading import SamplerSection

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from dse.exploration.rare_event import Probability

    Array = NDArray[np.float64]

_STEPS = 16
_EDGE = 1e-12


class RareFailures(SamplerSection):
    """Batches of *batch* runs of every configuration are led to the runs that fail the *requirement* (needed if there
    are several), in at most *levels* batches; the *last* runs give the share of the space that fails, with an interval
    (`dse.exploration.rare_event`). Sixteen more are on the way from the nearest of the failures to the nominal values.

    What leads them is the margin. Where it is the same in all runs that pass, as an impact speed of 0 is, *along* names
    a metric that decreases towards a failure, as the least gap.
    """

    name: ClassVar[str] = "rare_failures"
    placing: ClassVar[Placing] = Placing.CHOSEN
    once: ClassVar[bool] = False
    grid: ClassVar[None] = None
    examples: ClassVar[tuple[Mapping[str, Any], ...]] = (
        {},
        {"requirement": "R", "along": "m", "batch": 20, "last": 30, "levels": 4},
    )

    requirement: str = ""
    along: str = ""
    batch: int = Field(default=200, ge=10, le=100_000)
    last: int = Field(default=400, ge=10, le=100_000)
    levels: int = Field(default=15, ge=1, le=100)

    def start(self, brief: Brief) -> RareFailuresSearch:
        """Refused without the requirement or metric it names, with conditions, and with constraints."""
        known = list(brief.earlier.margins)
        if self.requirement not in known and (self.requirement or len(known) != 1):
            what = f"the sampler '{self.name}' needs a requirement, one of {', '.join(known) or 'none'}"
            raise fail(what, None, closest(self.requirement, known) or f"requirement: {(known or ['R1'])[0]}")
        if self.along and self.along not in brief.earlier.metrics:
            raise fail(f"unknown metric '{self.along}'", None, closest(self.along, brief.earlier.metrics))
        if brief.conditions or brief.allowed is not None:
            what = f"the sampler '{self.name}' has no meaning with conditions or constraints"
            raise fail(what, None, "vary the conditions as 'design_variables' or 'uncertain'")
        return RareFailuresSearch(self, brief, self.requirement or known[0])


class RareFailuresSearch:
    """The search of a `RareFailures`, about *requirement*."""

    def __init__(self, sampler: RareFailures, brief: Brief, requirement: str) -> None:
        import numpy as np

        from dse.exploration.rare_event import RareEvent

        self.requirement = requirement
        self._sampler, self._brief = sampler, brief
        shape = len(brief.variables), sampler.batch, sampler.last, sampler.levels
        seeds = [np.random.default_rng([brief.seed, number]) for number in range(len(brief.configurations))]
        self._events = {name: RareEvent(*shape, seed) for name, seed in zip(brief.configurations, seeds, strict=True)}
        self._asked: dict[str, tuple[Array, list[Point]]] = {}
        self._failing: dict[str, list[tuple[float, Point]]] = {name: [] for name in self._events}
        self._is_mild = False
        nominal = np.array([[variable.nominal for variable in brief.variables]])
        self._nominal = _normal(np.clip(unit_of(nominal, brief.variables), 0, 1))[0]

    def probability(self, configuration: str) -> Probability | None:
        """The share of the space that fails; None before the search has ended."""
        return self._events[configuration].probability if self._is_mild else None

    def mildest(self, configuration: str) -> Point | None:
        """The failing point nearest to the nominal values, None if there is none."""
        return min(self._failing[configuration], default=(0.0, None))[1]

    def ask(self) -> Sequence[Candidate]:
        """The next batch of each one that has not ended; then those on the way to the nominal values."""
        from dse.exploration.surrogate import single_threaded

        with single_threaded():
            wanted = {name: event.ask() for name, event in self._events.items()}
        if not any(map(len, wanted.values())) and not self._is_mild:
            self._is_mild = True
            wanted = {name: self._way(name) for name in self._events}
        self._asked = {name: (points, self._points(points)) for name, points in wanted.items() if len(points)}
        return self._candidates()

    def tell(self, outcomes: Outcomes) -> None:
        """Scores of the batch, by configuration."""
        import numpy as np

        from dse.exploration.surrogate import single_threaded

        scores = dict(zip(self._candidates(), self._scores(outcomes).tolist(), strict=True))
        for name, (normal, points) in self._asked.items():
            own = np.array([scores[Candidate(name, point)] for point in points])
            away = np.round(((normal - self._nominal) ** 2).sum(axis=1), 9)
            failing = own < 0
            self._failing[name] += [(away.item(k), points[k]) for k in np.flatnonzero(failing).tolist()]
            if not self._is_mild:
                with single_threaded():
                    self._events[name].tell(normal, own)

    def _candidates(self) -> list[Candidate]:
        """The runs of the last ask, each once."""
        return [Candidate(name, point) for name, (_, all_) in self._asked.items() for point in dict.fromkeys(all_)]

    def _scores(self, outcomes: Outcomes) -> Array:
        """Negative where the requirement fails, infinite where it has no verdict."""
        import numpy as np

        margins, tiny = outcomes.margins[self.requirement], np.finfo(np.float64).tiny
        passing = outcomes.metrics[self._sampler.along] if self._sampler.along else margins
        verdicts = np.array([str(each) for each in outcomes.verdicts[self.requirement]], dtype=np.str_)
        scores = np.where(verdicts == Verdict.PASS, np.maximum(np.nan_to_num(passing, nan=np.inf), tiny), np.inf)
        return np.where(verdicts == Verdict.FAIL, np.minimum(np.nan_to_num(margins, nan=-1.0), -tiny), scores)

    def _points(self, normal: Array) -> list[Point]:
        from scipy.special import ndtr

        values = scaled(ndtr(normal).clip(_EDGE, 1 - _EDGE), self._brief.variables, self._brief.correlations)
        return [tuple(row) for row in values.tolist()]

    def _way(self, name: str) -> Array:
        """Points on the straight way from the mildest failure to the nominal values, without its ends."""
        import numpy as np

        point = self.mildest(name)
        if point is None:
            return np.zeros((0, len(self._nominal)))
        start = _normal(unit_of(np.array([point]), self._brief.variables))[0]
        parts = np.arange(1, _STEPS + 1)[:, None] / (_STEPS + 1)
        return np.asarray(start + parts * (self._nominal - start))


def _normal(unit: Array) -> Array:
    """Standard normal numbers for places in the unit cube; its edges are at ±7."""
    import numpy as np
    from scipy.special import ndtri

    return np.asarray(ndtri(unit.clip(_EDGE, 1 - _EDGE)), dtype=np.float64)


SAMPLER = RareFailures
