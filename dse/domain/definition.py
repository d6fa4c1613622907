"""What was studied, as it is stored with the results: enough to show every result without the workspace.

Values are SI, units are given beside them by symbol. There is no path and no clock in it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from typing import Any

Json = Any
"""Plain data: what JSON can hold."""


@dataclass(frozen=True, slots=True)
class DefinedBench:
    """A bench by its name and title."""

    name: str
    title: str = ""


@dataclass(frozen=True, slots=True)
class DefinedDesign:
    """The design space; *places* are the paths of its decisions, in the order of the file."""

    name: str
    title: str = ""
    places: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class DefinedDistribution:
    """How likely the values of an uncertain variable are, as a `Distribution`."""

    kind: str
    numbers: Mapping[str, float] = field(default_factory=dict)
    values: tuple[float, ...] = ()


@dataclass(frozen=True, slots=True)
class DefinedVariable:
    """A design variable; *levels* is 0 where the study gives none. The rest as `DesignVariable` has it."""

    name: str
    title: str
    unit: str
    low: float
    high: float
    levels: int
    nominal: float
    scale: str = "linear"
    values: tuple[float, ...] = ()
    role: str = "design"
    distribution: DefinedDistribution | None = None
    labels: tuple[str, ...] = ()
    weights: tuple[float, ...] = ()

    def label(self, value: float) -> str:
        """What *value* is called; "" where it is a quantity, or none."""
        return self.labels[self.values.index(value)] if self.labels and value in self.values else ""


@dataclass(frozen=True, slots=True)
class DefinedObjective:
    """What is to be small, or with *maximize* large, as an `Objective` has it."""

    name: str
    maximize: bool = False
    is_total: bool = False
    is_composite: bool = False


@dataclass(frozen=True, slots=True)
class DefinedCorrelation:
    """Of two uncertain variables."""

    one: str
    other: str
    value: float


@dataclass(frozen=True, slots=True)
class DefinedSampler:
    """A sampler by the name it is found by, with its *options*.

    *slices* name the variables that are varied together where the points lie on a grid; None where they lie anywhere.
    No slices at all: one grid over all variables.
    """

    kind: str
    options: Mapping[str, Json] = field(default_factory=dict)
    slices: tuple[tuple[str, ...], ...] | None = None


@dataclass(frozen=True, slots=True)
class DefinedMetric:
    """A metric, or with *error_of* the error bar of another one. *expression* is as the user wrote it."""

    name: str
    title: str
    unit: str
    expression: str
    error_of: str = ""


@dataclass(frozen=True, slots=True)
class DefinedRequirement:
    """Bounds on a metric, in SI; *unit* is the one it is spoken of in. The rest as `Requirement` has it.

    Of a study on several benches it applies *on* these; () for all.
    """

    name: str
    title: str
    metric: str
    unit: str
    at_most: float | None = None
    at_least: float | None = None
    exercised_when: str | None = None
    met_in: float = 0.95
    on: tuple[str, ...] = ()
    text: str = ""
    source: str = ""
    rationale: str = ""
    severity: str = ""


@dataclass(frozen=True, slots=True)
class DefinedReplicates:
    """How many draws each run is made with, as `Replicates` has it."""

    at_least: int
    at_most: int
    confidence: float


@dataclass(frozen=True, slots=True)
class DefinedFigure:
    """A waveform against its target."""

    name: str
    title: str
    unit: str
    current: str
    target: str | None = None


@dataclass(frozen=True, slots=True)
class DefinedSimulation:
    """How each run was simulated, times in seconds; *method* is what is not plain about the algorithm."""

    stop: float
    step: float
    record_every: float
    method: Mapping[str, Json] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class DefinedTotal:
    """A sum of properties in a unit."""

    value: float
    unit: str


@dataclass(frozen=True, slots=True)
class DefinedLoad:
    """A *load* of functions, and the *capacity* of hosts for it, each of a name, in a unit."""

    load: str
    capacity: str
    unit: str
    loads: Mapping[str, float] = field(default_factory=dict)
    capacities: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class DefinedAllocation:
    """An allocation as a configuration has it: its path, the *hosts* and *functions* that are present in the order of
    the file, and the hosts that each function is executed *on*."""

    place: str
    hosts: tuple[str, ...]
    functions: tuple[str, ...]
    on: Mapping[str, tuple[str, ...]]
    loads: tuple[DefinedLoad, ...] = ()


@dataclass(frozen=True, slots=True)
class DefinedConfiguration:
    """A configuration: *choices* and *components* by path, *totals* by property, *constants* by ``part.parameter``.

    *start* are the start values by element, *inside* its texts and conversions, *wires* and *columns* what is
    connected and recorded. *streams* are the seeds that follow from a run's draw.
    """

    id: str
    choices: Mapping[str, str] = field(default_factory=dict)
    components: Mapping[str, str] = field(default_factory=dict)
    totals: Mapping[str, DefinedTotal] = field(default_factory=dict)
    constants: Mapping[str, float] = field(default_factory=dict)
    start: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    inside: Mapping[str, Json] = field(default_factory=dict)
    wires: tuple[str, ...] = ()
    columns: tuple[str, ...] = ()
    streams: tuple[str, ...] = ()
    allocations: tuple[DefinedAllocation, ...] = ()


@dataclass(frozen=True, slots=True)
class StudyDefinition:
    """A study with all that decides its results; *fmus* are the content hashes of its FMUs by name.

    *ignored* is what of their archives was passed over, as ``dse check`` tells it.

    *explored* are the configurations that the sampler is over, in this order; after an extension *configurations* may
    hold others, of which there are runs. Of a sampler that proposes configurations none are explored from the start:
    *space* says of which design space (a digest), and *configurations* are those it has asked for.

    *derived* parameters and *constraints* between variables are expressions as the user wrote them; *units* are those
    that these and other texts may use besides the usual ones. Of a study on several benches *simulation* is the first
    one's, *other_simulations* are those of the others by name.
    """

    study: str
    title: str
    bench: DefinedBench
    design: DefinedDesign
    variables: tuple[DefinedVariable, ...]
    sampler: DefinedSampler
    seed: int
    metrics: tuple[DefinedMetric, ...]
    requirements: tuple[DefinedRequirement, ...]
    simulation: DefinedSimulation
    configurations: tuple[DefinedConfiguration, ...]
    explored: tuple[str, ...]
    figures: tuple[DefinedFigure, ...] = ()
    fmus: Mapping[str, str] = field(default_factory=dict)
    ignored: tuple[str, ...] = ()
    keep_waveforms: str = ""
    dse: str = ""
    objectives: tuple[DefinedObjective, ...] = ()
    derived: Mapping[str, str] = field(default_factory=dict)
    constraints: tuple[str, ...] = ()
    correlations: tuple[DefinedCorrelation, ...] = ()
    space: str = ""
    other_simulations: Mapping[str, DefinedSimulation] = field(default_factory=dict)
    replicates: DefinedReplicates | None = None
    units: Mapping[str, str] = field(default_factory=dict)

    def configuration(self, name: str) -> DefinedConfiguration:
        """The configuration with the id *name*; KeyError if there is none."""
        for configuration in self.configurations:
            if configuration.id == name:
                return configuration
        raise KeyError(name)

    def differences(self, other: StudyDefinition) -> tuple[str, ...]:
        """What decides the result of a run and is not the same in both, sorted; () if runs of both fit together.

        Which points are simulated does not count, nor on which configurations, and no title.
        """
        mine, theirs = _deciding(self), _deciding(other)
        found = {key for key in mine if mine[key] != theirs[key]}
        ours = {configuration.id: configuration for configuration in self.configurations}
        if any(ours.get(c.id, c) != c for c in other.configurations):
            found.add("configurations")
        if any(self.fmus.get(name, digest) != digest for name, digest in other.fmus.items()):
            found.add("fmus")
        return tuple(sorted(found))

    def is_same_study(self, other: StudyDefinition) -> bool:
        """Whether both are of one study, whatever its files say, and made by one version of dse."""
        mine, theirs = _deciding(self), _deciding(other)
        return all(mine[key] == theirs[key] for key in ("study", "bench", "design", "dse"))

    def joined(self, later: StudyDefinition) -> StudyDefinition:
        """*later* with the configurations and FMUs that only this one has: those of runs that are there."""
        there = {configuration.id for configuration in later.configurations}
        gone = tuple(configuration for configuration in self.configurations if configuration.id not in there)
        return replace(
            later,
            configurations=(*later.configurations, *gone),
            fmus=dict(sorted({**self.fmus, **later.fmus}.items())),
            ignored=tuple(sorted({*self.ignored, *later.ignored})),
        )

    def samples_alike(self, other: StudyDefinition) -> bool:
        """Whether the samplers of both ask for the same runs."""
        return _sampling(self) == _sampling(other)


def _deciding(definition: StudyDefinition) -> dict[str, object]:
    return {
        "study": definition.study,
        "bench": definition.bench.name,
        "design": definition.design.name,
        "variables": [(variable.name, variable.unit) for variable in definition.variables],
        "metrics": [(metric.name, metric.expression, metric.error_of) for metric in definition.metrics],
        "requirements": [(r.name, r.metric, r.at_most, r.at_least, r.exercised_when) for r in definition.requirements],
        "figures": [(figure.name, figure.current, figure.target) for figure in definition.figures],
        "simulation": (definition.simulation, dict(definition.other_simulations)),
        "derived": dict(definition.derived),
        "units": dict(definition.units),
        "dse": definition.dse,
    }


def _sampling(definition: StudyDefinition) -> tuple[object, ...]:
    points = tuple(replace(variable, title="", unit="", weights=()) for variable in definition.variables)
    rules = definition.constraints, definition.correlations, definition.objectives
    draws = definition.seed, definition.replicates
    return points, *rules, definition.sampler, *draws, definition.explored, definition.space


def to_json(noun: Any) -> Json:
    """A noun of this module as plain data, with all its fields."""
    if noun is None or isinstance(noun, str | float | int):
        return noun
    if hasattr(noun, "__dataclass_fields__"):
        return {entry.name: to_json(getattr(noun, entry.name)) for entry in fields(noun)}
    if isinstance(noun, Mapping):
        return {key: to_json(value) for key, value in noun.items()}
    return [to_json(value) for value in noun]
