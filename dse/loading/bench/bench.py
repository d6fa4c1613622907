"""Reads test benches."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path

from dse.domain.bench import Figure, Metric, Requirement, TestBench, TestComponent
from dse.domain.component import Causality, Component, Value
from dse.domain.design import DesignSpace
from dse.domain.method import BONDS
from dse.errors import DseError, Location, Problem, closest, raise_if_any
from dse.expression.parse import parse_expression
from dse.formats.yaml import Document, Path_
from dse.loading.bench.method import read_method
from dse.loading.bench.simulation import read_simulation
from dse.loading.design.connections import read_connections
from dse.loading.design.tree import FindComponent
from dse.loading.documents import BenchFile, FigureSection, RequirementSection
from dse.loading.fields import read_section
from dse.loading.include import read_document
from dse.loading.names import check_name
from dse.loading.places import candidates, is_output, settable, split_name, types_of
from dse.loading.values import Raw, read_quantity, read_unit, read_value
from dse.units import DIMENSIONLESS, Unit

FindDesign = Callable[[str, Location], DesignSpace]
"""Returns the design space of that name, or raises DseError at the location."""


def read_bench(
    path: Path, find_component: FindComponent, find_design: FindDesign, inside: Path | None = None
) -> TestBench:
    """One file of ``testbenches/`` of the workspace *inside*. Raises DseError with every problem in it."""
    document = read_document(path, inside)
    file = read_section(document, BenchFile)
    design = find_design(file.design, document.place(("design",)))
    problems: list[Problem] = []
    parts = _test_components(document, file, find_component, design, problems)
    components = candidates(design, parts)
    # What the bench would say of a part that could not be read follows from that, and is not said.
    unread = set(file.test_components) - {part.name for part in parts}
    parameters: dict[str, Value] = {}
    for name, raw in file.parameters.items():
        at: Path_ = ("parameters", name)
        if name.split(".")[0] in unread:
            continue
        try:
            parameters[name] = setting(name, raw, components, document.key(at), document.place(at))
        except DseError as error:
            problems += error.problems
    simulation = read_simulation(document, file.simulation, problems)
    if not unread:
        method = read_method(document, file.simulation, simulation.step, components, problems)
        simulation = replace(simulation, method=method, check_step=file.simulation.check_step)
    bonds = {f"{BONDS}.{name}" for name in file.simulation.bonds}
    for number, name in enumerate(file.simulation.record):
        if name.split(".")[0] not in unread and name not in bonds:
            problems += _recording(name, components, document.place(("simulation", "record", number)))
    if bonds and BONDS in {place.split(".")[0] for place in components}:
        what = f"a part is called '{BONDS}', so bonds cannot be told from its ports"
        problems.append(Problem(what, document.key(("simulation", "bonds")), "rename the part"))
    metrics = _metrics(document, file, problems)
    requirements = []
    for name, section in file.requirements.items():
        try:
            requirements.append(_requirement(document, name, section, set(file.metrics)))
        except DseError as error:
            problems += error.problems
    figures = [_figure(document, name, section, components, unread, problems) for name, section in file.figures.items()]
    connections = read_connections(document, ("connections",), file.connections, problems)
    raise_if_any(problems)
    return TestBench(
        file.testbench,
        design,
        parts,
        connections,
        parameters,
        simulation,
        metrics,
        tuple(requirements),
        tuple(figures),
        file.title,
        document.place(("testbench",)),
    )


def setting(
    name: str, raw: Raw, components: Mapping[str, tuple[Component, ...]], key: Location, where: Location
) -> Value:
    """The value *raw* for ``part.parameter`` (or an input): SI, checked against type and range. Raises DseError."""
    found = settable(name, components, key)
    values = {read_value(raw, type_, where) for _, type_ in found}
    if len(values) > 1:
        raise DseError(Problem(f"'{raw}' means different values in the alternatives of '{name}'", where, "add a unit"))
    (value,) = values
    port = split_name(name, components, key)[1]
    for component, _ in found:
        check_range(component, port, value, where)
    return value


def check_range(component: Component, port: str, value: Value, where: Location | None) -> None:
    """Raise DseError if *value* (SI) is outside the range of the component's parameter."""
    parameter = component.parameter(port)
    if parameter is None or isinstance(value, str | bool):
        return
    low, high, unit = parameter.minimum, parameter.maximum, parameter.type.unit
    if (low is not None and value < low) or (high is not None and value > high):
        shown = " … ".join("∞" if bound is None else f"{unit.from_si(bound):g}" for bound in (low, high))
        raise DseError(
            Problem(
                f"{port} = {unit.from_si(value):g} is outside its range {shown} {unit}".rstrip(),
                where,
                f"the range is set by component {component.name}",
            )
        )


def _recording(name: str, components: Mapping[str, tuple[Component, ...]], where: Location) -> list[Problem]:
    """What is wrong with *name* as an entry of ``record``."""
    try:
        place, port = split_name(name, components, where)
    except DseError as error:
        return list(error.problems)
    if any(is_output(component, port) for component in components[place]):
        return []
    outputs = {p.name for c in components[place] for p in c.interface.ports if p.causality is Causality.OUTPUT}
    return [Problem(f"cannot record '{name}': no such output", where, closest(port, outputs))]


def _test_components(
    document: Document, file: BenchFile, find: FindComponent, design: DesignSpace, problems: list[Problem]
) -> tuple[TestComponent, ...]:
    parts = []
    for name, section in file.test_components.items():
        at: Path_ = ("test_components", name)
        check_name(name, document.key(at), problems)
        if name in design.root.parts:
            problems.append(Problem(f"'{name}' is a part of the design already", document.key(at), "rename it"))
        try:
            component = find(section.component, document.place((*at, "component")))
        except DseError as error:
            problems += error.problems
            continue
        values: dict[str, Value] = {}
        for parameter, raw in section.parameters.items():
            here = (*at, "parameters", parameter)
            try:
                values[parameter] = setting(
                    f"{name}.{parameter}", raw, {name: (component,)}, document.key(here), document.place(here)
                )
            except DseError as error:
                problems += error.problems
        parts.append(TestComponent(name, component, values, document.key(at)))
    return tuple(parts)


def _metrics(document: Document, file: BenchFile, problems: list[Problem]) -> tuple[Metric, ...]:
    metrics = []
    for name, entry in file.metrics.items():
        at: Path_ = ("metrics", name)
        check_name(name, document.key(at), problems)
        try:
            if isinstance(entry, str):
                metrics.append(Metric(name, parse_expression(entry, document.origin(at))))
                continue
            unit = read_unit(entry.unit or "", document.place((*at, "unit")))
            expression = parse_expression(entry.expression, document.origin((*at, "expression")))
            metrics.append(Metric(name, expression, unit, entry.title))
        except DseError as error:
            problems += error.problems
    return tuple(metrics)


def _requirement(document: Document, name: str, section: RequirementSection, metrics: set[str]) -> Requirement:
    at: Path_ = ("requirements", name)
    problems: list[Problem] = []
    check_name(name, document.key(at), problems)
    if section.metric not in metrics:
        problems.append(
            Problem(
                f"unknown metric '{section.metric}'", document.place((*at, "metric")), closest(section.metric, metrics)
            )
        )
    if section.at_most is None and section.at_least is None:
        problems.append(Problem(f"requirement '{name}' has no bound", document.key(at), "give at_most or at_least"))
    bounds: dict[str, float] = {}
    unit: Unit | None = None
    for key, raw in (("at_most", section.at_most), ("at_least", section.at_least)):
        if raw is not None:
            quantity = read_quantity(raw, document.place((*at, key)))
            if unit is not None and unit.dimension != quantity.unit.dimension:
                problems.append(Problem(f"the bounds of '{name}' have different units", document.place((*at, key))))
            bounds[key], unit = float(quantity.si), quantity.unit
    if len(bounds) == 2 and bounds["at_least"] > bounds["at_most"]:
        problems.append(
            Problem(
                f"the range of '{name}' is empty: at_least {section.at_least} > at_most {section.at_most}",
                document.place((*at, "at_least")),
            )
        )
    condition = None
    if section.exercised_when is not None:
        condition = parse_expression(section.exercised_when, document.origin((*at, "exercised_when")))
    raise_if_any(problems)
    return Requirement(
        name,
        section.metric,
        bounds.get("at_most"),
        bounds.get("at_least"),
        unit or DIMENSIONLESS,
        condition,
        section.title,
        document.key(at),
    )


def _figure(
    document: Document,
    name: str,
    section: FigureSection,
    components: Mapping[str, tuple[Component, ...]],
    unread: set[str],
    problems: list[Problem],
) -> Figure:
    at: Path_ = ("figures", name)
    unit: Unit | None = None
    for key, signal in _signals(section):
        if signal.split(".")[0] in unread:
            continue
        where = document.place((*at, key))
        try:
            (_, type_), *_ = types_of(signal, components, where)
            if key == "current":
                unit = type_.unit
        except DseError as error:
            problems += error.problems
    if section.unit is not None:
        where = document.place((*at, "unit"))
        try:
            wanted = read_unit(section.unit, where)
            if unit is not None and wanted.dimension != unit.dimension:
                found = str(unit) or "no unit"
                problems.append(Problem(f"'{section.current}' is in {found}, not in {wanted}", where))
            unit = wanted
        except DseError as error:
            problems += error.problems
    return Figure(name, section.current, section.target, unit or DIMENSIONLESS, section.title, document.key(at))


def _signals(section: FigureSection) -> Iterator[tuple[str, str]]:
    yield "current", section.current
    if section.target is not None:
        yield "target", section.target
