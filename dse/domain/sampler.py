"""What decides which runs a study makes: it is asked, told what came of them, and asked again."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, Protocol, overload

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from dse.domain.bench import Verdict
    from dse.domain.design import Configuration
    from dse.domain.distribution import Distribution
    from dse.errors import Location
    from dse.units import Unit

Point = tuple[float, ...]
"""A value (SI) for each design variable, in their order."""

Grid = tuple[tuple[str, ...], ...]
"""Variables that are varied together, slice by slice, the others at their nominal values; () for all at once."""


_SUM = re.compile(r"\bsum\(\s*(\w+)\s*\)")
_EXPECTED = re.compile(r"\bexpected\s*\(")


class Role(StrEnum):
    """Why a variable is varied: it is decided by the designer, every design has to do with it, or nobody knows it."""

    DESIGN = "design"
    CONDITION = "condition"
    UNCERTAIN = "uncertain"
    REPLICATE = "replicate"
    """The draw of all random numbers, which no sampler sees (`dse.domain.noise`)."""


class Placing(StrEnum):
    """Which runs of a sampler are drawn evenly over the space, so that shares of them are shares of it.

    Even means: over ranges by their scales, values and distributions, without what constraints exclude, and over the
    configurations that are explored.
    """

    EVEN = "even"
    """All; where the sampler has a grid, each with the space around it."""
    FIRST = "first"
    """Those of the first ask, before results lead the search."""
    CHOSEN = "chosen"
    """None: by rules of its own, or by the user."""


class Scale(StrEnum):
    """Along what a range is even."""

    LINEAR = "linear"
    LOG = "log"


@dataclass(frozen=True, slots=True)
class DesignVariable:
    """A parameter that is varied between *low* and *high* (SI).

    *levels* is the number of equidistant values (on its *scale*) a factorial takes; *nominal* is the value the variable
    has where a slice varies others. With *values* it has these only, sorted. A configuration need not have it.
    *low* and *high* of an uncertain one cut its *distribution* off. *labels* are what its values are called, if they
    are no quantities. *weights* of a condition say how much each of its values counts in an expected value; () if all
    count alike.
    """

    name: str
    low: float
    high: float
    levels: int
    nominal: float
    unit: Unit
    title: str = ""
    where: Location | None = None
    scale: Scale = Scale.LINEAR
    values: tuple[float, ...] = ()
    role: Role = Role.DESIGN
    distribution: Distribution | None = None
    labels: tuple[str, ...] = ()
    weights: tuple[float, ...] = ()


@dataclass(frozen=True, slots=True)
class Objective:
    """What is to be as small as can be, or with *maximize* as large.

    *name* is that of a metric, or of a property, whose total it is, or an expression in both.
    """

    name: str
    maximize: bool = False
    is_total: bool = False
    is_composite: bool = False

    @property
    def totals(self) -> tuple[str, ...]:
        """The properties whose sums it is computed from."""
        return (self.name,) if self.is_total else tuple(_SUM.findall(self.name)) if self.is_composite else ()

    @property
    def is_expected(self) -> bool:
        """Whether it is computed from an expected value over the cases of a design."""
        return self.is_composite and bool(_EXPECTED.search(self.name))

    def __str__(self) -> str:
        what = f"sum({self.name})" if self.is_total else self.name
        return f"{'maximize' if self.maximize else 'minimize'} {what}"


@dataclass(frozen=True, slots=True)
class Architecture:
    """The choices of a valid configuration by path; what is left out is not in it."""

    id: str
    choices: Mapping[str, str]


class Architectures(Protocol):
    """The valid configurations a study may explore, without a list of them."""

    @property
    def alternatives(self) -> Mapping[str, tuple[str | None, ...]]:
        """What can be chosen at each place, None for leaving it out, in the order of the file."""

    def count(self) -> int:
        """How many there are: exact, or an estimate where counting takes long."""

    def draw(self, number: int, seed: int) -> Sequence[Architecture]:
        """*number* of them, each as likely as any other."""

    def stratified(self, number: int, seed: int) -> Sequence[Architecture]:
        """*number* of them, in equal shares for the branches of each decision that brings others along."""

    def completed(self, wishes: Sequence[tuple[str, str | None]], seed: int) -> Architecture:
        """One that grants *wishes* in their order, each if it can still be had; what is left open is drawn."""

    def configuration(self, name: str) -> Configuration:
        """The configuration of an id that was given out."""


class Candidate(NamedTuple):
    """A run that a sampler wants: of one configuration, by its id, at one point."""

    configuration: str
    point: Point


@dataclass(frozen=True, slots=True, eq=False)
class Outcomes:
    """What came of n runs, in the order in which they were asked for; all in SI, by name, each (n,).

    *done* tells which came to their end; metrics and margins of the others are NaN, as those that are undefined.
    *totals* are sums of properties over their configurations. A variable that a configuration does not have is at its
    nominal value.
    """

    configurations: tuple[str, ...]
    points: Mapping[str, NDArray[np.float64]]
    done: NDArray[np.bool_]
    metrics: Mapping[str, NDArray[np.float64]]
    margins: Mapping[str, NDArray[np.float64]]
    verdicts: Mapping[str, tuple[Verdict, ...]]
    totals: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(self.configurations)


@dataclass(frozen=True, slots=True, eq=False)
class Brief:
    """What a sampler is given: what is varied on which configurations, and where random draws start.

    *earlier* are the runs that were there when the study was extended; none in a new study. A sampler that proposes
    configurations takes them from *space*, the others have a list. Every design is to be run at each of *conditions*,
    values of the variables that are conditions, in their order; () where there are none. *correlations* of uncertain
    variables are by their names.
    """

    variables: tuple[DesignVariable, ...]
    configurations: tuple[str, ...]
    seed: int
    earlier: Outcomes
    space: Architectures | None = None
    objectives: tuple[Objective, ...] = ()
    conditions: tuple[Point, ...] = ()
    correlations: Mapping[tuple[str, str], float] = field(default_factory=dict)
    allowed: Callable[[NDArray[np.float64]], NDArray[np.bool_]] | None = None
    """Tells of points, (n, variables), which may be asked for; None if all may."""


class Search(Protocol):
    """One study's sampling as it goes. The same brief and results must lead to the same asks: a study that was stopped
    is taken up by asking and telling again what is there."""

    def ask(self) -> Sequence[Candidate]:
        """The runs that are wanted next; none when the study is complete. A run that is there is not made again."""

    def tell(self, outcomes: Outcomes) -> None:
        """What came of the runs of the last ask, a row for each candidate."""


class Sampler(Protocol):
    """A kind of sampling with its options; frozen.

    *name* is what it is found by. With *once* it asks a single time and needs no results. With *proposes* it takes
    configurations from the brief's space, of which there may be any number, else from its list. *placing* decides what
    the study's findings say of the space.
    """

    name: ClassVar[str]
    once: ClassVar[bool]
    proposes: ClassVar[bool]
    placing: ClassVar[Placing]

    @property
    def grid(self) -> Grid | None:
        """How the points lie on a grid of the variables' levels; None if they may lie anywhere."""

    def options(self) -> Mapping[str, Any]:
        """What it was given, as plain data: its entry in the stored definition."""

    def start(self, brief: Brief) -> Search:
        """The sampling of one study."""


class Everywhere(Sequence[Candidate]):
    """Every one of *points*, (n, variables), on the first of *configurations*, then on the next: n of each in a row.

    As nouns, a million of them would take a third of a gigabyte.
    """

    def __init__(self, points: NDArray[np.float64], configurations: Sequence[str]) -> None:
        self.points = points
        self.configurations = configurations

    def __len__(self) -> int:
        return len(self.points) * len(self.configurations)

    @overload
    def __getitem__(self, index: int) -> Candidate: ...
    @overload
    def __getitem__(self, index: slice) -> Sequence[Candidate]: ...
    def __getitem__(self, index: int | slice) -> Candidate | Sequence[Candidate]:
        if isinstance(index, slice):
            return [self[number] for number in range(*index.indices(len(self)))]
        configuration, row = divmod(range(len(self))[index], len(self.points))
        return Candidate(self.configurations[configuration], tuple(self.points[row].tolist()))


class OneShot:
    """The search of a sampler that asks once, for *points*, (n, variables), on every configuration."""

    def __init__(self, points: NDArray[np.float64], configurations: Sequence[str]) -> None:
        self._asked: Sequence[Candidate] = Everywhere(points, configurations)

    def ask(self) -> Sequence[Candidate]:
        """Every point on the first configuration, then on the next; nothing the second time."""
        asked, self._asked = self._asked, ()
        return asked

    def tell(self, outcomes: Outcomes) -> None:
        """Nothing depends on results."""


@dataclass(frozen=True, slots=True)
class Nominal:
    """One run of every configuration, each variable at its nominal value: how a bench is run."""

    name: ClassVar[str] = "nominal"
    once: ClassVar[bool] = True
    proposes: ClassVar[bool] = False
    placing: ClassVar[Placing] = Placing.EVEN

    @property
    def grid(self) -> Grid | None:
        """A grid of one point."""
        return ()

    def options(self) -> Mapping[str, Any]:
        """It has none."""
        return {}

    def start(self, brief: Brief) -> Search:
        """Asks once."""
        import numpy as np

        return OneShot(np.array([[variable.nominal for variable in brief.variables]]), brief.configurations)
