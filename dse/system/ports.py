"""Ends of connections: finding the port a path names."""

from __future__ import annotations

from collections.abc import Mapping

from dse.domain.component import Component, Port
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


def _no_port(end: str, part: str, name: str, component: Component, connection: Connection | None) -> Problem:
    interface = component.interface
    if interface.group(name):
        what = f"'{end}' is a group of ports"
    else:
        what = f"{part} ({component.name}, {interface.name}) has no port '{name}'"
    known = ", ".join(port.name for port in interface.ports)
    head = f"{connection}: " if connection else ""
    return Problem(f"{head}{what}", connection.where if connection else None, f"ports: {known}")
