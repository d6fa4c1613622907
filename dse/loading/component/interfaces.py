"""Reads interfaces, and the types that their ports share."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from math import prod
from pathlib import Path
from typing import Any

from dse.domain.component import Causality, Interface, Port, Type
from dse.domain.labels import element_names, is_part
from dse.errors import DseError, Problems, closest, fail, raise_if_any
from dse.formats import Entry
from dse.loading.include import read_document
from dse.loading.names import check_member, check_name
from dse.loading.sections import Section, read_section
from dse.loading.units import UnitsSection, read_units
from dse.loading.values import read_type, split_shape
from dse.units import OwnUnits, UnitError, parse_unit

MOST_VALUES = 20_000
"""Of the inputs or outputs of an interface: each value of an array is one."""


class StandIn(Section):
    """What designs put around a component, which is called ``model`` there, so that it implements another interface."""

    implements: str
    compound: dict[str, str]
    connections: list[str]


class InterfaceSection(Section):
    """One interface: ports by name, groups of ports nested."""

    title: str = ""
    inputs: dict[str, Any] = {}
    optional: list[str] = []
    outputs: dict[str, Any] = {}
    stands_for: StandIn | None = None


class InterfacesFile(Section):
    """``interfaces.yaml``."""

    units: UnitsSection = {}
    types: dict[str, Any] = {}
    interfaces: dict[str, InterfaceSection] = {}


NamedTypes = dict[str, Entry]
"""Where each type of a workspace is written, by name: a structure, or another word for a type."""


def read_types(paths: Iterable[Path], inside: Path) -> NamedTypes:
    """The types that the files at *paths* name, for all interfaces of the workspace *inside*. Raises DseError."""
    problems = Problems()
    found: NamedTypes = {}
    for path in paths:
        with problems:
            document = read_document(path, inside)
            for name in read_section(document, InterfacesFile).types:
                entry = document["types"][name]
                check_member(name, entry.key, problems)
                if name in _WORDS or _is_unit(name):
                    problems.add(f"'{name}' is a unit or a type already", entry.key, "choose another name")
                if name in found:
                    problems.add(f"type '{name}' is defined twice", entry.key, f"see {found[name].key}")
                found.setdefault(name, entry)
    raise_if_any(problems)
    for name, entry in found.items():  # also those that no port has
        with problems:
            _members(entry, entry.data, found, (name,))
    raise_if_any(problems)
    return found


def read_own_units(paths: Iterable[Path], inside: Path) -> OwnUnits:
    """The units that the files at *paths* define for the workspace *inside*. Raises DseError."""
    documents = [read_document(path, inside) for path in paths]
    return read_units((each["units"], read_section(each, InterfacesFile).units) for each in documents)


def read_interfaces(path: Path, inside: Path, types: NamedTypes) -> dict[str, Interface]:
    """All interfaces of one file of the workspace *inside*, whose ports may be of *types*. Raises DseError."""
    file = read_document(path, inside)
    problems = Problems()
    result: dict[str, Interface] = {}
    for name, section in read_section(file, InterfacesFile).interfaces.items():
        entry = file["interfaces"][name]
        check_name(name, entry.key, problems)
        ports: list[Port] = []
        for causality, written in ((Causality.INPUT, section.inputs), (Causality.OUTPUT, section.outputs)):
            with problems:
                members = _members(entry[f"{causality}s"], written, types) if written else []
                ports += (Port(rest[1:], causality, type_) for rest, type_ in members)
        counted = Counter(port.name for port in ports)
        for port in sorted(port for port, times in counted.items() if times > 1):
            problems.add(f"port '{port}' is input and output", entry.key)
        inputs = [port.name for port in ports if port.causality is Causality.INPUT]
        for number, whole in enumerate(section.optional):
            if not any(is_part(port, whole) for port in inputs):
                problems.add(
                    f"there is no input '{whole}'", entry["optional"][number].where, closest(whole, section.inputs)
                )
        result[name] = Interface(name, tuple(ports), entry.key, tuple(section.optional))
    raise_if_any(problems)
    return result


def read_stand_ins(path: Path, inside: Path) -> dict[str, Entry]:
    """Where the interfaces of one file say what their components stand for, by their names. Raises DseError."""
    file = read_document(path, inside)
    sections = read_section(file, InterfacesFile).interfaces
    return {name: file["interfaces"][name]["stands_for"] for name in sections if sections[name].stands_for}


_WORDS = ("bool", "int", "enum", "string", "binary", "real")
_FORMS = "write a unit ('m/s', '1' for none), bool, int, string, binary, enum[a, b], an array 'm[3]', a group or a type"


def _is_unit(name: str) -> bool:
    try:
        parse_unit(name)
    except UnitError:
        return False
    return True


Members = list[tuple[str, Type]]
"""The single values of a port, group or array in order, each by what stands behind the name of the whole."""


def _members(entry: Entry, written: object, types: NamedTypes, within: tuple[str, ...] = ()) -> Members:
    """What is *written* at *entry*, inside of the types *within*. Raises DseError."""
    if isinstance(written, dict) and written:
        problems = Problems()
        found: Members = []
        for name, inner in written.items():
            check_member(name, entry[name].key, problems)
            with problems:
                found += [(f".{name}{rest}", type_) for rest, type_ in _members(entry[name], inner, types, within)]
        raise_if_any(problems)
        return _limited(found, 1, entry)
    if not isinstance(written, str | int) or isinstance(written, bool):
        raise fail(f"port '{entry.name}' needs a unit or a type", entry.where, _FORMS)
    where = entry.where
    word, shape = split_shape(str(written).strip(), where)
    if word in within:
        raise fail(f"the type '{word}' contains itself", where, "a structure has a fixed size: leave it out here")
    if word not in types:
        found = [("", _type(word, entry, types))]
    else:
        found = _members(types[word], types[word].data, types, (*within, word))
    if shape and found[0][0].startswith("["):
        raise fail(f"'{written}' is an array of arrays", where, "write all sizes together, as 'm[4, 3]'")
    if not shape:
        return found
    _limited(found, prod(shape), entry)
    return [(f"{index}{rest}", type_) for index in element_names("", shape) for rest, type_ in found]


def _limited(found: Members, times: int, entry: Entry) -> Members:
    if len(found) * times > MOST_VALUES:
        what = f"'{entry.name}' has {len(found) * times:,} values"
        raise fail(what, entry.where, f"at most {MOST_VALUES:,} are supported")
    return found


def _type(text: str, entry: Entry, types: NamedTypes) -> Type:
    where = entry.where
    try:
        type_ = read_type(text, where)
    except DseError as error:
        if not (types and text.isidentifier()):
            raise
        raise fail(f"'{text}' is neither a unit nor a type", where, closest(text, types)) from error
    if type_.unit.is_coherent:
        return type_
    what = f"port '{entry.name}' must be in a coherent SI unit, not '{type_.unit}'"
    raise fail(what, where, "signals are SI inside; convert where a person reads them (figures, metrics)")
