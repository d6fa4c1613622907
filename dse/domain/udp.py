"""Components that are somebody outside: datagrams instead of code (`dse docs udp`)."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from dse.domain.component import Causality, Component, Source, Type
from dse.errors import Location

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
    """Somebody at *host* and *port*; a server listens there. A step waits *timeout* s, a start *wait* s.

    With a *layout* the last value of what is heard must be this number. A server with *answers*, a host and a
    port, sends there instead of to the sender of a request.
    """

    kind = "udp"
    label = "UDP"

    port: int
    host: str = "127.0.0.1"
    role: LinkRole = LinkRole.CLIENT
    mode: LinkMode = LinkMode.LOCKSTEP
    timeout: float = 5.0
    wait: float = 5.0
    layout: int | None = None
    answers: tuple[str, int] | None = None
    where: Location | None = None


def sent(component: Component) -> tuple[tuple[str, Type], ...]:
    """The values of its packets in their order, with the types they have there: inputs, then parameters."""
    ports = component.interface.ports
    inputs = [(port.name, port.type) for port in ports if port.causality is Causality.INPUT]
    parameters = [(parameter.name, parameter.type) for parameter in component.parameters]
    return tuple((name, type_.in_si) for name, type_ in (*inputs, *parameters))


def heard(component: Component) -> tuple[tuple[str, Type], ...]:
    """The values of the packets it takes, in their order: outputs."""
    ports = component.interface.ports
    return tuple((p.name, p.type.in_si) for p in ports if p.causality is Causality.OUTPUT and p.name not in LINK)
