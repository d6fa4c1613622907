"""The addresses of the test drive: its page, what can be chosen, a drive's beginning, and the WebSocket of one."""

from __future__ import annotations

import asyncio
import json
from collections.abc import AsyncIterator, Awaitable, Callable, Mapping
from contextlib import asynccontextmanager, suppress
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, TypeVar

from dse.api import LiveDrive, SharedDrive
from dse.errors import DseError, fail
from dse.serving.drives import Held, LiveDrives
from dse.serving.guard import BROWSER
from dse.serving.pages import document, drive_page, study_address
from dse.serving.point_requests import read_request

if TYPE_CHECKING:
    from starlette.requests import Request
    from starlette.responses import Response
    from starlette.routing import BaseRoute
    from starlette.websockets import WebSocket

T = TypeVar("T")
Aside = Callable[[Callable[[], Any]], Awaitable[Any]]

RATE = 30.0
"""Frames in a second, at most."""
WORLD_EVERY = 0.5
"""Seconds between two accounts of who is in a shared world."""
MOST_MISTAKES = 20
"""Messages that are none, after which a page is hung up on."""


def _keeping_page() -> str:
    """What is seen until a drive is a run."""
    body = (
        '<section class="card"><p>The drive is simulated again as a run of its study, and so is the car '
        "without a driver, unless that run exists. Then the report opens automatically.</p>"
        '<progress aria-label="The drive is simulated"></progress></section>'
    )
    return document("The drive becomes a run", body, '<a href="/drive">Test drive</a>')


def drive_routes(drives: LiveDrives, aside: Aside) -> list[BaseRoute]:
    """What a server of *drives* answers; *aside* has work done while others are answered."""
    from starlette.responses import HTMLResponse, JSONResponse, RedirectResponse
    from starlette.routing import Route, WebSocketRoute
    from starlette.websockets import WebSocketDisconnect

    def page(_: Request) -> Response:
        return HTMLResponse(drive_page({"benches": drives.benches, "rate": RATE, "shared": drives.shared is not None}))

    async def offer(request: Request) -> Response:
        query = request.query_params
        bench, chosen = query.get("bench", ""), query.get("chosen", "")
        return JSONResponse(await aside(lambda: drives.offer(bench, chosen)))

    async def boards(_: Request) -> Response:
        return JSONResponse({"boards": await aside(drives.boards)})

    async def results(request: Request) -> Response:
        name = request.path_params["name"]
        if drives.is_keeping(name):
            return HTMLResponse(_keeping_page(), headers={"Refresh": "1"})
        return RedirectResponse(study_address(await aside(lambda: drives.study_of(name))), 303)

    async def start(request: Request) -> Response:
        order = read_request(await request.body(), _Order)
        named = order.chosen if isinstance(order.chosen, str) else ",".join(map(":".join, order.chosen.items()))
        browser = str(request.scope.get(BROWSER, ""))
        opened = aside(lambda: drives.open(order.bench, named, order.configuration, order.driver, browser))
        return JSONResponse({"drive": await opened})

    def world(_: Request) -> Response:
        return JSONResponse(drives.shared.data() if drives.shared else {"seats": []})

    async def live(socket: WebSocket) -> None:
        await socket.accept()
        if "watch" in socket.query_params:
            await _watch(socket, drives)
            return
        held = drives.enter(socket.query_params.get("drive", ""))
        if held is None:
            with suppress(WebSocketDisconnect, RuntimeError):
                await socket.send_json(_ended("there is no such drive; it may have ended long ago"))
                await socket.close()
            return
        drives_on = asyncio.create_task(_show(socket, drives, held, aside))
        try:
            await _listen(socket, held)
        finally:
            drives_on.cancel()
            drives.leave(held)

    return [
        Route("/drive", page),
        Route("/drive/offer", offer),
        Route("/drive/boards", boards),
        Route("/drive/world", world),
        Route("/drive/results/{name}", results),
        Route("/drive/start", start, methods=["POST"]),
        WebSocketRoute("/drive/live", live),
    ]


async def _show(socket: WebSocket, drives: LiveDrives, held: Held, aside: Aside) -> None:
    """Send the scene, then the newest of the run as often as the page takes it, in the end why it is over."""
    async with _hung_up_on(socket):
        await _stream(socket, drives, held.live, {"token": held.token})
        told = await aside(partial(drives.told, held))
        await socket.send_text(json.dumps(told))
        await socket.close()


@asynccontextmanager
async def _hung_up_on(socket: WebSocket) -> AsyncIterator[None]:
    """Within the block the page may be gone; if anything else fails, it is hung up on, and does not wait for ever."""
    from starlette.websockets import WebSocketDisconnect

    try:
        yield
    except (WebSocketDisconnect, RuntimeError, OSError):
        return
    except Exception:
        with suppress(RuntimeError):
            await socket.close(1011, "the server has failed")
        raise


async def _stream(socket: WebSocket, drives: LiveDrives, live: LiveDrive, also: Mapping[str, object]) -> None:
    """The scene, then frames until the drive is over; now and then who else is in its world."""
    scene = {**live.scene(), "rate": RATE, **also}
    if drives.shared and isinstance(live, SharedDrive):
        scene["seat"] = live.seating.place.number
    await socket.send_text(json.dumps(scene, allow_nan=False))
    loop, sent, told = asyncio.get_running_loop(), b"", ""
    until = told_until = loop.time()
    while live.ended is None:
        frame = live.frame()
        if frame is not None and frame != sent:
            # Waits where the page does not take it: then it gets fewer, and nothing is queued.
            await socket.send_bytes(frame)
            sent = frame
        if drives.shared and loop.time() >= told_until:
            told_until = loop.time() + WORLD_EVERY
            if (text := json.dumps(drives.shared.data(), allow_nan=False)) != told:
                await socket.send_text(text)
                told = text
        until = max(until + 1 / RATE, loop.time())
        await asyncio.sleep(until - loop.time())


async def _watch(socket: WebSocket, drives: LiveDrives) -> None:
    """Show a drive of the shared world to somebody who takes no part in it: what the page says is not heard."""
    from starlette.websockets import WebSocketDisconnect

    live = drives.shared.drive(socket.query_params["watch"]) if drives.shared else None
    if live is None:
        with suppress(WebSocketDisconnect, RuntimeError):
            await socket.send_json(_ended("this seat has no driver"))
            await socket.close()
        return

    async def show() -> None:
        async with _hung_up_on(socket):
            await _stream(socket, drives, live, {"watched": live.driver})
            await socket.send_json(_ended(f"{live.driver} has left the world"))
            await socket.close()

    showing = asyncio.create_task(show())
    try:
        while (await socket.receive())["type"] == "websocket.receive":
            pass
    finally:
        showing.cancel()


async def _listen(socket: WebSocket, held: Held) -> None:
    """Do what the page says, until it goes or says what nobody understands too often."""
    mistakes = 0
    while True:
        message = await socket.receive()
        if message["type"] != "websocket.receive":
            return
        try:
            _obey(held, message.get("text") or "")
        except DseError:
            mistakes += 1
            if mistakes >= MOST_MISTAKES:
                with suppress(RuntimeError):
                    await socket.close(1008, "this is not understood")
                return


@dataclass(frozen=True, slots=True)
class _Message:
    """What a page says; *n* is echoed by the frames that follow from it."""

    type: str
    n: int = 0
    values: Mapping[str, Any] | None = None


@dataclass(frozen=True, slots=True)
class _Order:
    """A drive to begin; *chosen* as ``path:name,…`` or by path."""

    bench: str
    chosen: Mapping[str, str] | str = ""
    configuration: str = ""
    driver: str = ""


def _obey(held: Held, text: str) -> None:
    """DseError for what is no message; nothing is done then."""
    match read_request(text, _Message):
        case _Message("finish"):
            held.live.finish()
        case _Message("control", n, dict(values)) if 0 <= n < 1 << 53:
            held.live.control(values, n)
        case _Message("tune", n, dict(values)) if 0 <= n < 1 << 53:
            held.live.tune(values, n)
        case _:
            raise fail("the request is invalid: it has no known type, or no values")


def _ended(text: str) -> Mapping[str, object]:
    return {"type": "ended", "why": "limit", "text": text, "drive": None, "verdicts": []}
