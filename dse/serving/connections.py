"""Connections on which a request is awaited: how long it may take, and how many are kept.

A connection costs nothing to open: if silent ones counted as requests, some dozens would lock everybody out. They do
not. A silent connection is closed after some seconds, or earlier, if there are too many: the oldest one of the address
that has the most. The connection of a good client is the newest, and its request arrives at once.
"""

from __future__ import annotations

import asyncio
from collections import defaultdict
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from uvicorn.protocols.http.h11_impl import H11Protocol


@dataclass(slots=True)
class Waiting:
    """At most *most* connections on which a request is awaited, by address, the oldest first."""

    most: int
    count: int = 0
    by_address: defaultdict[str, dict[H11Protocol, None]] = field(default_factory=lambda: defaultdict(dict))

    def add(self, connection: H11Protocol) -> None:
        """Another one; if there are too many, one is closed."""
        self.remove(connection)
        self.by_address[_address(connection)][connection] = None
        self.count += 1
        if self.count > self.most:
            most = max(self.by_address, key=lambda address: len(self.by_address[address]))
            oldest = next(iter(self.by_address[most]))
            self.remove(oldest)
            oldest.transport.abort()

    def remove(self, connection: H11Protocol) -> None:
        """It has a request now, or is closed."""
        address = _address(connection)
        known = self.by_address[address]
        if connection in known:
            del known[connection]
            self.count -= 1
        if not known:
            del self.by_address[address]


def protocol(most: int, seconds: float) -> type[asyncio.Protocol]:
    """HTTP/1.1 as uvicorn speaks it, with *seconds* for the head of each request to arrive.

    Of the connections on which a request is awaited *most* are kept.
    """
    from uvicorn.protocols.http.h11_impl import H11Protocol

    waiting = Waiting(most)

    class Connection(H11Protocol):
        deadline: asyncio.TimerHandle | None = None

        def connection_made(self, transport: Any) -> None:
            super().connection_made(transport)
            self._await_head()

        def connection_lost(self, exc: Exception | None) -> None:
            self._end_wait()
            super().connection_lost(exc)

        def handle_events(self) -> None:
            super().handle_events()
            request = self.cycle
            if request is not None and not request.response_complete:
                self._stop_clock()
                if not request.more_body:
                    self._end_wait()

        def handle_websocket_upgrade(self, event: Any) -> None:
            self._end_wait()
            super().handle_websocket_upgrade(event)

        def on_response_complete(self) -> None:
            self._await_head()
            super().on_response_complete()

        def _await_head(self) -> None:
            self._stop_clock()
            self.deadline = self.loop.call_later(seconds, self.transport.close)
            waiting.add(self)

        def _end_wait(self) -> None:
            self._stop_clock()
            waiting.remove(self)

        def _stop_clock(self) -> None:
            if self.deadline is not None:
                self.deadline.cancel()

    return Connection


def _address(connection: H11Protocol) -> str:
    return connection.client[0] if connection.client else ""
