"""Requests and WebSockets put to an ASGI application in this process, without a server."""

from __future__ import annotations

import asyncio
from collections.abc import Iterable
from typing import Any

from dse.serving.guard import Application

_HOST = (b"host", b"localhost:1")
_ORIGIN = (b"origin", b"http://localhost:1")


def _scope(kind: str, path: str, *headers: tuple[bytes, bytes]) -> dict[str, Any]:
    place, _, query = path.partition("?")
    told = {"type": kind, "path": place, "raw_path": place.encode(), "query_string": query.encode(), "root_path": ""}
    return {**told, "headers": [_HOST, _ORIGIN, *headers], "client": ("127.0.0.1", 1), "http_version": "1.1"}


async def post(application: Application, path: str, body: bytes) -> tuple[int, str]:
    """Status and text of the answer."""
    scope = _scope("http", path, (b"content-type", b"application/json")) | {"method": "POST", "scheme": "http"}
    sent: list[Any] = []

    async def receive() -> dict[str, Any]:
        return {"type": "http.request", "body": body}

    async def send(message: Any) -> None:
        sent.append(message)

    await application(scope, receive, send)
    return sent[0]["status"], b"".join(each.get("body", b"") for each in sent[1:]).decode()


async def converse(application: Application, path: str, texts: Iterable[str | bytes]) -> list[Any]:
    """What a WebSocket is sent until it is closed; each of *texts* is received when the application asks for more."""
    messages = iter(texts)
    scope = _scope("websocket", path) | {"scheme": "ws", "subprotocols": [], "extensions": {}}
    sent: list[Any] = []
    is_open = False

    async def receive() -> dict[str, Any]:
        nonlocal is_open
        if not is_open:
            is_open = True
            return {"type": "websocket.connect"}
        text = next(messages, None)
        if text is None or any(each["type"] == "websocket.close" for each in sent):
            return {"type": "websocket.disconnect", "code": 1000}
        return {"type": "websocket.receive", "text" if isinstance(text, str) else "bytes": text}

    async def send(message: Any) -> None:
        sent.append(message)
        await asyncio.sleep(0)

    await application(scope, receive, send)
    return sent
