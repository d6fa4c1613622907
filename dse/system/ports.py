"""Ends of connections: finding the port a path names, and whether two ports carry the same signal."""

from __future__ import annotations

from collections.abc import Mapping

from dse.domain.component import Component, Kind, Port, Type
from dse.domain.design import Connection, split_path
from dse.errors import DseError, Problem


def find_port(end: str, parts: Mapping[str, Component], connection: Connection | None = None) -> tuple[str, str, Port]:
    """The part, the port's name and the port that the dotted path *end* names. Raises DseError."""
    split = split_path(end, parts)
    if split is None:
        where = connection.where if connection else None
        raise DseError(
            Problem(f"{connection or end}: no part stands at '{end}'", where, f"parts: {', '.join(sorted(parts))}")
        )
    part, name = split
    port = parts[part].interface.port(name)
    if port is None:
        raise DseError(_no_port(end, part, name, parts[part], connection))
    return part, name, port


def same_signal(source: Type, target: Type) -> str:
    """Why a connection between the two types is wrong, or "" if it is right."""
    if source.kind is not target.kind:
        return f"types differ: {source} and {target}"
    if source.kind is Kind.ENUMERATION and source.items != target.items:
        return f"types differ: {source} and {target}"
    if source.kind is Kind.REAL and source.unit.dimension != target.unit.dimension:
        return f"units differ: {source} and {target}"
    return ""


def _no_port(end: str, part: str, name: str, component: Component, connection: Connection | None) -> Problem:
    interface = component.interface
    if interface.group(name):
        what = f"'{end}' is a group of ports"
    else:
        what = f"{part} ({component.name}, {interface.name}) has no port '{name}'"
    known = ", ".join(port.name for port in interface.ports)
    head = f"{connection}: " if connection else ""
    return Problem(f"{head}{what}", connection.where if connection else None, f"ports: {known}")
