"""What decides which runs a study makes: it is asked, told what came of them, and asked again."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, Protocol

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from dse.domain.bench import Verdict
    from dse.errors import Location
    from dse.units import Unit

Point = tuple[float, ...]
"""A value (SI) for each design variable, in their order."""

Grid = tuple[tuple[str, ...], ...]
"""Variables that are varied together, slice by slice, the others at their nominal values; () for all at once."""


@dataclass(frozen=True, slots=True)
class DesignVariable:
    """A parameter that is varied between *low* and *high* (SI).

    *levels* is the number of equidistant values a factorial takes; *nominal* is the value the variable has
    where a slice varies others.
    """

    name: str
    low: float
    high: float
    levels: int
    nominal: float
    unit: Unit
    title: str = ""
    where: Location | None = None


class Candidate(NamedTuple):
    """A run that a sampler wants: of one configuration, by its id, at one point."""

    configuration: str
    point: Point


@dataclass(frozen=True, slots=True, eq=False)
class Outcomes:
    """What came of n runs, in the order in which they were asked for; all in SI, by name, each (n,).

    *done* tells which came to their end; metrics and margins of the others are NaN, as those that are undefined.
    """

    configurations: tuple[str, ...]
    points: Mapping[str, NDArray[np.float64]]
    done: NDArray[np.bool_]
    metrics: Mapping[str, NDArray[np.float64]]
    margins: Mapping[str, NDArray[np.float64]]
    verdicts: Mapping[str, tuple[Verdict, ...]]

    def __len__(self) -> int:
        return len(self.configurations)


@dataclass(frozen=True, slots=True, eq=False)
class Brief:
    """What a sampler is given: what is varied on which configurations, and where random draws start.

    *earlier* are the runs that were there when the study was extended; none in a new study.
    """

    variables: tuple[DesignVariable, ...]
    configurations: tuple[str, ...]
    seed: int
    earlier: Outcomes


class Search(Protocol):
    """One study's sampling as it goes. The same brief and results must lead to the same asks: a study that was stopped
    is taken up by asking and telling again what is there."""

    def ask(self) -> Sequence[Candidate]:
        """The runs that are wanted next; none when the study is complete. A run that is there is not made again."""

    def tell(self, outcomes: Outcomes) -> None:
        """What came of the runs of the last ask, a row for each candidate."""


class Sampler(Protocol):
    """A kind of sampling with its options; frozen.

    *name* is what it is found by. With *once* it asks a single time and needs no results.
    """

    name: ClassVar[str]
    once: ClassVar[bool]

    @property
    def grid(self) -> Grid | None:
        """How the points lie on a grid of the variables' levels; None if they may lie anywhere."""

    def options(self) -> Mapping[str, Any]:
        """What it was given, as plain data: its entry in the stored definition."""

    def start(self, brief: Brief) -> Search:
        """The sampling of one study."""


class Once:
    """The search of a sampler that asks once, for *points* on every configuration."""

    def __init__(self, points: Iterable[Point], configurations: Sequence[str]) -> None:
        self._points = list(points)
        self._configurations = configurations

    def ask(self) -> Sequence[Candidate]:
        """Every point on the first configuration, then on the next; nothing the second time."""
        asked = [Candidate(name, point) for name in self._configurations for point in self._points]
        self._points = []
        return asked

    def tell(self, outcomes: Outcomes) -> None:
        """Nothing depends on results."""


@dataclass(frozen=True, slots=True)
class Nominal:
    """One run of every configuration, each variable at its nominal value: how a bench is run."""

    name: ClassVar[str] = "nominal"
    once: ClassVar[bool] = True

    @property
    def grid(self) -> Grid | None:
        """A grid of one point."""
        return ()

    def options(self) -> Mapping[str, Any]:
        """It has none."""
        return {}

    def start(self, brief: Brief) -> Search:
        """Asks once."""
        return Once([tuple(variable.nominal for variable in brief.variables)], brief.configurations)
