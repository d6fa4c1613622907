"""Reads interfaces and components."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from dse.domain.component import (
    Causality,
    Component,
    CSource,
    FmuSource,
    Interface,
    Kind,
    Parameter,
    Port,
    Source,
    Type,
    UnsupportedSource,
)
from dse.errors import DseError, Location, Problem, closest, fail, raise_if_any
from dse.loading.documents import ComponentFile, InterfacesFile, ParameterSection, SourceSection
from dse.loading.fields import read_section
from dse.loading.include import read_document
from dse.loading.names import check_member, check_name, is_identifier
from dse.loading.root import followed, is_file, named_file, root_of
from dse.loading.values import read_number, read_quantity, read_type, read_unit, read_value
from dse.loading.yaml import Document, Path_, shown
from dse.units import DIMENSIONLESS

_KINDS = ("c", "fmu")
_PLANNED = ("modelica", "python", "udp")


def read_interfaces(path: Path, inside: Path | None = None) -> dict[str, Interface]:
    """All interfaces of one file of the workspace *inside*. Raises DseError."""
    document = read_document(path, inside)
    sections = read_section(document, InterfacesFile)
    problems: list[Problem] = []
    result: dict[str, Interface] = {}
    for name, section in sections.interfaces.items():
        at: Path_ = ("interfaces", name)
        check_name(name, document.key(at), problems)
        ports: list[Port] = []
        for causality, entries in ((Causality.INPUT, section.inputs), (Causality.OUTPUT, section.outputs)):
            ports += _ports(document, (*at, f"{causality}s"), entries, causality, "", problems)
        twice = {port.name for port in ports if sum(port.name == other.name for other in ports) > 1}
        problems += [Problem(f"port '{port}' is input and output", document.key(at)) for port in sorted(twice)]
        result[name] = Interface(name, tuple(ports), document.key(at))
    raise_if_any(problems)
    return result


def read_component(path: Path, interfaces: Mapping[str, Interface], inside: Path | None = None) -> Component:
    """One ``component.yaml``, whose C files lie in the workspace *inside*, by default the one around it.

    Raises DseError with every problem in it.
    """
    inside = inside or root_of(path)
    document = read_document(path, inside)
    file = read_section(document, ComponentFile)
    problems: list[Problem] = []
    check_name(file.component, document.place(("component",)), problems)
    interface = interfaces.get(file.implements)
    if interface is None:
        problems.append(
            Problem(
                f"unknown interface '{file.implements}'",
                document.place(("implements",)),
                closest(file.implements, interfaces),
            )
        )
        interface = Interface(file.implements, ())
    parameters = []
    for name, section in file.parameters.items():
        try:
            parameters.append(_parameter(document, name, section, interface))
        except DseError as error:
            problems += error.problems
    properties = {}
    for name, raw in file.properties.items():
        try:
            check_name(name, document.key(("properties", name)), problems)
            properties[name] = read_quantity(raw, document.place(("properties", name)))
        except DseError as error:
            problems += error.problems
    known = {port.name for port in interface.ports} | set(file.parameters)
    for name in file.map:
        if name not in known:
            problems.append(
                Problem(
                    f"'{name}' is neither a port of {interface.name} nor a parameter",
                    document.key(("map", name)),
                    closest(name, known),
                )
            )
    source: Source | None = None
    if file.source is not None:
        try:
            source = _source(document, file, file.source, inside)
        except DseError as error:
            problems += error.problems
    raise_if_any(problems)
    return Component(
        file.component,
        interface,
        file.title,
        source,
        tuple(parameters),
        properties,
        file.map,
        document.place(("component",)),
    )


def _ports(
    document: Document,
    at: Path_,
    entries: Mapping[str, Any],
    causality: Causality,
    prefix: str,
    problems: list[Problem],
) -> Iterator[Port]:
    for name, entry in entries.items():
        here = (*at, name)
        check_member(name, document.key(here), problems)
        full = f"{prefix}{name}"
        if isinstance(entry, dict) and entry:
            yield from _ports(document, here, entry, causality, f"{full}.", problems)
            continue
        if not isinstance(entry, str | int):
            problems.append(
                Problem(
                    f"port '{full}' needs a unit or a type",
                    document.place(here),
                    "write a unit ('m/s', '1' for none), bool, int, enum[a, b], or a group {port: unit}",
                )
            )
            continue
        try:
            type_ = read_type(str(entry), document.place(here))
        except DseError as error:
            problems += error.problems
            continue
        if not type_.unit.is_coherent:
            problems.append(
                Problem(
                    f"port '{full}' must be in a coherent SI unit, not '{type_.unit}'",
                    document.place(here),
                    "signals are SI inside; convert where a person reads them (figures, metrics)",
                )
            )
            continue
        yield Port(full, causality, type_)


def _parameter(document: Document, name: str, section: ParameterSection, interface: Interface) -> Parameter:
    at: Path_ = ("parameters", name)
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


def _parameter_type(document: Document, at: Path_, section: ParameterSection) -> Type:
    if section.enum is not None:
        return read_type(f"enum[{', '.join(section.enum)}]", document.place((*at, "enum")))
    if section.type is not None:
        if section.type not in ("int", "bool", "real"):
            raise fail(f"unknown type '{section.type}'", document.place((*at, "type")), "int, bool or real")
        if section.type != "real":
            return Type(Kind.INTEGER if section.type == "int" else Kind.BOOLEAN)
    if isinstance(section.start, bool):
        return Type(Kind.BOOLEAN)
    if section.unit is not None:
        return Type(Kind.REAL, read_unit(section.unit, document.place((*at, "unit"))))
    for key, raw in (("start", section.start), ("min", section.min), ("max", section.max)):
        if isinstance(raw, str):
            return Type(Kind.REAL, read_quantity(raw, document.place((*at, key))).unit)
    return Type(Kind.REAL, DIMENSIONLESS)


def _source(document: Document, file: ComponentFile, section: SourceSection, inside: Path) -> Source:
    folder = document.path.parent
    if section.kind == "fmu":
        if section.file is None:
            raise fail("'file' is missing in 'source'", document.key(("source",)), "file: my_part.fmu")
        where = document.place(("source", "file"))
        # Used as it is and known by its content, so that it may lie anywhere.
        return FmuSource(_existing(followed(folder, section.file, where), where))
    if section.kind != "c":
        where = document.place(("source", "kind"))
        if section.kind in _PLANNED:
            return UnsupportedSource(section.kind)
        raise fail(f"unknown kind of source '{section.kind}'", where, closest(section.kind, (*_KINDS, *_PLANNED)))
    if not section.files:
        raise fail("'files' is missing in 'source'", document.key(("source",)), f"files: [{file.component}.c]")
    files = tuple(
        _c_file(folder, name, inside, (".c", ".h"), document.place(("source", "files", i)))
        for i, name in enumerate(section.files)
    )
    header = section.header or Path(section.files[0]).with_suffix(".h").as_posix()
    struct = section.struct or file.component
    step = None
    if section.step is not None:
        where = document.place(("source", "step"))
        step = read_number(section.step, read_unit("s", where), where)
        if step <= 0:
            raise fail(f"the step must be positive, not {section.step}", where)
    return CSource(
        files,
        _c_file(folder, header, inside, (".h",), document.place(("source", "header"))),
        _identifier(struct, document.place(("source", "struct"))),
        _identifier(section.init or f"{struct}_init", document.place(("source", "init"))),
        _identifier(section.step_function or f"{struct}_step", document.place(("source", "step_function"))),
        step,
    )


def _c_file(folder: Path, name: str, inside: Path, suffixes: tuple[str, ...], where: Location) -> Path:
    return _existing(named_file(folder, name, inside, suffixes, where), where)


def _existing(path: Path, where: Location) -> Path:
    if not is_file(path):
        raise fail(f"no such file: {shown(path)}", where, "paths are relative to this component.yaml")
    return path


def _identifier(name: str, where: Location) -> str:
    if not is_identifier(name):
        raise fail(f"'{name}' is not a C identifier", where)
    return name
