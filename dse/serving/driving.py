"""The addresses of the test drive: its page, what can be chosen, a drive's beginning, and the WebSocket of one."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Awaitable, Callable, Mapping
from contextlib import suppress
from functools import partial
from typing import TYPE_CHECKING, Any, TypeVar

from dse.errors import DseError, fail
from dse.serving.drives import Held, LiveDrives
from dse.serving.pages import document, drive_page, study_address

if TYPE_CHECKING:
    from starlette.requests import Request
    from starlette.responses import Response
    from starlette.routing import BaseRoute
    from starlette.websockets import WebSocket

T = TypeVar("T")
Aside = Callable[[Callable[[], Any]], Awaitable[Any]]

RATE = 30.0
"""Frames in a second, at most."""
MOST_MISTAKES = 20
"""Messages that are none, after which a page is hung up on."""
_MOST_TEXT = 20_000
_MOST_CONTROLS = 4000


def _keeping_page() -> str:
    """What is seen until a drive is a run."""
    body = (
        '<section class="card"><p>The drive is simulated once more as a run of its study, and so is the car with '
        "nobody at the wheel, unless it was before. Then the report opens by itself.</p>"
        '<progress aria-label="The drive is simulated"></progress></section>'
    )
    return document("The drive becomes a run", body, '<a href="/drive">Test drive</a>')


def drive_routes(drives: LiveDrives, aside: Aside) -> list[BaseRoute]:
    """What a server of *drives* answers; *aside* has work done while others are answered."""
    from starlette.responses import HTMLResponse, JSONResponse, RedirectResponse
    from starlette.routing import Route, WebSocketRoute

    def page(_: Request) -> Response:
        return HTMLResponse(drive_page({"benches": drives.benches, "rate": RATE}))

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
        asked = _asked(await request.body())
        return JSONResponse({"drive": await aside(lambda: drives.open(*asked))})

    async def live(socket: WebSocket) -> None:
        held = drives.enter(socket.query_params.get("drive", ""))
        await socket.accept()
        if held is None:
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
        Route("/drive/results/{name}", results),
        Route("/drive/start", start, methods=["POST"]),
        WebSocketRoute("/drive/live", live),
    ]


async def _show(socket: WebSocket, drives: LiveDrives, held: Held, aside: Aside) -> None:
    """Send the scene, then the newest of the run as often as the page takes it, in the end why it is over."""
    with suppress(RuntimeError, OSError):  # the page is gone
        scene = {**held.live.scene(), "rate": RATE, "token": held.token}
        await socket.send_text(json.dumps(scene, allow_nan=False))
        loop, sent = asyncio.get_running_loop(), b""
        until = loop.time()
        while held.live.ended is None:
            frame = held.live.frame()
            if frame is not None and frame != sent:
                # Waits where the page does not take it: then it gets fewer, and nothing is queued.
                await socket.send_bytes(frame)
                sent = frame
            until = max(until + 1 / RATE, loop.time())
            await asyncio.sleep(until - loop.time())
        told = await aside(partial(drives.told, held))
        await socket.send_text(json.dumps(told))
        await socket.close()


async def _listen(socket: WebSocket, held: Held) -> None:
    """Do what the page says, until it goes or says what nobody understands too often."""
    mistakes = 0
    while True:
        message = await socket.receive()
        if message["type"] != "websocket.receive":
            return
        try:
            _obey(held, _told(message.get("text")))
        except DseError:
            mistakes += 1
            if mistakes >= MOST_MISTAKES:
                with suppress(RuntimeError):
                    await socket.close(1008, "this is not understood")
                return


def _obey(held: Held, told: Mapping[str, Any]) -> None:
    """DseError for what is no message; nothing is done then."""
    number = told.get("n", 0)
    if isinstance(number, bool) or not isinstance(number, int) or not 0 <= number < 1 << 53:
        raise fail("its number is none")
    match told:
        case {"type": "finish"}:
            held.live.finish()
        case {"type": "control", "values": dict(values)}:
            held.live.control(values, number)
        case {"type": "tune", "values": dict(values)}:
            held.live.tune(values, number)
        case _:
            raise fail("it is of no kind")


def _told(text: str | None) -> Mapping[str, Any]:
    try:
        told = json.loads(text or "")
    except (ValueError, RecursionError) as error:
        raise fail("it is no JSON") from error
    if not isinstance(told, dict):
        raise fail("it is no object")
    return told


def _asked(body: bytes) -> tuple[str, str, str, str]:
    """Bench, choices, configuration and driver's name. DseError for anything else."""
    try:
        told = json.loads(body)
        chosen = told.get("chosen", "")
        if isinstance(chosen, dict):
            chosen = ",".join(f"{path}:{name}" for path, name in chosen.items())
        found = told["bench"], chosen, told.get("configuration", ""), told.get("driver", "")
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        raise fail("this is no drive to begin") from error
    if not all(isinstance(each, str) and len(each) <= _MOST_TEXT for each in found):
        raise fail("this is no drive to begin")
    return found


def _ended(text: str) -> Mapping[str, object]:
    return {"type": "ended", "why": "limit", "text": text, "drive": None, "verdicts": []}
