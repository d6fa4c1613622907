"""A configuration on its bench, as far as it can be told without an FMU."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

from dse.domain.bench import TestBench
from dse.domain.component import Causality, Component, Kind, Type, Value, as_number
from dse.domain.design import Configuration, split_path
from dse.domain.noise import DRAW, MOST_SEED, NoiseStream
from dse.space import architecture_outputs, wire
from dse.system import WiredParts
from dse.testbench.prepared_bench import Setting


@dataclass(frozen=True, kw_only=True)
class WiredBench(WiredParts):
    """All components on a bench, every connection between single ports; *faces*: what `architecture_outputs` gives.

    *streams* are the seeds that nobody gives a value: they follow from the draw.
    """

    bench: TestBench
    configuration: Configuration
    faces: Mapping[str, str]
    streams: tuple[NoiseStream, ...] = ()

    @cached_property
    def signals(self) -> dict[str, Type]:
        """The waveforms a metric may use: outputs of components, and of the architectures before them."""
        found = {end: port.type for end, (_, port) in self.ports.items() if port.causality is Causality.OUTPUT}
        found |= {face: found[source] for face, source in self.faces.items()}
        return {end: type_ for end, type_ in found.items() if type_.kind.is_number}

    @cached_property
    def types(self) -> dict[str, Type]:
        """Every name a metric may use: the signals, and what keeps one value for a run."""
        connected = self.connected
        loose = {end: port.type for end, (_, port) in self.ports.items() if end not in connected}
        loose = {end: type_ for end, type_ in loose.items() if type_.kind.is_number}
        return loose | {name: setting.type for name, setting in self.settings.items()} | self.signals

    @cached_property
    def settings(self) -> dict[str, Setting]:
        """What a run may be given, by ``part.parameter`` or the port of an input that the bench gives a value.

        Not what is connected.
        """
        values, connected = self.values, self.connected
        found: dict[str, Setting] = {}
        for path, component in self.parts.items():
            own_parameters = (p for p in component.parameters if f"{path}.{p.name}" not in connected)
            starts = {p.name: (p.type, p.start) for p in own_parameters if p.type.kind.is_number}
            for port in component.interface.ports:
                name = f"{path}.{port.name}"
                is_loose = port.causality is Causality.INPUT and name not in connected and name in values
                if is_loose and port.type.kind.is_number:
                    starts[port.name] = port.type, values[name]
            for own, (type_, start) in starts.items():
                name = f"{path}.{own}"
                value = as_number(values.get(name, start), type_)
                found[name] = Setting(f"{path}.{component.variable(own)}", type_, value)
        if self.streams:
            found[DRAW] = Setting("", Type(Kind.INTEGER), self.bench.draw)
        return found


def wire_bench(bench: TestBench, configuration: Configuration) -> WiredBench:
    """*configuration* on *bench*. Raises DseError if they cannot be connected."""
    test_parts = {part.name: part.component for part in bench.test_components}
    connections = wire(bench.design, configuration.choices, test_parts, bench.connections)
    parts = {**configuration.parts, **test_parts}
    taken = {connection.target for connection in bench.direct}
    values = {name: value for name, value in _values(bench, parts).items() if name not in taken}
    given = {*values, *taken, *(c.target for c in connections), *(each.name for each in bench.derived)}
    streams = tuple(
        NoiseStream(f"{path}.{p.name}", int(p.minimum or 0), int(MOST_SEED if p.maximum is None else p.maximum))
        for path, component in parts.items()
        for p in component.parameters
        if p.random and f"{path}.{p.name}" not in given
    )
    return WiredBench(
        parts=parts,
        connections=(*connections, *bench.direct),
        values=values | {stream.name: stream.seed(bench.draw) for stream in streams},
        streams=streams,
        where=bench.where,
        bench=bench,
        configuration=configuration,
        faces=architecture_outputs(bench.design, configuration.choices),
    )


def _values(bench: TestBench, parts: Mapping[str, Component]) -> dict[str, Value]:
    """The bench's parameter values that apply to *parts*: what an alternative does not have, it is not given."""
    values = {f"{p.name}.{name}": value for p in bench.test_components for name, value in p.parameters.items()}
    for name, value in bench.parameters.items():
        split = split_path(name, parts)
        if split and (parts[split[0]].interface.port(split[1]) or parts[split[0]].parameter(split[1])):
            values[name] = value
    return values
