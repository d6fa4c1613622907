"""Reads components: one in a file of its own, or many without a source in one file."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from dse.domain.component import NO_INTERFACE, Component, Interface, Kind, Parameter, Source, Type
from dse.domain.labels import element_names, wholes
from dse.errors import DseError, Location, Problems, closest, fail, raise_if_any
from dse.formats import Entry
from dse.loading.component.interfaces import MOST_VALUES
from dse.loading.component.kind import read_source
from dse.loading.include import read_document
from dse.loading.names import check_choice, check_member, check_name
from dse.loading.sections import Plain, Section, read_section
from dse.loading.values import (
    Elements,
    Raw,
    read_elements,
    read_number,
    read_quantity,
    read_type,
    read_unit,
    read_value,
)
from dse.units import DIMENSIONLESS, Quantity


class ParameterSection(Section):
    """One parameter of a component."""

    start: Raw | Elements
    min: Plain | None = None
    max: Plain | None = None
    unit: str | None = None
    enum: list[str] | None = None
    type: str | None = None
    tunable: bool = True
    random: bool = False
    title: str = ""


class FactsSection(Section):
    """A component without a source, as one of many in a file."""

    title: str = ""
    implements: str | None = None
    parameters: dict[str, ParameterSection] = {}
    properties: dict[str, Plain] = {}


class ComponentFile(FactsSection):
    """``component.yaml``. What stands below *source* is read by its kind."""

    component: str
    source: dict[str, Any] | None = None
    map: dict[str, str] = {}


class CollectionFile(Section):
    """Any other file below ``components/``: many components in one."""

    components: dict[str, FactsSection]


def read_component(path: Path, interfaces: Mapping[str, Interface], inside: Path) -> Component:
    """One ``component.yaml``, whose C files lie in the workspace *inside*. Raises DseError with every problem in it."""
    entry = read_document(path, inside)
    problems = Problems()
    source = _source(entry, inside, problems)
    try:
        file = read_section(entry, ComponentFile)
    except DseError as error:
        raise DseError(*error.problems, *problems) from error
    where = entry["component"].where
    check_choice(file.component, where, problems)
    interface = _interface(entry, file, interfaces, problems)
    parameters = _parameters(entry, file, interface, problems)
    properties = _properties(entry, file, problems)
    known = {port.name for port in interface.ports} | set(file.parameters)
    known |= {whole for port in interface.ports for whole in wholes(port.name)}
    for name in file.map:
        if name not in known:
            what = f"'{name}' is neither a port of {interface.name or 'an interface'} nor a parameter"
            problems.add(what, entry["map"][name].key, closest(name, known))
    if file.source is not None and file.implements is None:
        what = "'implements' is missing: a component with a source has an interface"
        problems.add(what, entry["source"].key, closest("", interfaces))
    if source is not None and not source.takes_texts:
        for text in (parameter for parameter in parameters if parameter.type.kind is Kind.TEXT):
            what = f"'{text.name}' is a text: only existing FMUs (kind fmu) have parameters that are texts"
            problems.add(what, text.where, "make it a number, or an enum")
    raise_if_any(problems)
    return Component(file.component, interface, file.title, source, parameters, properties, file.map, where)


def read_collection(path: Path, interfaces: Mapping[str, Interface], inside: Path) -> list[Component]:
    """The components of one file with many, none of which has a source. Raises DseError with every problem in it."""
    entries = read_document(path, inside)
    problems = Problems()
    found = []
    for name, section in read_section(entries, CollectionFile).components.items():
        entry = entries["components"][name]
        where = entry.key
        check_choice(name, where, problems)
        interface = _interface(entry, section, interfaces, problems)
        parameters = _parameters(entry, section, interface, problems)
        properties = _properties(entry, section, problems)
        found.append(Component(name, interface, section.title, None, parameters, properties, where=where))
    raise_if_any(problems)
    return found


def _source(entry: Entry, inside: Path, problems: Problems) -> Source | None:
    # What is no mapping, and who has no name, is told of with the rest of the file.
    match entry.data:
        case {"component": str(name), "source": dict()}:
            with problems:
                return read_source(entry["source"], name, inside)
    return None


def _interface(
    entry: Entry, section: FactsSection, interfaces: Mapping[str, Interface], problems: Problems
) -> Interface:
    if section.implements is None:
        return NO_INTERFACE
    if section.implements not in interfaces:
        what = f"unknown interface '{section.implements}'"
        problems.add(what, entry["implements"].where, closest(section.implements, interfaces))
    return interfaces.get(section.implements, Interface(section.implements, ()))


def _parameters(entry: Entry, section: FactsSection, interface: Interface, problems: Problems) -> tuple[Parameter, ...]:
    found: list[Parameter] = []
    for name, written in section.parameters.items():
        with problems:
            found += _parameter(entry["parameters"][name], written, interface)
    return tuple(found)


def _properties(entry: Entry, section: FactsSection, problems: Problems) -> dict[str, Quantity]:
    found = {}
    properties = entry["properties"]
    for name, raw in section.properties.items():
        stated = properties[name]
        check_name(name, stated.key, problems)
        with problems:
            found[name] = read_quantity(raw, stated.where)
    return found


def _parameter(entry: Entry, section: ParameterSection, interface: Interface) -> Iterator[Parameter]:
    """The parameter, or one for each value of the array that it is."""
    name, where = entry.name, entry.key
    problems = Problems()
    for part in name.split("."):
        check_member(part, where, problems)
    if interface.group(name):
        problems.add(f"'{name}' is a port of {interface.name} already", where, "rename it")
    raise_if_any(problems)
    shape, starts = read_elements(section.start, entry["start"])
    if len(starts) > MOST_VALUES:
        what = f"'{name}' has {len(starts):,} values"
        raise fail(what, entry["start"].where, f"at most {MOST_VALUES:,} are supported")
    type_ = _parameter_type(entry, section, starts[0])
    bounds: list[float | None] = []
    for key, raw in (("min", section.min), ("max", section.max)):
        if raw is not None and type_.kind not in (Kind.REAL, Kind.INTEGER):
            raise fail(f"'{key}' makes no sense for {type_}", entry[key].key, "remove it")
        bounds.append(None if raw is None else read_number(raw, type_.unit, entry[key].where))
    low, high = bounds
    if section.random and type_.kind is not Kind.INTEGER:
        raise fail(f"'random' makes no sense for {type_}", entry["random"].key, "a seed is an integer: type: int")
    if low is not None and high is not None and low > high:
        raise fail(f"the range of '{name}' is empty: min {section.min} > max {section.max}", entry["min"].where)
    for label, (raw, place) in zip(element_names(name, shape), starts, strict=True):
        start = read_value(raw, type_, place)
        number = start if isinstance(start, float | int) else None
        if number is not None and not ((low is None or low <= number) and (high is None or number <= high)):
            what = f"start of '{label}' is outside its range {section.min} … {section.max}"
            raise fail(what, place, "widen min and max or change start")
        yield Parameter(label, type_, start, low, high, section.tunable, section.title, where, section.random)


_TYPES = {"int": Kind.INTEGER, "bool": Kind.BOOLEAN, "real": Kind.REAL, "string": Kind.TEXT}


def _parameter_type(entry: Entry, section: ParameterSection, first: tuple[Raw, Location]) -> Type:
    start, start_at = first
    if section.enum is not None:
        return read_type(f"enum[{', '.join(section.enum)}]", entry["enum"].where)
    if section.type is not None:
        if section.type not in _TYPES:
            raise fail(f"unknown type '{section.type}'", entry["type"].where, "int, bool, real or string")
        if section.type != "real":
            return Type(_TYPES[section.type])
    if isinstance(start, bool):
        return Type(Kind.BOOLEAN)
    if section.unit is not None:
        return Type(Kind.REAL, read_unit(section.unit, entry["unit"].where))
    bounds = ((section.min, entry["min"].where), (section.max, entry["max"].where))
    for raw, where in ((start, start_at), *bounds):
        if isinstance(raw, str):
            return Type(Kind.REAL, read_quantity(raw, where).unit)
    return Type(Kind.REAL, DIMENSIONLESS)
