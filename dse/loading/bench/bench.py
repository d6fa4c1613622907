"""Reads test benches."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from math import prod
from pathlib import Path

from dse.domain.bench import Figure, TestBench, TestComponent
from dse.domain.component import Component, Value
from dse.domain.design import DesignSpace
from dse.domain.labels import array_of, element_names, is_part, shapes, spelled, tightened
from dse.domain.method import BONDS
from dse.errors import DseError, Location, Problem, Problems, closest, fail, raise_if_any
from dse.formats import Entry
from dse.loading.bench.candidates import (
    Candidates,
    bench_candidates,
    observable,
    outputs,
    settable,
    split_name,
    types_of,
)
from dse.loading.bench.inputs import INPUTS, InputSection, read_inputs
from dse.loading.bench.measures import MetricSection, RequirementSection, read_metrics, read_requirements
from dse.loading.bench.method import SimulationSection, read_positive, read_simulation
from dse.loading.component.kind import kind_of
from dse.loading.design.connections import instances_of, over_instances, read_connections, unknown_choices
from dse.loading.design.instances import Instances
from dse.loading.design.tree import FindComponent
from dse.loading.include import read_document
from dse.loading.names import check_name
from dse.loading.sections import Section, read_section
from dse.loading.values import Elements, Raw, read_elements, read_unit, read_value
from dse.units import DIMENSIONLESS, Unit

FindDesign = Callable[[str, Location], DesignSpace]
"""Returns the design space of that name, or raises DseError at the location."""


class TestComponentSection(Section):
    """A part of the bench."""

    component: str
    parameters: dict[str, Raw | Elements] = {}


class FigureSection(Section):
    """A waveform against its target."""

    current: str
    target: str | None = None
    unit: str | None = None
    title: str = ""


class BenchFile(Section):
    """``testbenches/*.yaml``."""

    testbench: str
    title: str = ""
    design: str
    test_components: dict[str, TestComponentSection] = {}
    connections: list[str] = []
    parameters: dict[str, Raw | Elements] = {}
    inputs: dict[str, InputSection] = {}
    simulation: SimulationSection
    metrics: dict[str, str | MetricSection] = {}
    requirements: dict[str, RequirementSection] = {}
    figures: dict[str, FigureSection] = {}


def read_bench(path: Path, find_component: FindComponent, find_design: FindDesign, inside: Path) -> TestBench:
    """One file of ``testbenches/`` of the workspace *inside*. Raises DseError with every problem in it."""
    entry = read_document(path, inside)
    file = read_section(entry, BenchFile)
    problems = Problems()
    stop = read_positive(entry["simulation"]["stop"], file.simulation.stop, "s", Problems()) or math.inf
    labels = _Labels(file.test_components, find_component)
    metrics = read_metrics(entry["metrics"], file.metrics, stop, labels.numbered, problems)
    named = any(section.on for section in file.requirements.values())
    known = {path.name.removesuffix(".yaml") for path in (inside / "testbenches").rglob("*.yaml")} if named else set()
    sections = {}
    for name, section in file.requirements.items():
        with problems:
            if _applies(entry["requirements"][name]["on"], section.on, file.testbench, known):
                sections[name] = section
    requirements, bounds = read_requirements(entry["requirements"], sections, file.metrics, metrics, problems)
    connections = read_connections(entry["connections"], file.connections, problems)
    try:
        design = find_design(file.design, entry["design"].where)
    except DseError as error:  # what is wrong in this file alone is told all the same
        read_simulation(entry["simulation"], file.simulation, None, problems)
        raise DseError(*error.problems, *problems) from None
    connections = over_instances(connections, design.root.parts, problems)
    problems += unknown_choices(connections, Instances(design.root).choices)
    parts = _test_components(entry["test_components"], file, find_component, design, problems)
    # What the bench would say of a part that could not be read follows from that, and is not said.
    unread = set(file.test_components) - {part.name for part in parts}
    fed = {name: section for name, section in file.inputs.items() if name.split(".")[0] not in unread}
    made = read_inputs(entry, fed, file.simulation.stop, design, parts, inside, problems)
    parts = (*parts, *made.parts)
    unread |= {INPUTS} if file.inputs and not made.parts else set()
    components = bench_candidates(design, parts)
    parameters: dict[str, Value] = {}
    for name, raw in file.parameters.items():
        if name.split(".")[0] not in unread:
            given = entry["parameters"][name]
            with problems:
                found: dict[str, Value] = {}
                for place in instances_of(name, design.root.parts):
                    found |= read_settings(place, raw, components, given)
                twice = [f"'{label}' is given a value twice" for label in found if label in parameters]
                raise_if_any(Problem(what, given.key, "remove one") for what in twice[:1])
                parameters |= found
    shown = observable(design, components)
    simulation = read_simulation(entry["simulation"], file.simulation, None if unread else components, problems)
    bonds = {f"{BONDS}.{name}" for name in file.simulation.bonds}
    for number, name in enumerate(file.simulation.record):
        if name.split(".")[0] not in unread and name not in bonds:
            with problems:
                _check_output(name, shown, entry["simulation"]["record"][number].where)
    if bonds and BONDS in {place.split(".")[0] for place in components}:
        what = f"a part is called '{BONDS}', so bonds cannot be distinguished from its ports"
        problems.add(what, entry["simulation"]["bonds"].key, "rename the part")
    figures = [
        _figure(entry["figures"][name], section, shown, unread, problems) for name, section in file.figures.items()
    ]
    raise_if_any(problems)
    return TestBench(
        file.testbench,
        design,
        parts,
        (*connections, *made.connections),
        parameters,
        simulation,
        (*metrics, *bounds),
        requirements,
        tuple(figures),
        file.title,
        entry["testbench"].where,
    )


def _check_output(name: str, components: Candidates, where: Location) -> None:
    """Raise DseError if *name* cannot be an entry of ``record``."""
    place, port = split_name(name, components, where)
    known = outputs(components[place])
    texts = [label for label, type_ in known.items() if label == port and not type_.kind.is_number]
    if texts:
        what = f"cannot record '{name}': waveforms are numbers, it is a {known[port].kind}"
        raise fail(what, where, "let a component make a number of it")
    if not any(is_part(label, port) for label in known):
        raise fail(f"cannot record '{name}': no such output", where, closest(port, known))


def _test_components(
    entries: Entry, file: BenchFile, find: FindComponent, design: DesignSpace, problems: Problems
) -> tuple[TestComponent, ...]:
    parts = []
    for name, section in file.test_components.items():
        entry = entries[name]
        check_name(name, entry.key, problems)
        if name in design.root.parts:
            problems.add(f"'{name}' is a part of the design already", entry.key, "rename it")
        with problems:
            component = find(section.component, entry["component"].where)
            values: dict[str, Value] = {}
            for parameter, raw in section.parameters.items():
                given = entry["parameters"][parameter]
                with problems:
                    found = read_settings(f"{name}.{parameter}", raw, {name: (component,)}, given)
                    values |= {label.removeprefix(f"{name}."): value for label, value in found.items()}
            parts.append(TestComponent(name, component, values, entry.key))
    return tuple(parts)


def _applies(entry: Entry, on: str | list[str], bench: str, known: set[str]) -> bool:
    """Whether a requirement *on* some of the *known* benches is one of this *bench*. DseError for an unknown one."""
    named = [on] if isinstance(on, str) else on
    for number, name in enumerate(named):
        if name not in (bench, *known):
            where = (entry if isinstance(on, str) else entry[number]).where
            raise fail(f"unknown test bench '{name}'", where, closest(name, known))
    return not named or bench in named


class _Labels:
    """Elements of arrays of test components, by name: ``traffic.states[CutIn]`` as ``traffic.states[12]``."""

    _LABELLED = re.compile(r"\b([^\W\d]\w*)\.([\w.]+)\[ *([^\W\d][^\]]*?) *\]")

    def __init__(self, sections: Mapping[str, TestComponentSection], find: FindComponent) -> None:
        self._sections, self._find = sections, find

    def numbered(self, text: str, where: Location) -> str:
        """*text* with numbers for the names of elements. Raises DseError for one that there is not."""
        return self._LABELLED.sub(
            lambda found: f"{found[1]}.{found[2]}[{self._number(found[1], found[2], found[3], where)}]", text
        )

    def _number(self, part: str, port: str, label: str, where: Location) -> int:
        if part not in self._sections:
            raise fail(f"'{part}' is not a test component, so '{part}.{port}[{label}]' has no meaning", where)
        component = self._find(self._sections[part].component, where)
        kind = kind_of(component)
        names = kind.labels(component, component.source).get(port, ()) if kind else ()
        found = [number for number, name in enumerate(names, 1) if name == label or name.endswith(f"/{label}")]
        if not found:
            raise fail(
                f"'{part}.{port}' has no element '{label}'", where, closest(label, [n.split("/")[-1] for n in names])
            )
        return found[0]


def _figure(
    entry: Entry, section: FigureSection, components: Candidates, unread: set[str], problems: Problems
) -> Figure:
    unit: Unit | None = None
    for key, signal in (("current", section.current), ("target", section.target)):
        if signal is not None and signal.split(".")[0] not in unread:
            with problems:
                (_, type_), *_ = types_of(signal, components, entry[key].where)
                unit = type_.unit if key == "current" else unit
    if section.unit is not None:
        where = entry["unit"].where
        with problems:
            wanted = read_unit(section.unit, where)
            if unit is not None and wanted.dimension != unit.dimension:
                found = str(unit) or "no unit"
                problems.add(f"'{section.current}' is in {found}, not in {wanted}", where)
            unit = wanted
    return Figure(entry.name, section.current, section.target, unit or DIMENSIONLESS, section.title, entry.key)


# Values that a bench gives to parameters and inputs: single ones, and those of a whole array.


def read_settings(name: str, raw: Raw | Elements, components: Candidates, entry: Entry) -> dict[str, Value]:
    """What stands at *entry* for ``part.parameter`` (or an input), by name: of an array a value for each element.

    A single value is for all elements. Raises DseError, also for another shape than the array has.
    """
    name = tightened(name)
    place, own = split_name(name, components, entry.key)
    named = [(*(p.name for p in c.parameters), *(p.name for p in c.interface.ports)) for c in components[place]]
    arrays = [[label.removeprefix(own) for label in labels if array_of(label) == own] for labels in named]
    wanted = {shapes(labels)[""] for labels in arrays if labels}
    if not wanted and isinstance(raw, list):
        raise fail(f"'{name}' is not an array, but is given a list", entry.where, "write one value")
    shape, values = read_elements(raw, entry)
    if wanted and not shape:
        shape = max(wanted)
        values *= prod(shape)
    if wanted and wanted != {shape}:
        theirs = " or ".join(map(spelled, sorted(wanted)))
        raise fail(f"'{name}' is given {spelled(shape)}, but is {theirs}", entry.where, "give a value for each element")
    return {
        label: read_setting(label, value, components, entry.key, where)
        for label, (value, where) in zip(element_names(name, shape), values, strict=True)
    }


def read_setting(name: str, raw: Raw, components: Candidates, key: Location, where: Location) -> Value:
    """The value *raw* for ``part.parameter`` (or an input): SI, checked against type and range. Raises DseError."""
    found = settable(name, components, key)
    values = {read_value(raw, type_, where) for _, type_ in found}
    if len(values) > 1:
        raise fail(f"'{raw}' means different values in the alternatives of '{name}'", where, "add a unit")
    (value,) = values
    port = split_name(name, components, key)[1]
    for component, _ in found:
        _check_range(component, port, value, where)
    return value


def _check_range(component: Component, port: str, value: Value, where: Location) -> None:
    """Raise DseError if *value* (SI) is outside the range of the component's parameter."""
    parameter = component.parameter(port)
    if parameter is None or isinstance(value, str | bool):
        return
    low, high, unit = parameter.minimum, parameter.maximum, parameter.type.unit
    if (low is not None and value < low) or (high is not None and value > high):
        shown = " … ".join("∞" if bound is None else f"{unit.from_si(bound):g}" for bound in (low, high))
        what = f"{port} = {unit.from_si(value):g} is outside its range {shown} {unit}".rstrip()
        raise fail(what, where, f"the range is set by component {component.name}")
