"""The server: a socket, the application behind it, and an end with Ctrl-C."""

from __future__ import annotations

import errno
import ipaddress
import logging
import secrets
import socket
from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import dataclass
from typing import TYPE_CHECKING

from dse.errors import fail
from dse.serving.application import application
from dse.serving.connections import protocol
from dse.serving.drives import LiveDrives
from dse.serving.guard import Application, Limits
from dse.serving.study_index import StudyIndex

if TYPE_CHECKING:
    import uvicorn

LOOPBACK = "127.0.0.1"
"""Where the server listens unless it is told otherwise: only programs of this machine reach it."""

PORT = 8470
"""The port unless another one is asked for."""

_TO_FINISH = 3
"""Seconds that requests have to come to their end when the server stops."""

_LIMITS = Limits()
MOST_MESSAGE = _LIMITS.message
"""Bytes of a message over a WebSocket."""
_MOST_HEAD = 32 * 1024


@dataclass(frozen=True, slots=True)
class Announced:
    """The server listens: *address* is what a browser opens, with a token in it if there is one."""

    address: str
    has_token: bool


def serve(
    index: StudyIndex,
    *,
    listen: str = "",
    port: int = PORT,
    tell: Callable[[Announced], None],
    drives: LiveDrives | None = None,
) -> None:
    """Serve the studies of *index*, and *drives*, until the program is interrupted; *tell* is called once it listens.

    On the loopback address, or on *listen*, an address in numbers of this machine (``0.0.0.0``: all), with a token.
    Port 0 is any free one. Raises DseError if it cannot listen there, or without the extra ``serve``.
    """
    token = secrets.token_urlsafe(32) if listen else ""
    address = _address(listen or LOOPBACK)
    guarded = application(index, token=token, is_open=not address.is_loopback, drives=drives)
    with _listening(address, port) as listener, drives or nullcontext():
        tell(_announced(address, listener.getsockname()[1], token, "drive" if drives else ""))
        server_of(guarded).run(sockets=[listener])


def server_of(guarded: Application, limits: Limits = _LIMITS) -> uvicorn.Server:
    """What runs *guarded*; of *limits* it keeps those of connections without a request."""
    import uvicorn

    logging.getLogger("uvicorn.error").addFilter(_without_trace)

    return uvicorn.Server(
        uvicorn.Config(
            guarded,
            http=protocol(limits.waiting, limits.seconds),
            ws="websockets-sansio",
            ws_max_size=MOST_MESSAGE,
            ws_per_message_deflate=False,
            loop="asyncio",
            lifespan="off",
            interface="asgi3",
            log_config=None,
            access_log=False,
            server_header=False,
            proxy_headers=False,
            h11_max_incomplete_event_size=_MOST_HEAD,
            timeout_graceful_shutdown=_TO_FINISH,
        )
    )


def _without_trace(record: logging.LogRecord) -> bool:
    """A page that sends bytes which are no text is worth one line, of what uvicorn tells with a traceback."""
    if record.exc_info and isinstance(record.exc_info[1], UnicodeDecodeError):
        record.exc_info = None
    return True


Address = ipaddress.IPv4Address | ipaddress.IPv6Address


def _address(text: str) -> Address:
    try:
        return ipaddress.ip_address(text)
    except ValueError:
        hint = "give a numeric address, as 192.168.1.20; 0.0.0.0 is every address of this machine"
        raise fail(f"'{text}' is not an address to listen on", hint=hint) from None


def _listening(address: Address, port: int) -> socket.socket:
    family = socket.AF_INET if address.version == 4 else socket.AF_INET6
    try:
        return socket.create_server((str(address), port), family=family, backlog=_LIMITS.waiting)
    except OSError as error:
        if error.errno == errno.EADDRINUSE:
            what, hint = (
                f"port {port} is taken, perhaps by another 'dse serve'",
                "give another with --port; 0 is any free one",
            )
        elif error.errno == errno.EACCES:
            what, hint = f"port {port} may not be used", "give one above 1023 with --port"
        else:
            what = f"cannot listen on {address}: {error.strerror or error}"
            hint = "give an address of this machine with --listen"
        raise fail(what, hint=hint) from error


def _announced(address: Address, port: int, token: str, page: str) -> Announced:
    """Of all addresses of the machine its name is told."""
    name = socket.gethostname() if address.is_unspecified else f"[{address}]" if address.version == 6 else str(address)
    return Announced(f"http://{name}:{port}/{page}" + (f"?token={token}" if token else ""), bool(token))
