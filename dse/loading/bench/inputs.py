"""Reads ``inputs`` of a test bench: columns of files as a part of the bench that gives them over time."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from dse.domain.bench import TestComponent
from dse.domain.component import Causality, Component, Interface, Kind, Parameter, Port, Type, same_signal
from dse.domain.design import Connection, DesignSpace, split_path, walk
from dse.domain.time_series import Series, TimeSeriesSource
from dse.errors import Location, Problems, closest, fail
from dse.loading.bench.method import read_positive
from dse.loading.component.kind import kind_of
from dse.loading.component.series import Column, TableSection, read_series
from dse.loading.names import is_identifier
from dse.loading.sections import Plain
from dse.loading.values import read_number, read_unit
from dse.units import DIMENSIONLESS

if TYPE_CHECKING:
    from dse.formats import Entry

INPUTS = "inputs"
"""The part of the bench that gives the values: ``inputs.world.lead.speed`` feeds ``world.lead.speed``."""

_NAME = "inputs of the bench"
"""What its component is called; no other can be, as it has blanks."""


class InputSection(TableSection):
    """What one input is fed with."""

    column: Column
    offset: Plain = 0
    gain: Plain = 1


@dataclass(frozen=True, slots=True)
class FedInputs:
    """What the section means: a test component, if there is an input at all, and what connects it."""

    parts: tuple[TestComponent, ...] = ()
    connections: tuple[Connection, ...] = ()


def read_inputs(
    bench: Entry,
    sections: Mapping[str, InputSection],
    stop: Plain,
    design: DesignSpace,
    parts: Sequence[TestComponent],
    inside: Path,
    problems: Problems,
) -> FedInputs:
    """The test component that feeds the inputs in *sections* of *bench*; the *parts* are the others of it.

    What is wrong, also in the files, is added to *problems*.
    """
    if not sections:
        return FedInputs()
    entries = bench[INPUTS]
    if INPUTS in (*design.root.parts, *(part.name for part in parts)):
        problems.add(f"a part is called '{INPUTS}', as what feeds inputs is", entries.key, "rename the part")
        return FedInputs()
    taken = _inputs(design, parts)
    ports: list[Port] = []
    series: list[Series] = []
    parameters: list[Parameter] = []
    for name, section in sections.items():
        entry = entries[name]
        with problems:
            ports.append(Port(name, Causality.OUTPUT, _type(name, taken, entry.key)))
            parameters += _parameters(name, section, ports[-1].type, entry)
            series += read_series(entry, section, {name: (section.column, entry["column"])}, inside)
    if len(series) < len(sections):
        return FedInputs()
    source = TimeSeriesSource(tuple(series), read_positive(bench["simulation"]["stop"], stop, "s", Problems()))
    interface = Interface(_NAME, tuple(ports), entries.key)
    # Parts may be called as words of C, and a single value of an array is no array.
    dotted = [*(port.name for port in ports), *(parameter.name for parameter in parameters)]
    names = {name: re.sub(r"\W+", "_", name) for name in dotted if not all(map(is_identifier, name.split(".")))}
    component = Component(_NAME, interface, "Time series", source, tuple(parameters), names=names, where=entries.key)
    if kind := kind_of(component):
        with problems:
            kind.check(component, source)
    connections = tuple(Connection(f"{INPUTS}.{name}", name, entries[name].key) for name in sections)
    return FedInputs((TestComponent(INPUTS, component, {}, entries.key),), connections)


def _inputs(design: DesignSpace, parts: Sequence[TestComponent]) -> dict[str, dict[str, list[Port]]]:
    """The ports of what can stand at each place, by path and name; of architectures those of their interfaces."""
    found: dict[str, dict[str, list[Port]]] = {}
    interfaces = [(path, node.interface) for path, node in walk(design.root) if path]
    interfaces += [(part.name, part.component.interface) for part in parts]
    for path, interface in interfaces:
        ports = found.setdefault(path, {})
        for port in interface.ports if interface else ():
            ports.setdefault(port.name, []).append(port)
    return found


def _type(name: str, taken: Mapping[str, Mapping[str, Sequence[Port]]], where: Location) -> Type:
    """The type of the input *name*. Raises DseError: there is no such input, or alternatives differ."""
    split = split_path(name, taken)
    if split is None:
        raise fail(f"'{name}' names no part", where, closest(name.split(".", maxsplit=1)[0], taken))
    ports = taken[split[0]]
    known = [port for port, (first, *_) in ports.items() if first.causality is Causality.INPUT]
    if split[1] not in ports:
        raise fail(f"'{split[0]}' has no input '{split[1]}'", where, closest(split[1], known))
    first, *others = ports[split[1]]
    if first.causality is not Causality.INPUT:
        raise fail(f"'{name}' is an output", where, closest(split[1], known))
    if not first.type.kind.is_number:
        raise fail(f"'{name}' is a {first.type.kind}: columns of files hold numbers", where, "connect it instead")
    for other in others:
        if difference := same_signal(first.type, other.type):
            raise fail(f"'{name}' is not the same in all alternatives: {difference}", where)
    return first.type


def _parameters(name: str, section: InputSection, type_: Type, entry: Entry) -> list[Parameter]:
    second = read_unit("s", entry.where)
    written = [("offset", section.offset, second, "the time of the file at which a run begins")]
    if type_.kind is Kind.REAL:
        written.append(("gain", section.gain, DIMENSIONLESS, "what its values are multiplied by"))
    elif entry["gain"].is_there:
        raise fail(f"'{name}' is {type_}, which cannot be multiplied", entry["gain"].key, "remove 'gain'")
    return [
        Parameter(
            f"{name}.{key}",
            Type(Kind.REAL, unit),
            read_number(raw, unit, entry[key].where),
            title=f"{name}: {title}",
            where=entry.key,
        )
        for key, raw, unit, title in written
    ]
