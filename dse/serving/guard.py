"""What stands before every request: who may ask, what, how much and how often; and what goes with every answer."""

from __future__ import annotations

import asyncio
import hashlib
import hmac
import ipaddress
import secrets
import socket
import time
from collections import Counter, OrderedDict
from collections.abc import Awaitable, Callable, Iterator, MutableMapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from http.cookies import CookieError, SimpleCookie
from typing import Any
from urllib.parse import parse_qs, urlsplit

Message = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[Message]]
Send = Callable[[Message], Awaitable[None]]
Application = Callable[[Message, Receive, Send], Awaitable[None]]

HEADERS = (
    # A page has its policy inside as well, with the hashes of its own code; both hold.
    (b"content-security-policy", b"frame-ancestors 'none'; base-uri 'none'; form-action 'self'; object-src 'none'"),
    (b"x-content-type-options", b"nosniff"),
    (b"x-frame-options", b"DENY"),
    (b"referrer-policy", b"no-referrer"),
    (b"cross-origin-opener-policy", b"same-origin"),
    (b"cross-origin-resource-policy", b"same-origin"),
    (b"cache-control", b"no-store"),
)


@dataclass(frozen=True, slots=True)
class Limits:
    """The largest *body* of a request in bytes, and the *seconds* that its head and its body may take to arrive.

    A session may ask so often in a row (*burst*) and on the average (*rate*, 1/s); an address so many times as much
    (*crowd*), of which requests without a session have the share of one. *requests* are answered at once, half of them
    for one session. Of WebSockets so many are open at once (*sockets*), half of them for one session, with messages of
    so many bytes (*message*), and so many of them in a second (*messages*) from each. *waiting* are the connections
    that are kept without a request.
    """

    body: int = 64 * 1024
    seconds: float = 10.0
    burst: int = 240
    rate: float = 60.0
    crowd: int = 64
    requests: int = 128
    waiting: int = 256
    sockets: int = 16
    message: int = 4096
    messages: float = 150.0


@dataclass(slots=True)
class _Buckets:
    """A bucket of requests for each name, filled steadily; of the longest silent one nothing is known any more."""

    limits: Limits
    most: int = 1000
    left: OrderedDict[str, tuple[float, float]] = field(default_factory=OrderedDict)

    def take(self, name: str, times: int = 1) -> bool:
        """Whether *name*, which may ask so many *times* as often as others, may ask once more now."""
        now = time.monotonic()
        burst = float(times * self.limits.burst)
        tokens, then = self.left.pop(name, (burst, now))
        tokens = min(burst, tokens + (now - then) * times * self.limits.rate)
        self.left[name] = (max(0.0, tokens - 1), now)
        while len(self.left) > self.most:
            self.left.popitem(last=False)
        return tokens >= 1


BROWSER = "dse.browser"
"""In the scope of a request: its session, else its address."""


class Guard:
    """*application* behind what must hold for every request; what does not is refused with a line that says why.

    The ``Host`` must be this machine, so that no name of a stranger's can be turned to it (DNS rebinding):
    ``localhost`` or a loopback address, with *is_open* also any address in numbers and the machine's own names. What
    changes something, and every WebSocket, must come from a page of ours (``Origin``).

    Each browser has a session, a signed number in a cookie that no script reads and no other site sends, so that those
    who share an address (``ssh -L``) do not share one allowance. Without a *token* the first answer starts it; with
    one, a ``GET`` with ``?token=`` does, and without a session nothing is shown or done.
    """

    def __init__(
        self, application: Application, *, token: str = "", is_open: bool = False, limits: Limits | None = None
    ) -> None:
        self._application = application
        self._token = token
        self._key = secrets.token_bytes(32)
        # Browsers keep the cookies of all ports of a machine together.
        self._cookie = f"dse-{hashlib.sha256(self._key).hexdigest()[:12]}"
        self._is_open = is_open
        self._limits = limits or Limits()
        self._buckets = _Buckets(self._limits)
        self._requests: Counter[str] = Counter()
        self._sockets: Counter[str] = Counter()
        self._names = {"localhost"} | ({name.lower() for name in _own_names()} if is_open else set())

    async def __call__(self, scope: Message, receive: Receive, send: Send) -> None:
        """An ASGI application."""
        if scope["type"] not in ("http", "websocket"):
            raise ValueError(f"'{scope['type']}' is not served")
        headers: dict[bytes, bytes] = {}
        for name, value in scope["headers"]:
            headers[name] = b"\0" if name in headers and name in (b"host", b"origin") else value
        if scope["type"] == "websocket":
            await self._converse(scope, headers, receive, send)
            return
        session = self._session(headers)
        refusal = self._refusal(scope, headers, session)
        if refusal is None and self._token and not session:
            await self._admit(scope, send)
            return
        body = b""
        if refusal is None and scope["method"] == "POST":
            body, refusal = await self._read(headers, receive)
        if refusal is not None:
            await _answer_text(send, *refusal)
            return
        cookie = None if session or scope["method"] != "GET" else self._new_session()
        with _counted(self._requests, session or _address(scope), self._limits.requests) as is_free:
            if not is_free:
                await _answer(send, 503, b"text/html; charset=utf-8", _FULL, (b"retry-after", b"5"))
                return
            # Whoever still waits when the server ends hears nothing more; that is no mistake of the application.
            with suppress(asyncio.CancelledError):
                known = {**scope, BROWSER: session or _address(scope)}
                await self._application(known, _replayed(body, receive), _with_headers(send, cookie))

    async def _converse(self, scope: Message, headers: dict[bytes, bytes], receive: Receive, send: Send) -> None:
        """Let a WebSocket through to the application, if it may be opened; what comes is measured and counted."""
        session = self._session(headers)
        refusal = self._stranger(scope, headers, session)
        if refusal is None and headers.get(b"origin", b"").decode("latin-1") != _origin(scope, headers):
            refusal = 403, "the request is not from a page of this server"
        if refusal is None and self._token and not session:
            refusal = 401, "open the printed address, which contains the token"
        with _counted(self._sockets, session or _address(scope), self._limits.sockets) as is_free:
            if refusal is None and not is_free:
                refusal = 503, "too many pages are connected; close one"
            if refusal is not None:
                await receive()
                await _refuse(scope, send, *refusal)
                return
            with suppress(asyncio.CancelledError):
                await self._application(scope, _measured(receive, send, self._limits), send)

    def _stranger(self, scope: Message, headers: dict[bytes, bytes], session: str) -> tuple[int, str] | None:
        address = _address(scope)
        if not self._buckets.take(f"all of {address}", self._limits.crowd) or not self._buckets.take(
            session or address
        ):
            return 429, "too many requests; wait a moment"
        if not self._is_here(headers.get(b"host", b"").decode("latin-1")):
            return 421, "this server does not have that host name"
        return None

    def _refusal(self, scope: Message, headers: dict[bytes, bytes], session: str) -> tuple[int, str] | None:
        if (refusal := self._stranger(scope, headers, session)) is not None:
            return refusal
        if scope["method"] not in ("GET", "HEAD", "POST"):
            return 405, "only GET, HEAD and POST"
        if scope["method"] == "POST":
            if headers.get(b"origin", b"").decode("latin-1") != _origin(scope, headers):
                return 403, "the request is not from a page of this server"
            if headers.get(b"content-type", b"").partition(b";")[0].strip() != b"application/json":
                return 415, "only application/json"
        return None

    def _is_here(self, host: str) -> bool:
        try:
            name = urlsplit(f"//{host}").hostname or ""
        except ValueError:
            return False
        if name in self._names:
            return True
        try:
            address = ipaddress.ip_address(name.partition("%")[0])
        except ValueError:
            return False
        return self._is_open or address.is_loopback

    def _session(self, headers: dict[bytes, bytes]) -> str:
        """The session whose cookie is sent; "" if there is none that this server has signed."""
        try:
            cookie = SimpleCookie(headers.get(b"cookie", b"").decode("latin-1")).get(self._cookie)
        except CookieError:
            return ""
        number, _, signature = cookie.value.partition(".") if cookie else ("", "", "")
        return number if _is_same(signature, self._signature(number)) else ""

    def _new_session(self) -> bytes:
        number = secrets.token_hex(8)
        return f"{self._cookie}={number}.{self._signature(number)}; HttpOnly; SameSite=Strict; Path=/".encode()

    def _signature(self, number: str) -> str:
        return hmac.digest(self._key, number.encode(), "sha256").hex()

    async def _admit(self, scope: Message, send: Send) -> None:
        """Take the token from the address, once; the page that follows is asked for without it."""
        query = parse_qs(scope["query_string"].decode("latin-1"))
        given = (query.get("token") or [""])[0]
        if scope["method"] != "GET" or not _is_same(given, self._token):
            await _answer_text(send, 401, "open the printed address, which contains the token")
            return
        # A redirect would still be the other site's doing, from which the cookie is not sent.
        place = b"/drive" if scope["path"] == "/drive" else b"/"
        page = (
            b'<!doctype html><meta charset="utf-8"><meta http-equiv="refresh" content="0;url=%s"><a href="%s">Go on</a>'
            % (place, place)
        )
        await _answer(send, 200, b"text/html; charset=utf-8", page, (b"set-cookie", self._new_session()))

    async def _read(self, headers: dict[bytes, bytes], receive: Receive) -> tuple[bytes, tuple[int, str] | None]:
        """The body, or why it is refused."""
        most = self._limits.body
        too_large = 413, f"more than {most} bytes"
        late = 408, "the request was not completed in time"
        told = headers.get(b"content-length", b"0")
        if not told.isdigit() or int(told[:20]) > most:
            return b"", too_large
        body = b""
        try:
            async with asyncio.timeout(self._limits.seconds):
                while True:
                    message = await receive()
                    body += message.get("body", b"")
                    if len(body) > most:
                        return b"", too_large
                    if message["type"] == "http.disconnect":
                        return b"", late
                    if not message.get("more_body"):
                        return body, None
        except TimeoutError:
            return b"", late


_FULL = (
    b'<!doctype html><html lang="en"><meta charset="utf-8"><meta http-equiv="refresh" content="5">'
    b"<title>The server is busy</title><h1>The server is busy</h1>"
    b"<p>It answers as many requests as it can at once. This page tries again in 5 seconds.</p></html>\n"
)


@contextmanager
def _counted(counts: Counter[str], name: str, most: int) -> Iterator[bool]:
    """Count *name* inside the block. False if there were *most* in all already, or half of them of that name."""
    is_free = counts.total() < most and counts[name] < (most + 1) // 2
    counts[name] += is_free
    try:
        yield is_free
    finally:
        counts[name] -= is_free
        counts += Counter()  # forgets those that are 0


def _is_same(given: str, known: str) -> bool:
    return hmac.compare_digest(given.encode(), known.encode())


def _address(scope: Message) -> str:
    return str(scope["client"][0]) if scope.get("client") else ""


def _origin(scope: Message, headers: dict[bytes, bytes]) -> str:
    """What a browser calls a page of this server."""
    scheme = {"ws": "http", "wss": "https"}.get(scope.get("scheme", "http"), scope.get("scheme", "http"))
    return f"{scheme}://{headers.get(b'host', b'').decode('latin-1')}"


def _measured(receive: Receive, send: Send, limits: Limits) -> Receive:
    """*receive* of a WebSocket that is closed where a message is too large, or they come too often."""
    bucket = _Buckets(Limits(burst=int(2 * limits.messages), rate=limits.messages))

    async def received() -> Message:
        message = await receive()
        if message["type"] != "websocket.receive":
            return message
        size = len((message.get("text") or "").encode()) + len(message.get("bytes") or b"")
        if size <= limits.message and bucket.take(""):
            return message
        code = _TOO_LARGE if size > limits.message else _TOO_MUCH
        with suppress(Exception):  # it is closed already
            await send({"type": "websocket.close", "code": code})
        return {"type": "websocket.disconnect", "code": code}

    return received


_TOO_LARGE, _TOO_MUCH = 1009, 1008


async def _refuse(scope: Message, send: Send, status: int, why: str) -> None:
    if "websocket.http.response" not in scope.get("extensions", {}):
        await send({"type": "websocket.close", "code": _TOO_MUCH, "reason": why})
        return
    body = f"{why}\n".encode()
    headers = [(b"content-type", b"text/plain; charset=utf-8"), (b"content-length", str(len(body)).encode()), *HEADERS]
    await send({"type": "websocket.http.response.start", "status": status, "headers": headers})
    await send({"type": "websocket.http.response.body", "body": body})


def _own_names() -> set[str]:
    return {socket.gethostname(), socket.getfqdn()}


def _replayed(body: bytes, receive: Receive) -> Receive:
    """*receive* of an application that has not read the *body* yet."""
    is_read = False

    async def again() -> Message:
        nonlocal is_read
        if is_read:
            return await receive()
        is_read = True
        return {"type": "http.request", "body": body, "more_body": False}

    return again


def _with_headers(send: Send, cookie: bytes | None) -> Send:
    ours = [*HEADERS, (b"set-cookie", cookie)] if cookie else HEADERS

    async def sent(message: Message) -> None:
        if message["type"] == "http.response.start":
            names = {name for name, _ in HEADERS}
            kept = [(name, value) for name, value in message.get("headers", []) if name not in names]
            message = {**message, "headers": [*kept, *ours]}
        await send(message)

    return sent


async def _answer_text(send: Send, status: int, why: str) -> None:
    await _answer(send, status, b"text/plain; charset=utf-8", f"{why}\n".encode())


async def _answer(send: Send, status: int, kind: bytes, body: bytes, *more: tuple[bytes, bytes]) -> None:
    headers = [(b"content-type", kind), (b"content-length", str(len(body)).encode()), *more, *HEADERS]
    await send({"type": "http.response.start", "status": status, "headers": headers})
    await send({"type": "http.response.body", "body": body})
