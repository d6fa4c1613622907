"""Reads components: one in a file of its own, or many without a source in one file."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from dse.domain.component import NO_INTERFACE, Component, Interface, Kind, Parameter, Source, Type
from dse.errors import DseError, Problem, closest, fail, raise_if_any
from dse.formats.yaml import Document, Path_
from dse.loading.component.kind import read_source
from dse.loading.documents import CollectionFile, ComponentFile, FactsSection, ParameterSection
from dse.loading.fields import read_section
from dse.loading.include import read_document
from dse.loading.names import check_choice, check_member, check_name
from dse.loading.root import root_of
from dse.loading.values import read_number, read_quantity, read_type, read_unit, read_value
from dse.units import DIMENSIONLESS, Quantity


def read_component(path: Path, interfaces: Mapping[str, Interface], inside: Path | None = None) -> Component:
    """One ``component.yaml``, whose C files lie in the workspace *inside*, by default the one around it.

    Raises DseError with every problem in it.
    """
    inside = inside or root_of(path)
    document = read_document(path, inside)
    problems: list[Problem] = []
    source = _source(document, inside, problems)
    try:
        file = read_section(document, ComponentFile)
    except DseError as error:
        raise DseError(*error.problems, *problems) from error
    check_choice(file.component, document.place(("component",)), problems)
    interface = _interface(document, (), file, interfaces, problems)
    parameters = _parameters(document, (), file, interface, problems)
    properties = _properties(document, (), file, problems)
    known = {port.name for port in interface.ports} | set(file.parameters)
    for name in file.map:
        if name not in known:
            what = f"'{name}' is neither a port of {interface.name or 'an interface'} nor a parameter"
            problems.append(Problem(what, document.key(("map", name)), closest(name, known)))
    if file.source is not None and file.implements is None:
        what = "'implements' is missing: a component with a source has an interface"
        problems.append(Problem(what, document.key(("source",)), closest("", interfaces)))
    if source is not None and not source.takes_texts:
        texts = [parameter for parameter in parameters if parameter.type.kind is Kind.TEXT]
        what = "is a text: only finished FMUs (kind fmu) have parameters that are texts"
        problems += [Problem(f"'{text.name}' {what}", text.where, "make it a number, or an enum") for text in texts]
    raise_if_any(problems)
    where = document.place(("component",))
    return Component(file.component, interface, file.title, source, parameters, properties, file.map, where)


def read_collection(path: Path, interfaces: Mapping[str, Interface], inside: Path | None = None) -> list[Component]:
    """The components of one file with many, none of which has a source. Raises DseError with every problem in it."""
    document = read_document(path, inside or root_of(path))
    file = read_section(document, CollectionFile)
    problems: list[Problem] = []
    found = []
    for name, section in file.components.items():
        at: Path_ = ("components", name)
        check_choice(name, document.key(at), problems)
        interface = _interface(document, at, section, interfaces, problems)
        parameters = _parameters(document, at, section, interface, problems)
        properties = _properties(document, at, section, problems)
        where = document.key(at)
        found.append(Component(name, interface, section.title, None, parameters, properties, where=where))
    raise_if_any(problems)
    return found


def _source(document: Document, inside: Path, problems: list[Problem]) -> Source | None:
    # What is no mapping, and who has no name, is told of with the rest of the file.
    match document.data:
        case {"component": str(name), "source": dict()}:
            try:
                return read_source(document, name, inside)
            except DseError as error:
                problems += error.problems
    return None


def _interface(
    document: Document, at: Path_, section: FactsSection, interfaces: Mapping[str, Interface], problems: list[Problem]
) -> Interface:
    if section.implements is None:
        return NO_INTERFACE
    if section.implements not in interfaces:
        what = f"unknown interface '{section.implements}'"
        hint = closest(section.implements, interfaces)
        problems.append(Problem(what, document.place((*at, "implements")), hint))
    return interfaces.get(section.implements, Interface(section.implements, ()))


def _parameters(
    document: Document, at: Path_, section: FactsSection, interface: Interface, problems: list[Problem]
) -> tuple[Parameter, ...]:
    found = []
    for name, entry in section.parameters.items():
        try:
            found.append(_parameter(document, (*at, "parameters", name), entry, interface))
        except DseError as error:
            problems += error.problems
    return tuple(found)


def _properties(document: Document, at: Path_, section: FactsSection, problems: list[Problem]) -> dict[str, Quantity]:
    found = {}
    for name, raw in section.properties.items():
        here = (*at, "properties", name)
        check_name(name, document.key(here), problems)
        try:
            found[name] = read_quantity(raw, document.place(here))
        except DseError as error:
            problems += error.problems
    return found


def _parameter(document: Document, at: Path_, section: ParameterSection, interface: Interface) -> Parameter:
    name = str(at[-1])
    problems: list[Problem] = []
    for part in name.split("."):
        check_member(part, document.key(at), problems)
    if interface.port(name):
        problems.append(Problem(f"'{name}' is a port of {interface.name} already", document.key(at), "rename it"))
    raise_if_any(problems)
    type_ = _parameter_type(document, at, section)
    start = read_value(section.start, type_, document.place((*at, "start")))
    bounds: list[float | None] = []
    for key, raw in (("min", section.min), ("max", section.max)):
        if raw is not None and type_.kind not in (Kind.REAL, Kind.INTEGER):
            raise fail(f"'{key}' makes no sense for {type_}", document.key((*at, key)), "remove it")
        bounds.append(None if raw is None else read_number(raw, type_.unit, document.place((*at, key))))
    low, high = bounds
    if low is not None and high is not None and low > high:
        raise fail(
            f"the range of '{name}' is empty: min {section.min} > max {section.max}", document.place((*at, "min"))
        )
    if isinstance(start, float | int) and ((low is not None and start < low) or (high is not None and start > high)):
        raise fail(
            f"start of '{name}' is outside its range {section.min} … {section.max}",
            document.place((*at, "start")),
            "widen min and max or change start",
        )
    return Parameter(name, type_, start, low, high, section.tunable, section.title, document.key(at))


_TYPES = {"int": Kind.INTEGER, "bool": Kind.BOOLEAN, "real": Kind.REAL, "string": Kind.TEXT}


def _parameter_type(document: Document, at: Path_, section: ParameterSection) -> Type:
    if section.enum is not None:
        return read_type(f"enum[{', '.join(section.enum)}]", document.place((*at, "enum")))
    if section.type is not None:
        if section.type not in _TYPES:
            raise fail(f"unknown type '{section.type}'", document.place((*at, "type")), "int, bool, real or string")
        if section.type != "real":
            return Type(_TYPES[section.type])
    if isinstance(section.start, bool):
        return Type(Kind.BOOLEAN)
    if section.unit is not None:
        return Type(Kind.REAL, read_unit(section.unit, document.place((*at, "unit"))))
    for key, raw in (("start", section.start), ("min", section.min), ("max", section.max)):
        if isinstance(raw, str):
            return Type(Kind.REAL, read_quantity(raw, document.place((*at, key))).unit)
    return Type(Kind.REAL, DIMENSIONLESS)
