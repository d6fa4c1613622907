"""Downhill from the best of a few starts, within each configuration."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import partial
from typing import TYPE_CHECKING, Any, ClassVar

from pydantic import Field

from dse.domain.sampler import Architecture, Brief, Placing, Point
from dse.exploration.optimization.designs import Cases, Design
from dse.exploration.optimization.fitness import Worth
from dse.exploration.optimization.optimizing_sampler import OptimizingSampler, Proposer
from dse.exploration.variables import unit_of

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

_STEP = 0.1
"""Edge of a first simplex, as a share of the ranges."""

_VIOLATING = 1e30
_FORBIDDEN = 1e300
"""Only what is smaller counts: designs that violate requirements are above all others, by their violation."""


class Local(OptimizingSampler):
    """In each listed configuration, *starts* searches go downhill: simplices of Nelder and Mead 1965 with the
    coefficients of Gao and Han 2012, begun anew where they end until that moves them less than *accuracy*.

    They start from the best of *samples* points: the nominal one, and a Latin hypercube. All configurations and starts
    go on in turns. Only variables move. Each of several objectives is searched for on its own: the ends of the front.
    """

    name: ClassVar[str] = "local"
    proposes: ClassVar[bool] = False
    placing: ClassVar[Placing] = Placing.CHOSEN
    examples: ClassVar[tuple[Mapping[str, Any], ...]] = (
        {"evaluations": 60},
        {"evaluations": 40, "samples": 3, "starts": 1, "accuracy": 0.05},
    )

    samples: int = Field(default=8, ge=1, le=100_000)
    starts: int = Field(default=2, ge=1, le=100_000)
    accuracy: float = Field(default=1e-3, gt=0, lt=1)

    def proposer(self, brief: Brief, cases: Cases) -> Proposer:
        """Simplices."""
        return _Downhill(self, brief, cases)


class _Downhill:
    def __init__(self, sampler: Local, brief: Brief, cases: Cases) -> None:
        self._sampler, self._cases = sampler, cases
        self._configurations = [Architecture(name, {}) for name in brief.configurations]
        self._begin = _beginning(sampler.samples, brief.seed, cases)
        self._objectives = range(len(brief.objectives))
        self._values: dict[tuple[str, Point], tuple[float, ...]] = {}
        self._ways: list[_Way] | None = None
        self._asked: list[Design] = []

    def next(self) -> list[Design]:
        """Of all configurations the start points; then the next point of every search that has not come to its end."""
        if not self._asked:
            wanted = [Design(each, point) for point in self._begin for each in self._configurations]
        else:
            if self._ways is None:
                self._ways = [way for each in self._configurations for way in self._started(each)]
            wanted = [design for way in self._ways if (design := way.next()) is not None]
        self._asked = [design for design in wanted if self._cases.take(design)]
        return self._asked

    def tell(self, worth: Worth) -> None:
        """Remember what they are worth."""
        import numpy as np

        violations = worth.violations[:, None]
        ordered = np.where(violations > 0, _VIOLATING * (1 + violations), worth.objectives)
        for design, values in zip(self._asked, ordered.tolist(), strict=True):
            self._values[self._cases.key(design)] = tuple(values)

    def _started(self, architecture: Architecture) -> Iterator[_Way]:
        designs = [Design(architecture, point) for point in self._begin]
        for objective in self._objectives:
            worth = partial(self._worth, objective)
            known = [(worth(design), place) for place, design in enumerate(designs)]
            best = sorted((value, place) for value, place in known if value is not None)
            for _, place in best[: self._sampler.starts]:
                yield _Way(designs[place], worth, self._sampler.accuracy)

    def _worth(self, objective: int, design: Design) -> float | None:
        """What is known of it; None if it has to be run."""
        known = self._values.get(self._cases.key(design))
        if known is None:
            return None if self._cases.is_allowed(design) else _FORBIDDEN
        return known[objective]


class _Unknown(Exception):  # noqa: N818  # no error
    def __init__(self, point: Point) -> None:
        self.point = point


class _Way:
    """One search. scipy's asks for a value whenever it likes: so it goes its way again with all that is known, until it
    asks for what is not."""

    def __init__(self, start: Design, worth: Callable[[Design], float | None], accuracy: float) -> None:
        self._architecture, self._point = start.architecture, start.unit
        self._worth, self._accuracy = worth, accuracy
        self._is_over = not start.unit

    def next(self) -> Design | None:
        """What it has to know next; None at its end."""
        while not self._is_over:
            try:
                point = self._settled()
            except _Unknown as unknown:
                return Design(self._architecture, unknown.point)
            self._is_over = max(abs(a - b) for a, b in zip(point, self._point, strict=True)) <= self._accuracy
            self._point = point
        return None

    def _settled(self) -> Point:
        import numpy as np
        from scipy.optimize import minimize

        start = np.array(self._point)
        # Into the ranges, whichever end is near.
        steps = np.where(start + _STEP > 1, -_STEP, _STEP)
        options: Any = {
            "initial_simplex": np.vstack([start, start + np.diag(steps)]),
            "xatol": self._accuracy,
            "fatol": np.inf,
            "adaptive": True,
            "maxfev": np.inf,
            "maxiter": np.inf,
        }
        found = minimize(self._value, start, method="Nelder-Mead", bounds=[(0, 1)] * len(start), options=options)
        return tuple(found.x.tolist())

    def _value(self, point: Array) -> float:
        unit = tuple(point.tolist())
        worth = self._worth(Design(self._architecture, unit))
        if worth is None:
            raise _Unknown(unit)
        return worth


def _beginning(samples: int, seed: int, cases: Cases) -> list[Point]:
    import numpy as np
    from scipy.stats.qmc import LatinHypercube

    nominal = unit_of(np.array([[variable.nominal for variable in cases.variables]]), cases.variables)
    drawn = LatinHypercube(len(cases.variables), seed=np.random.default_rng(seed)).random(samples - 1)
    return [tuple(point) for point in [*np.clip(nominal, 0, 1).tolist(), *drawn.tolist()]]


SAMPLER = Local
