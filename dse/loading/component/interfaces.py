"""Reads interfaces."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from dse.domain.component import Causality, Interface, Port
from dse.errors import DseError, Problem, raise_if_any
from dse.formats.yaml import Document, Path_
from dse.loading.documents import InterfacesFile
from dse.loading.fields import read_section
from dse.loading.include import read_document
from dse.loading.names import check_member, check_name
from dse.loading.values import read_type


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
