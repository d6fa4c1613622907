"""Reads interfaces."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from dse.domain.component import Causality, Interface, Port
from dse.errors import Problems, raise_if_any
from dse.formats import Entry
from dse.loading.include import read_document
from dse.loading.names import check_member, check_name
from dse.loading.sections import Section, read_section
from dse.loading.values import read_type


class InterfaceSection(Section):
    """One interface: ports by name, groups of ports nested."""

    title: str = ""
    inputs: dict[str, Any] = {}
    outputs: dict[str, Any] = {}


class InterfacesFile(Section):
    """``interfaces.yaml``."""

    interfaces: dict[str, InterfaceSection]


def read_interfaces(path: Path, inside: Path) -> dict[str, Interface]:
    """All interfaces of one file of the workspace *inside*. Raises DseError."""
    file = read_document(path, inside)
    problems = Problems()
    result: dict[str, Interface] = {}
    for name, section in read_section(file, InterfacesFile).interfaces.items():
        entry = file["interfaces"][name]
        check_name(name, entry.key, problems)
        ports: list[Port] = []
        for causality, entries in ((Causality.INPUT, section.inputs), (Causality.OUTPUT, section.outputs)):
            ports += _ports(entry[f"{causality}s"], entries, causality, "", problems)
        twice = {port.name for port in ports if sum(port.name == other.name for other in ports) > 1}
        for port in sorted(twice):
            problems.add(f"port '{port}' is input and output", entry.key)
        result[name] = Interface(name, tuple(ports), entry.key)
    raise_if_any(problems)
    return result


def _ports(
    group: Entry, entries: Mapping[str, Any], causality: Causality, prefix: str, problems: Problems
) -> Iterator[Port]:
    for name, written in entries.items():
        entry, full = group[name], f"{prefix}{name}"
        check_member(name, entry.key, problems)
        if isinstance(written, dict) and written:
            yield from _ports(entry, written, causality, f"{full}.", problems)
            continue
        if not isinstance(written, str | int):
            hint = "write a unit ('m/s', '1' for none), bool, int, enum[a, b], or a group {port: unit}"
            problems.add(f"port '{full}' needs a unit or a type", entry.where, hint)
            continue
        with problems:
            type_ = read_type(str(written), entry.where)
            if type_.unit.is_coherent:
                yield Port(full, causality, type_)
            else:
                what = f"port '{full}' must be in a coherent SI unit, not '{type_.unit}'"
                hint = "signals are SI inside; convert where a person reads them (figures, metrics)"
                problems.add(what, entry.where, hint)
