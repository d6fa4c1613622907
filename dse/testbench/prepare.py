"""Bench + configurations → FMUs built, systems assembled, metrics compiled."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from dse.cosim.feasibility import require_kernel, simulation_problems
from dse.domain.bench import TestBench
from dse.domain.component import Causality, Component, Kind, Type, Value, as_number
from dse.domain.design import Configuration, Connection, split_path, walk
from dse.domain.fmu import FmuModel
from dse.domain.method import BONDS, Method
from dse.domain.system import SystemStructure
from dse.errors import DseError, Problem, raise_if_any
from dse.fmu.build import build_all
from dse.fmu.unpack import open_fmu
from dse.metrics.program import compile_metrics
from dse.space.wiring import faces, wire
from dse.system.assemble import assemble, check_wiring
from dse.testbench.method import method_of, signal_name
from dse.testbench.prepared import PreparedBench, Setting
from dse.testbench.timing import sampling_problems, stepping_problems
from dse.testbench.trust import facts_of, is_thread_safe
from dse.units import parse_unit


def prepare(
    bench: TestBench, configurations: Sequence[Configuration], *, version: int = 2, cache: Path | None = None
) -> dict[str, PreparedBench]:
    """Make every configuration ready to run on *bench*, by configuration id. Raises DseError with all problems."""
    require_kernel()
    wired = {configuration.id: parts_and_wiring(bench, configuration) for configuration in configurations}
    components = {c.name: c for parts, _ in wired.values() for c in parts.values()}
    archives = build_all(components.values(), version=version, cache=cache)
    models: dict[str, FmuModel] = {}
    problems: list[Problem] = []
    for name, archive in archives.items():
        try:
            models[name] = open_fmu(archive, cache=cache)
        except DseError as error:
            problems += error.problems
    raise_if_any(problems)
    prepared: dict[str, PreparedBench] = {}
    for configuration in configurations:
        parts, connections = wired[configuration.id]
        try:
            prepared[configuration.id] = _prepare(bench, configuration, parts, connections, models, cache)
        except DseError as error:
            problems += [p for p in error.problems if p not in problems]
    if problems:
        raise DseError(*problems)
    return prepared


def check_bench(bench: TestBench, configuration: Configuration) -> None:
    """Check wiring, metrics and recorded names for one configuration without building an FMU. Raises DseError."""
    parts, connections = parts_and_wiring(bench, configuration)
    problems: list[Problem] = []
    joined = check_wiring(parts, connections, _values(bench, parts), problems, bench.where)
    behind = faces(bench.design, configuration.choices)
    types, signals = _names(parts, {connection.target for connection in joined}, behind)
    method = method_of(bench.simulation.method, parts, joined, behind, bench.simulation.where, problems)
    energies = _energies(method)
    types, signals = types | energies, signals | energies.keys()
    try:
        compile_metrics(bench.metrics, bench.requirements, types, signals)
    except DseError as error:
        problems += error.problems
    problems += [*_record_problems(bench, parts, signals), *sampling_problems(bench, parts, method)]
    if problems:
        raise DseError(*problems)


def settable(bench: TestBench, configuration: Configuration) -> Mapping[str, Setting]:
    """What a run of *configuration* may be given, by ``part.parameter``; needs no FMU. Raises DseError."""
    parts, connections = parts_and_wiring(bench, configuration)
    return _settings(parts, {connection.target for connection in connections}, _values(bench, parts))[0]


def parts_and_wiring(
    bench: TestBench, configuration: Configuration
) -> tuple[dict[str, Component], tuple[Connection, ...]]:
    """All components on the bench, by path, and every connection between single ports. Raises DseError."""
    test_parts = {part.name: part.component for part in bench.test_components}
    interfaces = {name: component.interface for name, component in test_parts.items()}
    connections = wire(bench.design, configuration.choices, interfaces, bench.connections)
    return {**configuration.parts, **test_parts}, connections


def _prepare(
    bench: TestBench,
    configuration: Configuration,
    parts: Mapping[str, Component],
    connections: Sequence[Connection],
    models: Mapping[str, FmuModel],
    cache: Path | None,
) -> PreparedBench:
    values = _values(bench, parts)
    connected = {connection.target for connection in connections}
    behind = faces(bench.design, configuration.choices)
    types, signals = _names(parts, connected, behind)
    problems: list[Problem] = []
    method = method_of(bench.simulation.method, parts, connections, behind, bench.simulation.where, problems)
    energies = _energies(method)
    types, signals = types | energies, signals | energies.keys()
    problems += [
        *_record_problems(bench, parts, signals),
        *sampling_problems(bench, parts, method),
        *stepping_problems(bench, parts, models, method),
    ]
    if problems:
        raise DseError(*problems)
    program = compile_metrics(bench.metrics, bench.requirements, types, signals)
    kept = _kept(bench, signals)
    columns = tuple(dict.fromkeys((*program.signals, *kept)))
    sources = [behind.get(name, name) for name in columns]
    system = assemble(configuration.id, parts, connections, models, values, sources, bench.where)
    settings, constants = _settings(parts, connected, values)
    facts = facts_of(system, cache=cache)
    simulation = bench.simulation
    unfit = simulation_problems(system, method, facts, stop=simulation.stop, step=simulation.step)
    raise_if_any(Problem(p.what, p.where or simulation.where, p.hint) for p in [*_crowded(system), *unfit])
    return PreparedBench(
        configuration,
        system,
        bench.simulation,
        program,
        bench.requirements,
        columns,
        tuple(name if name.startswith(f"{BONDS}.") else signal_name(name, parts) for name in sources),
        kept,
        settings,
        constants,
        method,
        facts,
        is_thread_safe(system, facts, parts, cache=cache),
    )


def _values(bench: TestBench, parts: Mapping[str, Component]) -> dict[str, Value]:
    """The bench's parameter values that apply to *parts*: what an alternative does not have, it is not given."""
    values: dict[str, Value] = {}
    for part in bench.test_components:
        values |= {f"{part.name}.{name}": value for name, value in part.parameters.items()}
    for name, value in bench.parameters.items():
        split = split_path(name, parts)
        if split and (parts[split[0]].parameter(split[1]) or parts[split[0]].interface.port(split[1])):
            values[name] = value
    return values


def _names(
    parts: Mapping[str, Component], connected: Iterable[str], behind: Mapping[str, str]
) -> tuple[dict[str, Type], frozenset[str]]:
    """Every name a metric may use with its type, and which of them are waveforms; *behind* is that of `faces`."""
    types: dict[str, Type] = {}
    signals = set()
    inputs = set(connected)
    for path, component in parts.items():
        for port in component.interface.ports:
            name = f"{path}.{port.name}"
            if port.causality is Causality.OUTPUT:
                types[name] = port.type
                signals.add(name)
            elif name not in inputs:
                types[name] = port.type
        types |= {f"{path}.{p.name}": p.type for p in component.parameters if p.type.kind is not Kind.TEXT}
    for face, source in behind.items():
        types[face] = types[source]
        signals.add(face)
    return types, frozenset(signals)


def _crowded(system: SystemStructure) -> list[Problem]:
    """FMUs that say they can be there once only, and are to stand at several places."""
    places: dict[Path, list[str]] = {}
    for element in system.elements:
        if element.model.capabilities.once_per_process:
            places.setdefault(element.model.library, []).append(element.name)
    return [
        Problem(f"{' and '.join(names)}: {library.stem} can be instantiated only once in a process", hint=_ONE_PLACE)
        for library, names in places.items()
        if len(names) > 1
    ]


_ONE_PLACE = "let it stand at one place of a configuration only"


def _energies(method: Method) -> dict[str, Type]:
    """The residual energies of bonds, as signals."""
    return {f"{BONDS}.{bond.name}": Type(Kind.REAL, parse_unit("J")) for bond in method.bonds}


def _record_problems(bench: TestBench, parts: Mapping[str, Component], signals: frozenset[str]) -> list[Problem]:
    """Recorded names that are no output of a part that is there."""
    problems = []
    places = {path for path, _ in walk(bench.design.root)} | set(parts)
    for name in bench.simulation.record:
        if name in signals or name.startswith(f"{BONDS}."):
            continue
        standing = split_path(name, places)
        if standing is None:
            problems.append(Problem(f"cannot record '{name}': no such part", bench.simulation.where))
        elif standing[0] in parts or any(part.startswith(f"{standing[0]}.") for part in parts):
            known = sorted(signal for signal in signals if signal.startswith(f"{standing[0]}."))
            hint = f"outputs: {', '.join(known)}"
            problems.append(Problem(f"cannot record '{name}': no such output", bench.simulation.where, hint))
    return problems


def _kept(bench: TestBench, signals: frozenset[str]) -> tuple[str, ...]:
    shown = [name for figure in bench.figures for name in (figure.current, figure.target) if name]
    return tuple(dict.fromkeys(name for name in (*bench.simulation.record, *shown) if name in signals))


def _settings(
    parts: Mapping[str, Component], connected: Iterable[str], values: Mapping[str, Value]
) -> tuple[dict[str, Setting], dict[str, float]]:
    settings: dict[str, Setting] = {}
    constants: dict[str, float] = {}
    inputs = set(connected)
    for path, component in parts.items():
        for parameter in component.parameters:
            if parameter.type.kind is Kind.TEXT:
                continue
            name = f"{path}.{parameter.name}"
            settings[name] = Setting(f"{path}.{component.variable(parameter.name)}", parameter.type)
            constants[name] = as_number(values.get(name, parameter.start), parameter.type)
        for port in component.interface.ports:
            name = f"{path}.{port.name}"
            if port.causality is Causality.INPUT and name not in inputs and name in values:
                settings[name] = Setting(f"{path}.{component.variable(port.name)}", port.type)
                constants[name] = as_number(values[name], port.type)
    return settings, constants
