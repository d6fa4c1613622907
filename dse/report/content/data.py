"""What the report shows: plain values in display units, and nothing about where they came from."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, fields
from enum import StrEnum
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from dse.domain.definition import DefinedAllocation
from dse.domain.provenance import Provenance
from dse.domain.sampler import Role
from dse.errors import Problem
from dse.report.content.insight import Insight
from dse.units import shown

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]


class SamplerKind(StrEnum):
    """How the runs lie in the space of the design variables."""

    FULL_FACTORIAL = "full_factorial"
    SLICED = "sliced"
    SCATTERED = "scattered"


@dataclass(frozen=True, slots=True, eq=False)
class ReportVariable:
    """A design variable; *values* holds one number per run, in the unit shown (as do all bounds).

    Configurations that *lack* it are known by their places; their runs have the nominal value, to stand somewhere.
    *labels* are what the values 0, 1, … are called, if they are no quantities. *apart* are its values if nothing can be
    said of what is between them: names, or a few values that were listed one by one. Axes are logarithmic where the
    study samples it on a *log* scale.
    Its *role* is that of the study: ``design``, ``condition`` or ``uncertain``.
    """

    name: str
    title: str
    unit_symbol: str
    low: float
    high: float
    levels: int | None
    nominal: float
    values: Floats
    lack: tuple[int, ...] = ()
    labels: tuple[str, ...] = ()
    role: str = Role.DESIGN
    apart: tuple[float, ...] = ()
    log: bool = False

    def shown(self, value: float) -> str:
        """A value as a person reads it: what it is called, or a number with its unit."""
        return self.labels[int(value)] if self.labels else f"{shown(value)} {self.unit_symbol}".rstrip()


@dataclass(frozen=True, slots=True, eq=False)
class MetricColumn:
    """A metric; *values* holds one number per run in the unit shown, NaN where it is undefined.

    *error* has the error bars, NaN where none can be measured, if the study made some; of `Runs.checked` alone, if that
    is there.
    """

    name: str
    title: str
    unit_symbol: str
    values: Floats
    error: Floats | None = None


@dataclass(frozen=True, slots=True, eq=False)
class RequirementRow:
    """Bounds on *metric*, in its unit; *exercised* says for each run whether the requirement came into play.

    *unsettled*: finer numerics may change the verdict, whatever the margin. Where it is absent, that was not looked at.
    *draws*, (4, n): how many met it, of how many, and between which rates that leaves it, of which *met_in* is asked
    for; absent where no run was made with several. It *applies* to these runs; to all where that is absent. *level* is
    the place of its severity among those of the study, 0 for the highest.
    """

    name: str
    title: str
    metric: str
    at_most: float | None
    at_least: float | None
    exercised: Flags
    unsettled: Flags | None = None
    draws: Floats | None = None
    met_in: float = 1.0
    applies: Flags | None = None
    level: int = 0
    origin: tuple[tuple[str, str], ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class FigureSpec:
    """A waveform against its target, in the unit shown.

    *time* has n_t values in seconds. *kept* holds the numbers of the n_k runs whose waveforms are there;
    *current* is (n_k, n_t). *target* is absent, one constant per kept run (n_k,), or a waveform (n_k, n_t).
    """

    name: str
    title: str
    unit_symbol: str
    current_label: str
    target_label: str | None
    time: Floats
    kept: NDArray[np.int64]
    current: NDArray[np.floating]
    target: NDArray[np.floating] | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Runs:
    """One entry per run: its number, its configuration's id, whether it came to its end, and why not ("" if it did).

    *checked* are those that have error bars, if not all or none have.
    """

    numbers: NDArray[np.int64]
    configurations: tuple[str, ...]
    done: Flags
    problems: tuple[str, ...]
    checked: Flags | None = None

    def __len__(self) -> int:
        return len(self.numbers)


@dataclass(frozen=True, slots=True, eq=False)
class Draws:
    """The n runs that `Runs` are made of, where one stands for several draws.

    *rows*, (n,), are the places of the runs that they belong to; *draws*, (n,), are equal for the same noise, 0 for
    none. *values*, (m, n), are those of *metrics* in the unit shown; *judged*, (r, n), tells whether there is a verdict
    on each requirement.
    """

    rows: NDArray[np.int64]
    draws: NDArray[np.int64]
    metrics: tuple[str, ...]
    values: Floats
    judged: Flags


@dataclass(frozen=True, slots=True)
class Property:
    """A property of a configuration, in the unit shown."""

    value: float
    unit_symbol: str = ""


@dataclass(frozen=True, slots=True)
class ConfigurationEntry:
    """A configuration: *choices* by path in the design, *properties* by name.

    *parts* are the components it is simulated with, by path, with "" for what belongs to the bench; *links* are the
    pairs of parts between which there are connections, each pair once. Runs of a *noisy* one depend on its draw.
    """

    id: str
    choices: Mapping[str, str]
    properties: Mapping[str, Property]
    parts: Mapping[str, str] = field(default_factory=dict)
    links: tuple[tuple[str, str], ...] = ()
    noisy: bool = False
    allocations: tuple[DefinedAllocation, ...] = ()


@dataclass(frozen=True, slots=True)
class ObjectiveEntry:
    """What the study asks to be small, or with *maximize* large: a metric, or if *is_property* a property, by name."""

    name: str
    maximize: bool = False
    is_property: bool = False


@dataclass(frozen=True, slots=True)
class Retried:
    """What tries at *runs* came to that were made again; "" where nothing is told."""

    cause: str
    runs: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Scenes:
    """Runs can be seen in three dimensions: those *made* are beside the page, others ``dse report STUDY`` makes."""

    study: str
    made: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class ReportContent:
    """Everything the page and the figures are made from.

    *slices* are names of variables that were varied together, for a sliced study. *study_folder* is what the
    reader types in ``dse replay``; the page, which may be anywhere, leaves it out. *facts* are shown as they stand, in
    order. *missing* is what of the study could not be read, *insight* what its runs tell, for the page. *composites*
    are what objectives compute from metrics and properties, called as they are written. *notes* are what is kept with
    the study besides its runs, None if nothing is, *retried* the tries made again, *scenes* None where no run is one.
    *draws* are None where each run is one, or where they are too many for a page.
    Raises ValueError for what no study has. From here on the arrays cannot be written to, as many figures read them.
    """

    title: str
    sampler: SamplerKind
    study_folder: str
    runs: Runs
    configurations: tuple[ConfigurationEntry, ...]
    variables: tuple[ReportVariable, ...] = ()
    metrics: tuple[MetricColumn, ...] = ()
    requirements: tuple[RequirementRow, ...] = ()
    figures: tuple[FigureSpec, ...] = ()
    slices: tuple[tuple[str, ...], ...] = ()
    facts: tuple[tuple[str, str], ...] = ()
    missing: tuple[Problem, ...] = ()
    objectives: tuple[ObjectiveEntry, ...] = ()
    composites: tuple[MetricColumn, ...] = ()
    insight: Insight | None = None
    notes: Provenance | None = None
    retried: tuple[Retried, ...] = ()
    scenes: Scenes | None = None
    draws: Draws | None = None

    def __post_init__(self) -> None:
        if flaws := [*_flaws(self)]:
            raise ValueError("; ".join(flaws))
        nouns: list[Any] = [
            self.runs,
            *self.variables,
            *self.metrics,
            *self.requirements,
            *self.figures,
            *self.composites,
        ]
        for value in (getattr(noun, entry.name) for noun in nouns for entry in fields(noun)):
            if isinstance(value, np.ndarray):
                value.flags.writeable = False

    def variable(self, name: str) -> ReportVariable:
        """The variable called *name*; KeyError if there is none."""
        return _named(self.variables, name)

    def metric(self, name: str) -> MetricColumn:
        """The metric called *name*; KeyError if there is none."""
        return _named(self.metrics, name)

    def rows_of(self, configuration: str) -> NDArray[np.intp]:
        """Positions of the runs of one configuration."""
        return np.flatnonzero(np.array([name == configuration for name in self.runs.configurations], dtype=np.bool_))


_Noun = TypeVar("_Noun", "ReportVariable", "MetricColumn")


def label(title: str, unit_symbol: str) -> str:
    """*title* with its unit as an axis carries it: ``gap [m]``; a plain number reads ``[–]``."""
    return f"{title} [{unit_symbol or '–'}]"


def _named(nouns: Iterable[_Noun], name: str) -> _Noun:
    for noun in nouns:
        if noun.name == name:
            return noun
    raise KeyError(name)


def _flaws(content: ReportContent) -> Iterator[str]:
    """What a stored definition may hold that nothing can be drawn of; all else its reading refuses."""
    for variable in content.variables:
        if not variable.low < variable.high:
            yield f"variable '{variable.name}' has an empty range {variable.low} … {variable.high}"
    for requirement in content.requirements:
        if requirement.at_most is None and requirement.at_least is None:
            yield f"requirement '{requirement.name}' has no bound"
    known = {variable.name for variable in content.variables}
    for name in sorted({name for names in content.slices for name in names} - known):
        yield f"a slice names '{name}', which is not a variable of the study"
