"""The client's side of a conversation, for tries: requests, sent again until something is heard."""

from __future__ import annotations

import math
import select
import socket
import time
from dataclasses import dataclass, field
from secrets import randbelow

from dse.live.packet import Flag, Packet

FIRST_PATIENCE, LONGEST_PATIENCE = 0.005, 0.2
"""Seconds until a request is sent again: at first, and at last."""
PLAIN = Flag(0)
_LARGEST_DATAGRAM = 65_536


def new_session() -> int:
    """A session that hardly anybody else has."""
    return 1 + randbelow(2**31 - 1)


def trial_values(count: int, sequence: int, wholes: frozenset[int]) -> tuple[float, ...]:
    """Values between 0 and 1, each another one, other ones in every packet of ten; 0 or 1 at the places *wholes*."""
    return tuple(
        float(sequence % 2) if place in wholes else (place + sequence % 10 / 10) / count for place in range(count)
    )


@dataclass(slots=True)
class ClientLine:
    """A datagram socket that is connected to the other side; what it says of the other side is kept in *refused*."""

    socket: socket.socket
    refused: bool = False

    def now(self) -> float:
        """Seconds, of the clock that *patience* is measured with."""
        return time.perf_counter()

    def send(self, data: bytes) -> None:
        """Send, whether or not somebody listens."""
        try:
            self.socket.send(data)
        except ConnectionError:  # a report about an earlier datagram: nobody had opened the port
            self.refused = True

    def hear(self, patience: float) -> bytes | None:
        """The next datagram within *patience* seconds, or None."""
        deadline = self.now() + patience
        while (left := deadline - self.now()) > 0:
            if not select.select([self.socket], [], [], left)[0]:
                return None
            try:
                data = self.socket.recv(_LARGEST_DATAGRAM)
            except ConnectionError:
                self.refused = True
                time.sleep(min(FIRST_PATIENCE, left))
                continue
            self.refused = False
            return data
        return None


@dataclass(slots=True)
class Timings:
    """Of exchanges so far: *seconds* of those whose request was sent once, *quickest* of all."""

    seconds: list[float] = field(default_factory=list)
    resent: int = 0
    quickest: float = math.inf


def connected_line(host: str, port: int) -> ClientLine:
    """A line to *host*, by IPv4 or IPv6. Raises OSError: no such host."""
    family, kind, protocol, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_DGRAM)[0]
    opened = socket.socket(family, kind, protocol)
    try:
        opened.connect(address)
    except BaseException:
        opened.close()
        raise
    return ClientLine(opened)


def request(
    session: int, sequence: int, seconds: float, count: int, wholes: frozenset[int], flags: Flag = PLAIN
) -> Packet:
    """A packet of the client's with trial values."""
    return Packet(session, sequence, flags, seconds, trial_values(count, sequence, wholes))
