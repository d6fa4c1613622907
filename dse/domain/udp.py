"""Components that are somebody outside: datagrams instead of code (docs/udp.md)."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from dse.domain.component import Causality, Component, Source, Type
from dse.errors import Location
from dse.units import coherent

INHERITED = ""
"""The host of a component whose socket this process was started with: its number stands in ``DSE_LIVE_SOCKET``."""
LINK = ("link.resent", "link.ignored", "link.overruns", "link.lateness")
"""Outputs that nobody outside gives: packets sent again and ignored, deadlines missed, and by how many s the last."""


class LinkRole(StrEnum):
    """Who begins a session, and asks."""

    CLIENT = "client"
    SERVER = "server"


class LinkMode(StrEnum):
    """What a step waits for."""

    LOCKSTEP = "lockstep"
    FREE = "free"


@dataclass(frozen=True, slots=True)
class UdpSource(Source):
    """Somebody at *host* and *port*; a server listens there. A step waits *timeout* s, a start *wait* s."""

    kind = "udp"
    label = "UDP"

    port: int
    host: str = "127.0.0.1"
    role: LinkRole = LinkRole.CLIENT
    mode: LinkMode = LinkMode.LOCKSTEP
    timeout: float = 5.0
    wait: float = 5.0
    where: Location | None = None


def sent(component: Component) -> tuple[tuple[str, Type], ...]:
    """The values of its packets in their order: inputs in the unit of their port, parameters in SI."""
    ports = component.interface.ports
    return (
        *((port.name, port.type) for port in ports if port.causality is Causality.INPUT),
        *((p.name, Type(p.type.kind, coherent(p.type.unit), p.type.items)) for p in component.parameters),
    )


def heard(component: Component) -> tuple[tuple[str, Type], ...]:
    """The values of the packets it takes, in their order: outputs in the unit of their port."""
    ports = component.interface.ports
    return tuple((p.name, p.type) for p in ports if p.causality is Causality.OUTPUT and p.name not in LINK)
