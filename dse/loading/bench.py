"""Reads test benches."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

from dse.domain.bench import Figure, Metric, Requirement, Simulation, TestBench, TestComponent
from dse.domain.component import Component, Type, Value
from dse.domain.design import DesignSpace, Part, walk
from dse.errors import DseError, Location, Problem, raise_if_any
from dse.loading.components import check_name
from dse.loading.design import FindComponent, read_connections
from dse.loading.documents import BenchFile, FigureSection, RequirementSection, SimulationSection
from dse.loading.expression import parse_expression
from dse.loading.fields import closest, read_section
from dse.loading.include import read_document
from dse.loading.values import Raw, read_number, read_quantity, read_unit, read_value
from dse.loading.yaml import Document, Path_
from dse.units import DIMENSIONLESS, Unit

FindDesign = Callable[[str, Location], DesignSpace]
"""Returns the design space of that name, or raises DseError at the location."""


def read_bench(path: Path, find_component: FindComponent, find_design: FindDesign) -> TestBench:
    """One file of ``testbenches/``. Raises DseError with every problem in it."""
    document = read_document(path)
    file = read_section(document, BenchFile)
    design = find_design(file.design, document.place(("design",)))
    problems: list[Problem] = []
    parts = _test_components(document, file, find_component, design, problems)
    components = candidates(design, parts)
    parameters: dict[str, Value] = {}
    for name, raw in file.parameters.items():
        at: Path_ = ("parameters", name)
        try:
            parameters[name] = setting(name, raw, components, document.key(at), document.place(at))
        except DseError as error:
            problems += error.problems
    simulation = _simulation(document, file.simulation, problems)
    metrics = _metrics(document, file, problems)
    requirements = []
    for name, section in file.requirements.items():
        try:
            requirements.append(_requirement(document, name, section, {m.name for m in metrics}))
        except DseError as error:
            problems += error.problems
    figures = [_figure(document, name, section, components, problems) for name, section in file.figures.items()]
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


def candidates(design: DesignSpace, parts: tuple[TestComponent, ...]) -> Mapping[str, tuple[Component, ...]]:
    """For every place of the design and the bench, the components that can stand there."""
    found: dict[str, list[Component]] = {}
    for path, node in walk(design.root):
        if isinstance(node, Part):
            found.setdefault(path, []).append(node.component)
    for part in parts:
        found.setdefault(part.name, []).append(part.component)
    return {path: tuple(components) for path, components in found.items()}


def split_name(name: str, components: Mapping[str, tuple[Component, ...]], where: Location) -> tuple[str, str]:
    """``part.port`` as (place, port): the longest place that fits. Raises DseError naming what is near."""
    steps = name.split(".")
    for length in range(len(steps) - 1, 0, -1):
        place = ".".join(steps[:length])
        if place in components:
            return place, ".".join(steps[length:])
    raise DseError(Problem(f"'{name}' names no part", where, closest(steps[0], components)))


def types_of(
    name: str, components: Mapping[str, tuple[Component, ...]], where: Location
) -> list[tuple[Component, Type]]:
    """The type of port or parameter *name* in each component that has it. Raises DseError if none has."""
    place, port = split_name(name, components, where)
    found = []
    for component in components[place]:
        parameter, signal = component.parameter(port), component.interface.port(port)
        if parameter:
            found.append((component, parameter.type))
        elif signal:
            found.append((component, signal.type))
    if not found:
        known = {parameter.name for c in components[place] for parameter in c.parameters}
        known |= {signal.name for c in components[place] for signal in c.interface.ports}
        raise DseError(Problem(f"'{place}' has no port or parameter '{port}'", where, closest(port, known)))
    return found


def setting(
    name: str, raw: Raw, components: Mapping[str, tuple[Component, ...]], key: Location, where: Location
) -> Value:
    """The value *raw* for ``part.parameter`` (or an input): SI, checked against type and range. Raises DseError."""
    found = types_of(name, components, key)
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


def _simulation(document: Document, section: SimulationSection, problems: list[Problem]) -> Simulation:
    times: dict[str, float] = {}
    seconds = read_unit("s", document.place(("simulation",)))
    raw_times = {
        "stop": section.stop,
        "step": section.step,
        "record_every": section.step if section.record_every is None else section.record_every,
        "timeout": section.timeout,
    }
    for key, raw in raw_times.items():
        where = document.place(("simulation", key))
        try:
            times[key] = read_number(raw, seconds, where)
            if times[key] <= 0:
                problems.append(Problem(f"'{key}' must be positive, not {raw}", where))
        except DseError as error:
            problems += error.problems
            times[key] = 1.0
    for whole, part in (("stop", "step"), ("record_every", "step"), ("stop", "record_every")):
        if times[part] > 0 and not _divides(times[part], times[whole]):
            problems.append(
                Problem(
                    f"'{whole}' ({raw_times[whole]}) is not a multiple of '{part}' ({raw_times[part]})",
                    document.place(("simulation", whole)),
                    "runs have a fixed number of equal steps",
                )
            )
    return Simulation(
        times["stop"],
        times["step"],
        tuple(section.record),
        times["record_every"],
        times["timeout"],
        document.key(("simulation",)),
    )


def _divides(part: float, whole: float) -> bool:
    ratio = whole / part
    return round(ratio) >= 1 and abs(ratio - round(ratio)) <= 1e-9 * ratio


def _metrics(document: Document, file: BenchFile, problems: list[Problem]) -> tuple[Metric, ...]:
    metrics = []
    for name, entry in file.metrics.items():
        at: Path_ = ("metrics", name)
        check_name(name, document.key(at), problems)
        try:
            if isinstance(entry, str):
                metrics.append(Metric(name, parse_expression(entry, document.place(at))))
                continue
            unit = read_unit(entry.unit or "", document.place((*at, "unit")))
            expression = parse_expression(entry.expression, document.place((*at, "expression")))
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
        condition = parse_expression(section.exercised_when, document.place((*at, "exercised_when")))
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
    problems: list[Problem],
) -> Figure:
    at: Path_ = ("figures", name)
    unit = DIMENSIONLESS
    for key, signal in _signals(section):
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
            if wanted.dimension != unit.dimension:
                problems.append(Problem(f"'{section.current}' is in {unit or 'no unit'}, not in {wanted}", where))
            unit = wanted
        except DseError as error:
            problems += error.problems
    return Figure(name, section.current, section.target, unit, section.title, document.key(at))


def _signals(section: FigureSection) -> Iterator[tuple[str, str]]:
    yield "current", section.current
    if section.target is not None:
        yield "target", section.target
