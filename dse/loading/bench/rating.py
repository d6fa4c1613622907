"""Reads ratings: which test bench a test of a rating protocol is simulated on, and how."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from dse.domain.bench import Derived, TestBench
from dse.domain.expression import Expression
from dse.domain.sampler import DesignVariable, Role
from dse.errors import DseError, Location, Problems, closest, fail
from dse.expression import parse_expression
from dse.formats import Entry
from dse.loading.bench.candidates import Candidates, bench_candidates
from dse.loading.bench.study import FindBench
from dse.loading.bench.variables import Place, VariableSection, read_derived, read_variable_value
from dse.loading.include import read_document
from dse.loading.sections import Plain, Section, read_section
from dse.loading.values import read_quantity


class FollowingSection(Section):
    """A parameter that follows from others."""

    derived: str


class ChangingSection(Section):
    """A parameter of a robustness layer that changes by a quantity, or by a percentage."""

    change: str


Given = Plain | bool | FollowingSection
Varied = Plain | bool | ChangingSection
Layer = Plain | bool | Annotated[ChangingSection | dict[str, Varied], Field(union_mode="left_to_right")]


class RatedTestSection(Section):
    """How one test of the protocol, or a part of its cells, is simulated."""

    hints: ClassVar[Mapping[str, str]] = {"values": "values: {KPI of the protocol: metric of the bench}"}

    bench: str
    cells: dict[str, str]
    values: dict[str, str] = Field(min_length=1)
    parameters: dict[str, Given] = Field(default_factory=dict)
    where: str = ""


class RatingFile(Section):
    """``*.rating.yaml``."""

    rating: str
    title: str = ""
    protocol: str
    inputs: dict[str, str] = Field(default_factory=dict)
    tests: dict[str, RatedTestSection | list[RatedTestSection]]
    layers: dict[str, dict[str, Layer]] = Field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Written:
    """A word of the file that only the protocol has a meaning for, and where it stands."""

    text: str
    where: Location


@dataclass(frozen=True, slots=True)
class CellParameter:
    """A parameter of a bench whose value is the *attribute* of a cell of the protocol."""

    place: Place
    attribute: Written
    entry: Entry

    def value(self, text: str) -> float:
        """The parameter's value, SI, for a cell whose attribute is *text*, as ``30 km/h`` or ``25%``. Raises DseError
        at the parameter for another unit, or what the parameter does not allow."""
        items = {item.lower(): item for item in self.place.type.items}
        spaced = re.sub(r"(?<=\d)%", " %", text.strip())
        value = read_variable_value(self.place, self.entry, items.get(spaced.lower(), spaced))
        self.place.require_within(value, value, self.entry.where)
        return value


@dataclass(frozen=True, slots=True)
class Change:
    """What a robustness layer does to a parameter: *value* replaces it, is added to it, or is a share of it."""

    value: float
    kind: Literal["replaced", "added", "share"]
    entry: Entry

    def of(self, place: Place, value: float) -> float:
        """What becomes of *value*, SI, at *place*. Raises DseError if it is not allowed there."""
        changed = {"replaced": self.value, "added": value + self.value, "share": value * (1.0 + self.value)}[self.kind]
        place.require_within(changed, changed, self.entry.where)
        return changed


@dataclass(frozen=True, slots=True)
class Variation:
    """How runs with a robustness *layer* are made: in a *condition* of the protocol's, if it states several."""

    layer: Written
    condition: Written | None
    changes: Mapping[str, Change]

    @property
    def name(self) -> str:
        """What tells it from others."""
        return variation_name(self.layer.text, self.condition.text if self.condition else "")


def variation_name(layer: str, condition: str) -> str:
    """The name of the variation of a *layer* for a *condition*, or of the only one."""
    return f"{layer}: {condition}" if condition else layer


@dataclass(frozen=True, slots=True)
class RatedTest:
    """The cells of *test* that meet the *condition* are simulated on *bench*.

    *fixed* are further parameters of these runs, SI; *values* tells the metric for each KPI of the protocol.
    """

    test: Written
    bench: TestBench
    cells: tuple[CellParameter, ...]
    fixed: Mapping[str, float]
    derived: tuple[Derived, ...]
    values: Mapping[str, Written]
    places: Mapping[str, Place]
    """Where each parameter of *cells* and *fixed* is, and those of the variations that the bench has."""
    condition: Written | None = None
    variations: tuple[Variation, ...] = ()
    """Those of the robustness layers that the bench can express."""


@dataclass(frozen=True, slots=True)
class Rating:
    """A rating of the *protocol*'s package: *tests* on benches; *inputs* declare what no simulation tells.

    *layers* are the robustness layers that can be simulated, each with its conditions.
    """

    name: str
    title: str
    protocol: Written
    tests: tuple[RatedTest, ...]
    inputs: Mapping[str, Written]
    layers: tuple[tuple[Written, Written | None], ...]
    where: Location


def read_rating(path: Path, find_bench: FindBench, inside: Path) -> Rating:
    """One ``*.rating.yaml`` of the workspace *inside*. Raises DseError with every problem that the protocol's package
    is not needed to find."""
    entry = read_document(path, inside)
    file = read_section(entry, RatingFile)
    problems = Problems()
    variations = [
        variation
        for layer, settings in file.layers.items()
        for variation in _variations(Written(layer, entry["layers"][layer].key), entry["layers"][layer], settings)
    ]
    tests = []
    for name, given in file.tests.items():
        at = entry["tests"][name]
        several = given if isinstance(given, list) else [given]
        for number, section in enumerate(several):
            with problems:
                place = at[number] if isinstance(given, list) else at
                tests.append(_read_test(Written(name, at.key), place, section, variations, find_bench))
    known = {name for test in tests for name in test.places}
    for _, _, settings in variations if tests and not problems else ():
        for name, (at, _) in settings.items():
            if name not in known:
                problems.add(f"no bench of the rating has '{name}'", at.key, "name a parameter of a bench")
    if problems:
        raise DseError(*problems)
    return Rating(
        file.rating,
        file.title,
        Written(file.protocol, entry["protocol"].where),
        tuple(tests),
        {name: Written(text, entry["inputs"][name].where) for name, text in file.inputs.items()},
        tuple((layer, condition) for layer, condition, _ in variations),
        entry["rating"].where,
    )


WrittenVariation = tuple[Written, Written | None, dict[str, tuple[Entry, Varied]]]


def _variations(layer: Written, entry: Entry, settings: Mapping[str, Layer]) -> Iterator[WrittenVariation]:
    """The variations of a *layer*: one without a condition, and one for each condition."""
    alone = {name: (entry[name], given) for name, given in settings.items() if not isinstance(given, dict)}
    if alone:
        yield layer, None, alone
    for condition, given in settings.items():
        if isinstance(given, dict):
            at = entry[condition]
            yield layer, Written(condition, at.key), {name: (at[name], varied) for name, varied in given.items()}


def _read_test(
    test: Written,
    entry: Entry,
    section: RatedTestSection,
    variations: Sequence[WrittenVariation],
    find_bench: FindBench,
) -> RatedTest:
    bench = find_bench(section.bench, entry["bench"].where)
    components = bench_candidates(bench.design, bench.test_components)
    problems = Problems()
    cells: list[CellParameter] = []
    fixed: dict[str, float] = {}
    derived: list[Derived] = []
    places: dict[str, Place] = {}
    for name, attribute in section.cells.items():
        at = entry["cells"][name]
        with problems:
            places[name] = Place.of(at, components)
            cells.append(CellParameter(places[name], Written(attribute, at.where), at))
    for name, given in section.parameters.items():
        at = entry["parameters"][name]
        with problems:
            if name in section.cells:
                raise fail(f"'{name}' is under 'cells', too", at.key, "remove one")
            place = Place.of(at, components)
            if isinstance(given, FollowingSection):
                derived.append(read_derived(place, at, VariableSection(derived=given.derived)))
            else:
                places[name] = place
                fixed[name] = _value_of(place, at, given)
    known = [metric.name for metric in bench.metrics]
    for kpi, metric in section.values.items():
        if metric not in known:
            where = entry["values"][kpi].where
            problems.add(f"'{metric}' is not a metric of {bench.name}", where, closest(metric, known))
    varied: list[Variation] = []
    for layer, when, settings in variations:
        there = {name: found for name, (at, _) in settings.items() if (found := _place_if_any(at, components))}
        places |= there
        if there.keys() == settings.keys():
            with problems:
                changes = {name: _change_of(there[name], *setting) for name, setting in settings.items()}
                varied.append(Variation(layer, when, changes))
    if problems:
        raise DseError(*problems)
    values = {kpi: Written(metric, entry["values"][kpi].key) for kpi, metric in section.values.items()}
    condition = Written(section.where, entry["where"].where) if section.where else None
    return RatedTest(test, bench, tuple(cells), fixed, tuple(derived), values, places, condition, tuple(varied))


def _value_of(place: Place, entry: Entry, given: Plain | bool) -> float:
    value = read_variable_value(place, entry, given)
    place.require_within(value, value, entry.where)
    return value


def _change_of(place: Place, entry: Entry, given: Varied) -> Change:
    if not isinstance(given, ChangingSection):
        return Change(_value_of(place, entry, given), "replaced", entry)
    where = entry["change"].where
    quantity = read_quantity(given.change, where)
    value = float(quantity.si - quantity.unit.offset)  # 5 degC more are 5 K
    if quantity.unit.dimension == place.unit.dimension:
        return Change(value, "added", entry)
    if not quantity.unit.dimension:
        return Change(value, "share", entry)
    raise fail(f"'{place.name}' cannot change by {given.change}", where, "change: 10 %, or a quantity of its unit")


def _place_if_any(entry: Entry, components: Candidates) -> Place | None:
    """The place that *entry* names; None if the bench does not have it."""
    try:
        return Place.of(entry, components)
    except DseError:
        return None


def parse_condition(condition: Written, names: Mapping[str, str]) -> Expression:
    """The *condition* with each attribute of *names* called as the expression language can. Raises DseError."""
    text = condition.text
    for attribute in sorted(names, key=len, reverse=True):
        text = text.replace(attribute, names[attribute])
    return parse_expression(text, condition.where)


def case_variable(place: Place, values: set[float]) -> DesignVariable:
    """The variable of a study that takes *values*, SI, of which there is at least one."""
    known = tuple(sorted(values))
    labels = tuple(place.type.items[int(value)] for value in known) if place.type.items else ()
    return DesignVariable(
        place.name,
        known[0],
        known[-1] if len(known) > 1 else known[0] + 1.0,  # an axis of a report has a length
        len(known),
        known[0],
        place.unit,
        place.title(""),
        place.where,
        values=known,
        role=Role.DESIGN,
        labels=labels,
    )
