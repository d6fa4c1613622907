"""Reads ratings: which test bench a test of a rating protocol is simulated on, and how."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import ClassVar

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


class FollowingSection(Section):
    """A parameter that follows from others."""

    derived: str


Given = Plain | bool | FollowingSection


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
    layers: dict[str, dict[str, Plain | bool]] = Field(default_factory=dict)


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
    """Where each parameter of *cells* and *fixed* is, and those of the layers that the bench has."""
    condition: Written | None = None
    layers: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    """What the bench's runs are made with for each robustness layer that it can express, SI."""


@dataclass(frozen=True, slots=True)
class Rating:
    """A rating of the *protocol*'s package: *tests* on benches; *inputs* declare what no simulation tells.

    *layers* are the robustness layers that are simulated.
    """

    name: str
    title: str
    protocol: Written
    tests: tuple[RatedTest, ...]
    inputs: Mapping[str, Written]
    layers: tuple[Written, ...]
    where: Location


def read_rating(path: Path, find_bench: FindBench, inside: Path) -> Rating:
    """One ``*.rating.yaml`` of the workspace *inside*. Raises DseError with every problem that the protocol's package
    is not needed to find."""
    entry = read_document(path, inside)
    file = read_section(entry, RatingFile)
    problems = Problems()
    tests = []
    for name, given in file.tests.items():
        at = entry["tests"][name]
        several = given if isinstance(given, list) else [given]
        for number, section in enumerate(several):
            with problems:
                place = at[number] if isinstance(given, list) else at
                tests.append(_read_test(Written(name, at.key), place, section, file, entry["layers"], find_bench))
    for layer, settings in file.layers.items():
        for name in settings if tests and not problems else ():
            if not any(name in test.layers.get(layer, ()) for test in tests):
                what = f"no bench of the rating has '{name}'"
                problems.add(what, entry["layers"][layer][name].key, "name a parameter of a bench")
    if problems:
        raise DseError(*problems)
    return Rating(
        file.rating,
        file.title,
        Written(file.protocol, entry["protocol"].where),
        tuple(tests),
        {name: Written(text, entry["inputs"][name].where) for name, text in file.inputs.items()},
        tuple(Written(name, entry["layers"][name].key) for name in file.layers),
        entry["rating"].where,
    )


def _read_test(
    test: Written, entry: Entry, section: RatedTestSection, file: RatingFile, layers: Entry, find_bench: FindBench
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
    settings: dict[str, dict[str, float]] = {}
    for layer, parameters in file.layers.items():
        for name, value in parameters.items():
            at = layers[layer][name]
            with problems:
                if (found := _place_if_any(at, components)) is not None:
                    places[name] = found
                    settings.setdefault(layer, {})[name] = _value_of(found, at, value)
    if problems:
        raise DseError(*problems)
    whole = {layer: found for layer, found in settings.items() if found.keys() == file.layers[layer].keys()}
    values = {kpi: Written(metric, entry["values"][kpi].key) for kpi, metric in section.values.items()}
    condition = Written(section.where, entry["where"].where) if section.where else None
    return RatedTest(test, bench, tuple(cells), fixed, tuple(derived), values, places, condition, whole)


def _value_of(place: Place, entry: Entry, given: Plain | bool) -> float:
    value = read_variable_value(place, entry, given)
    place.require_within(value, value, entry.where)
    return value


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
        known[-1],
        len(known),
        known[0],
        place.unit,
        place.title(""),
        place.where,
        values=known,
        role=Role.DESIGN,
        labels=labels,
    )
