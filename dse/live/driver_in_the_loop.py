"""A bench with a driver in the loop: its driver component is replaced by one whose outputs a person sets as it runs."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from dse.domain.bench import TestBench, TestComponent
from dse.domain.component import Causality, Component, Interface, Kind, Parameter, Port, Type
from dse.domain.design import Configuration, Connection
from dse.domain.drive import TUNE
from dse.domain.fmu import FmuModel
from dse.domain.system import Element
from dse.domain.udp import INHERITED, LinkMode, LinkRole, UdpSource
from dse.errors import Problem, fail, raise_if_any
from dse.fmu import build_all, open_component
from dse.live.shared_bench import Sharing, without_traffic
from dse.system import along_the_flow
from dse.testbench import PreparedBench, prepare_bench, wire_bench
from dse.units import parse_unit

DRIVER = "driver"
"""The interface of what can be replaced by somebody at the wheel."""

ECHO, OVERRUNS, LATENESS = "echo", "link.overruns", "link.lateness"
_OWN = (ECHO, OVERRUNS, LATENESS)
"""What the driver in the loop shows to itself again, so that whoever talks with it knows what the run has used."""

_ANSWERED_WITHIN = 5.0
_MOST = 4000
"""Signals that a driver in the loop sees."""


@dataclass(frozen=True, slots=True)
class DriverInTheLoop:
    """Where somebody sits in a run of *bench*: the test component *part*, which puts out *controls*, numbers for the
    parameters *tunables* by ``part.parameter``, and sees the signals *seen*."""

    bench: TestBench
    configuration: Configuration
    part: str
    controls: tuple[Port, ...]
    tunables: Mapping[str, Parameter]
    seen: tuple[str, ...]
    others: tuple[str, ...] = ()
    """The outputs that are the cars of others, in a shared world: ``other1.speed``."""

    @property
    def inputs(self) -> tuple[str, ...]:
        """The outputs of the driver in the loop that are a drive: controls, ``tune.<part>.<parameter>``, others."""
        return (*(port.name for port in self.controls), *(f"{TUNE}.{name}" for name in self.tunables), *self.others)


def driver_of(bench: TestBench) -> TestComponent:
    """The test component that somebody can take the place of. DseError if there is none, or several."""
    found = [each for each in bench.test_components if each.component.interface.name == DRIVER]
    if len(found) == 1:
        return found[0]
    what = f"bench '{bench.name}' cannot be driven: "
    if found:
        raise fail(f"{what}both {found[0].name} and {found[1].name} are a '{DRIVER}'", bench.where)
    hint = f"give it a test component that implements '{DRIVER}', as hands_off in the bench drive_following"
    raise fail(f"{what}none of its test components implements '{DRIVER}'", bench.where, hint)


def can_be_driven(bench: TestBench) -> bool:
    """Whether a test component of *bench* is a driver."""
    return sum(each.component.interface.name == DRIVER for each in bench.test_components) == 1


def tunables_of(bench: TestBench, configuration: Configuration, *, version: int = 2) -> dict[str, Parameter]:
    """The numbers of the design's parts that can be set while they run, by ``part.parameter``.

    None that has a source already, or that a metric, requirement, figure or derived value takes for a constant.
    """
    wired = wire_bench(bench, configuration)
    archives = build_all(configuration.parts.values(), version=version)
    models = {name: open_component(part, archives[part.name]) for name, part in configuration.parts.items()}
    texts = [each.expression.text for each in bench.metrics] + [each.expression.text for each in bench.derived]
    texts += [each.exercised_when.text for each in bench.requirements if each.exercised_when]
    said = " ".join([*texts, *(each.target or "" for each in bench.figures), *(each.name for each in bench.derived)])
    return {
        name: each
        for path, component in configuration.parts.items()
        for each in component.parameters
        if (name := f"{path}.{each.name}") not in wired.connected
        and name not in said
        and each.tunable
        and each.type.kind is Kind.REAL
        and _is_tunable(models[path], component.variable(each.name))
    }


def _is_tunable(model: FmuModel, name: str) -> bool:
    variable = model.variables.get(name)
    return variable is not None and variable.variability == "tunable" and not variable.shape


def with_driver(
    bench: TestBench, component: Component, tuned: Sequence[str], others: Mapping[str, str] | None = None
) -> TestBench:
    """*bench* driven by *component*, whose outputs ``tune.<part>.<parameter>`` go to the parameters *tuned*, and those
    that are *others* to these inputs."""
    part = driver_of(bench)
    replaced = tuple(
        TestComponent(each.name, component, {}, each.where) if each is part else each for each in bench.test_components
    )
    ends = {**{f"{TUNE}.{name}": name for name in tuned}, **(others or {})}
    ways = tuple(Connection(f"{part.name}.{name}", end, part.where) for name, end in ends.items())
    return replace(bench, test_components=replaced, direct=(*bench.direct, *ways))


def put_driver_in_the_loop(
    bench: TestBench,
    configuration: Configuration,
    wanted: Sequence[str],
    *,
    sharing: Sharing | None = None,
    version: int = 2,
) -> DriverInTheLoop:
    """*bench* with a driver in the loop in the driver's place, which sees the signals *wanted*.

    It talks through the socket that its process is given, in real time and SI units, and all that it puts out is kept.
    With *sharing* it puts out the cars of others as well, the bench has no traffic, and each step waits for an answer:
    whoever answers keeps time. Raises DseError if the bench cannot be driven.
    """
    if sharing:
        bench = without_traffic(bench, sharing)
    raise_if_any(_refusals(bench))
    part, wired = driver_of(bench), wire_bench(bench, configuration)
    if len(wanted) > _MOST:
        raise fail(
            f"bench '{bench.name}' shows {len(wanted):,} signals; a driver in the loop sees {_MOST:,} at most",
            bench.where,
        )
    ports = (port for port in part.component.interface.ports if port.causality is Causality.OUTPUT)
    controls = tuple(replace(port, type=port.type.in_si) for port in ports)
    tunables = tunables_of(bench, configuration, version=version)
    others = sharing.types if sharing else {}
    given = {**{f"{TUNE}.{name}": each.type for name, each in tunables.items()}, **others, **own_signals()}
    outputs = [*controls, *(Port(name, Causality.OUTPUT, type_.in_si) for name, type_ in given.items())]
    signals = wired.signals
    types = {**own_signals(), **{name: signals[name] for name in wanted}}
    inputs = [Port(f"sees.n{number}", Causality.INPUT, type_.in_si) for number, type_ in enumerate(types.values(), 1)]
    component = link(part, (*inputs, *outputs), LinkMode.LOCKSTEP if sharing else LinkMode.FREE)
    driven = with_driver(bench, component, tuple(tunables), sharing.ends if sharing else None)
    sources = [f"{part.name}.{name}" for name in own_signals()] + [wired.faces.get(name, name) for name in wanted]
    views = (Connection(end, f"{part.name}.{port.name}") for end, port in zip(sources, inputs, strict=True))
    shown = tuple(f"{part.name}.{port.name}" for port in outputs)
    simulation = replace(
        bench.simulation, record=(*bench.simulation.record, *shown), record_every=bench.simulation.step
    )
    seated = replace(driven, direct=(*driven.direct, *views), simulation=simulation)
    return DriverInTheLoop(seated, configuration, part.name, controls, tunables, tuple(wanted), tuple(others))


def link(part: TestComponent, ports: Iterable[Port], mode: LinkMode, wait: float = _ANSWERED_WITHIN) -> Component:
    """What talks, in place of *part*, through the socket of its process; it waits *wait* s for an answer."""
    line = UdpSource(0, INHERITED, LinkRole.CLIENT, mode, wait, where=part.where)
    return Component("seat", Interface("seat", tuple(ports)), source=line, where=part.where)


def prepare_driver(driver_in_loop: DriverInTheLoop, *, version: int = 2) -> PreparedBench:
    """The run that somebody drives, its elements in the order that they have with a record in place of the driver in
    the loop.

    Only so a method that goes from one element to the next gives the same again. Raises DseError.
    """
    prepared = prepare_bench(driver_in_loop.bench, [driver_in_loop.configuration], version=version)[
        driver_in_loop.configuration.id
    ]
    system = prepared.system
    ranked = [*wire_bench(driver_in_loop.bench, driver_in_loop.configuration).parts]
    order = along_the_flow(ranked, [wire for wire in system.wires if wire.target != driver_in_loop.part])
    elements = {each.name: each for each in system.elements}
    elements[driver_in_loop.part] = heedless(elements[driver_in_loop.part])
    return replace(prepared, system=replace(system, elements=tuple(elements[name] for name in order)))


def heedless(element: Element) -> Element:
    """A driver in the loop, whose outputs follow from no input: they are what somebody wants, from the start on."""
    nothing: dict[str, tuple[str, ...]] = {variable.name: () for variable in element.outputs}
    return replace(element, model=replace(element.model, depends=nothing, initially_depends=nothing))


def own_signals() -> dict[str, Type]:
    """What a driver in the loop shows to itself again, ahead of all that it sees."""
    return dict(zip(_OWN, (Type(Kind.REAL), Type(Kind.REAL), Type(Kind.REAL, parse_unit("s"))), strict=True))


def _refusals(bench: TestBench) -> Iterator[Problem]:
    simulation, what = bench.simulation, f"bench '{bench.name}' cannot be driven: "
    if simulation.method.adaptive is not None:
        yield Problem(f"{what}its steps may have to be repeated, which is impossible in real time", simulation.where)
    if simulation.check_step:
        yield Problem(f"{what}with check_step, a run is simulated twice", simulation.where)
