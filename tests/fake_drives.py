"""A server of test drives that simulates a car on three lanes and no more: for the page, it speaks as the real one."""

from __future__ import annotations

import asyncio
import itertools
import json
import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import uvicorn
from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import HTMLResponse, JSONResponse, Response
from starlette.routing import Route, WebSocketRoute
from starlette.websockets import WebSocket, WebSocketDisconnect

from dse.report import HEAD, ICON, bundle, hash_of

EVIL = '<img src="x" onerror="document.title=1">'
RATE, STEP = 30, 0.01
CONTROLS = ["accelerator", "brake", "steering", "hands_on", "cruise", "set_speed", "gap_setting"]
_HOST = ["x", "y", "z", "heading", "roll", "pitch", "steering", "speed"]
_ACTOR = ["id", "class", "length", "width", "height", "x", "y", "z", "heading", "speed"]
_WEATHER = ["fog", "rain", "snow", "darkness"]


@dataclass
class FakeDrives:
    """*others* vehicles in a *weather*. What pages said is in *heard*; at *dies_at* s a drive breaks off by itself."""

    others: int = 3
    weather: dict[str, float] = field(default_factory=dict)
    dies_at: float = np.inf
    refuses: str = ""
    heard: list[dict[str, Any]] = field(default_factory=list)
    orders: list[dict[str, Any]] = field(default_factory=list)
    port: int = 0

    @property
    def address(self) -> str:
        return f"http://127.0.0.1:{self.port}/drive"

    def application(self) -> Starlette:
        routes = [
            Route("/drive", self._page),
            Route("/drive/offer", self._offer),
            Route("/drive/boards", self._boards),
            Route("/drive/start", self._start, methods=["POST"]),
            Route("/drive/results/{drive}", lambda _: HTMLResponse("<title>A report</title>")),
            WebSocketRoute("/drive/live", self._live),
        ]
        return Starlette(routes=routes)

    def _page(self, _: Request) -> Response:
        script, style = bundle("drive.js"), bundle("drive.css")
        policy = (
            f"default-src 'none'; script-src '{hash_of(script)}'; style-src '{hash_of(style)}'; "
            "img-src data: blob:; connect-src 'self'; base-uri 'none'; form-action 'none'"
        )
        benches = [{"name": "drive_following", "title": "Behind somebody who brakes"}, {"name": "town", "title": EVIL}]
        known = json.dumps({"benches": benches}).replace("<", "\\u003c")
        head = HEAD.format(policy=policy, title="Test drive", icon=ICON, style=style)
        document = f'<script type="application/json" id="document">{known}</script>'
        return HTMLResponse(
            f'{head}</head><body><div id="drive"></div>{document}<script>{script}</script></body></html>'
        )

    def _offer(self, request: Request) -> Response:
        text = request.query_params["chosen"]
        chosen = dict(pair.split(":") for pair in text.split(",") if pair)
        return JSONResponse(offer(chosen))

    def _boards(self, _: Request) -> Response:
        verdicts = [{"requirement": "R1", "verdict": "pass"}, {"requirement": "R2", "verdict": "fail"}]
        score = {
            "driver": EVIL,
            "drive": "17",
            "verdicts": verdicts,
            "against": "#run=1&pins=0",
            "met": 3,
            "of": 3,
            "seconds": 60.0,
            "overruns": 2,
            "note": "",
        }
        first = {**score, "place": 1, "worst": {"share": 0.31, "requirement": "R1"}}
        last = {
            **score,
            "place": None,
            "driver": "Ann",
            "drive": "18",
            "worst": {"share": None, "requirement": None},
            "note": "ended at 8 s",
        }
        board = {"bench": "drive_following", "title": "Behind somebody who brakes", "scoring": "First who met most."}
        return JSONResponse({"boards": [{**board, "scores": [first, last]}]})

    async def _start(self, request: Request) -> Response:
        if self.refuses:
            problem = {"what": self.refuses, "hint": "wait"}
            return JSONResponse({"problems": [problem]}, 409)
        self.orders.append(json.loads(await request.body()))
        return JSONResponse({"drive": "token"})

    async def _live(self, line: WebSocket) -> None:
        await line.accept()
        await line.send_json(self.scene())
        state = dict.fromkeys(CONTROLS, 0.0) | {"echo": 0, "ends": False}
        hearing = asyncio.create_task(self._hear(line, state))
        with suppress(WebSocketDisconnect, RuntimeError):
            await self._run(line, state)
        hearing.cancel()

    async def _hear(self, line: WebSocket, state: dict[str, Any]) -> None:
        with suppress(WebSocketDisconnect, RuntimeError):
            while True:
                told = await line.receive_json()
                self.heard.append(told)
                if told["type"] == "finish":
                    state["ends"] = True
                    continue
                state["echo"] = told["n"]
                if told["type"] == "control":
                    state.update(told["values"])

    async def _run(self, line: WebSocket, state: dict[str, Any]) -> None:
        loop = asyncio.get_running_loop()
        began, time, x, y, speed, mode = loop.time(), 0.0, 0.0, 0.0, 20.0, 0
        while not state["ends"]:
            await asyncio.sleep(max(0.0, began + time + 1 / RATE - loop.time()))
            time += 1 / RATE
            mode = 3 if state["brake"] > 0 and mode in (2, 3) else 2 if state["cruise"] else 0
            held = 0.5 * (state["set_speed"] - speed) if mode == 2 else -0.1
            speed = max(0.0, speed + (4 * state["accelerator"] - 8 * state["brake"] + held) / RATE)
            x += speed / RATE
            y += speed * state["steering"] / RATE
            if time > self.dies_at:
                text = "chassis: its process ended by SIGSEGV at 2 s"
                await line.send_json({"type": "ended", "why": "crashed", "text": text, "drive": None, "verdicts": []})
                return
            columns = self._columns(time, x, y, speed, state["steering"], mode, state["set_speed"])
            numbers = [time, 4e-4, 2, state["echo"], *columns]
            await line.send_bytes(np.array(numbers, "<f8").tobytes())
        verdicts = [{"name": "R1", "title": "Never closer than 2 m", "verdict": "pass"}]
        verdicts += [
            {"name": "R2", "title": EVIL, "verdict": "fail"},
            {"name": "R3", "title": "Stops at red", "verdict": "not exercised"},
        ]
        ended = {"type": "ended", "why": "finished", "text": f"driven for {time:.4g} s of 60 s", "drive": "17"}
        await line.send_json({**ended, "verdicts": verdicts})
        await line.close()

    def _columns(
        self, time: float, x: float, y: float, speed: float, steering: float, mode: int, wanted: float
    ) -> list[float]:
        values = [x, y, 0.0, 0.0, 0.0, 0.0, steering, speed, *(self.weather.get(name, 0.0) for name in _WEATHER)]
        for number in range(self.others):
            place = 40.0 + 14 * number + 18 * time
            kind, length, width, height = (2, 12, 2.5, 3.5) if number % 5 == 1 else (1, 4.5, 1.8, 1.5)
            values += [number + 1, kind, length, width, height, place, 3.5 * (number % 3 - 1), 0, 0, 18]
        gap = 40.0 + 18 * time - x
        return [*values, 1.0, max(gap, 0.0), 0.0, 3.6 * speed, 3.6 * wanted, gap, mode]

    def scene(self) -> dict[str, Any]:
        """The first message of a drive."""
        columns = [f"host.{name}" for name in _HOST] + [f"weather.{name}" for name in _WEATHER]
        columns += [f"other.{number}.{name}" for number in range(self.others) for name in _ACTOR]
        columns += ["sensor.0.0.valid", "sensor.0.0.range", "sensor.0.0.azimuth"]
        columns += ["instrument.0", "target.0", "instrument.1", "instrument.2"]
        way = np.linspace(-100, 3000, 200)
        lane = [np.column_stack([way, 0 * way + at, 0 * way]).reshape(-1).tolist() for at in (5.25, 1.75, -1.75, -5.25)]
        strips = [
            {"left": left, "right": right, "isDriven": True, "isInside": False, "kind": "driving"}
            for left, right in itertools.pairwise(lane)
        ]
        instrument = {"unit": "", "items": [], "hasTarget": False}
        document = {
            "title": "Behind somebody who brakes",
            "subtitle": "",
            "steps": 2,
            "step": 1.0,
            "classes": ["none", "car", "truck", "motorcycle", "bicycle", "pedestrian", "obstacle"],
            "strips": strips,
            "areas": [],
            "lights": [],
            "colours": [],
            "kind": "motorway",
            "markings": [],
            "signs": [],
            "objects": [],
            "host": {"length": 4.5, "width": 1.8, "front": 2.3, "wheel": 0.31},
            "others": self.others,
            "sensors": [
                {
                    "name": "radar",
                    "title": "Long-range radar",
                    "mount": 2.3,
                    "left": 0.0,
                    "turn": 0.0,
                    "reach": 150.0,
                    "angle": 0.4,
                    "returns": 1,
                }
            ],
            "instruments": [
                {**instrument, "title": "Speed", "unit": "km/h", "hasTarget": True},
                {**instrument, "title": "Gap", "unit": "m"},
                {
                    **instrument,
                    "title": "controls mode",
                    "items": ["manual", "standby", "cruise", "override", "emergency"],
                },
            ],
            "columns": {},
        }
        start = dict.fromkeys(CONTROLS, 0.0) | {"set_speed": 110 / 3.6, "gap_setting": 2}
        tunables = [
            {"name": "controller.kp", "title": "Speed gain", "unit": "1/s", "min": 0, "max": 3, "value": 1.2},
            {"name": "controller.gap", "title": EVIL, "unit": "1", "min": 0, "max": 1, "value": 0.5},
        ]
        return {
            "type": "scene",
            "document": document,
            "columns": columns,
            "step": STEP,
            "rate": RATE,
            "tunables": tunables,
            "controls": CONTROLS,
            "start": start,
        }


def offer(chosen: dict[str, str]) -> dict[str, Any]:
    """Two drives, three sensors, brakes that follow from the drive; the lidar needs the strong drive."""
    weak, lidar = chosen.get("drive") == "small", chosen.get("sensor") == "lidar"
    alternative = {"is_possible": True, "because": [], "rules_out": [], "change": [], "adds": []}
    drives = [
        {
            **alternative,
            "name": "small",
            "title": "One motor",
            "rules_out": [] if lidar else [{"path": "sensor", "name": "lidar"}],
        },
        {**alternative, "name": "strong", "title": "Two motors"},
    ]
    if lidar:
        drives[0] = {
            **alternative,
            "name": "small",
            "title": "One motor",
            "is_possible": False,
            "because": ["a lidar needs the power of two motors"],
            "change": ["sensor"],
        }
    sensors = [
        {
            **alternative,
            "name": "radar",
            "title": "Long-range radar, 77 GHz",
            "adds": [{"name": "cost", "unit": "EUR", "value": 250}, {"name": "mass", "unit": "kg", "value": 2}],
        },
        {**alternative, "name": "camera", "title": EVIL},
        {
            **alternative,
            "name": "lidar",
            "title": "Lidar",
            "is_possible": not weak,
            "because": ["a lidar needs the power of two motors"] * weak,
            "change": ["drive"] * weak,
            "adds": [{"name": "cost", "unit": "EUR", "value": 900}, {"name": "mass", "unit": "kg", "value": 1.5}],
        },
    ]
    brakes = [{**alternative, "name": "discs", "title": "Four discs"}]
    implied = {"drive": "strong" if lidar else None, "sensor": None, "brakes": "discs"}
    points = [
        {
            "path": path,
            "title": title,
            "chosen": chosen.get(path),
            "implied": None if path in chosen else implied[path],
            "is_certain": True,
            "alternatives": found,
        }
        for path, title, found in (
            ("drive", "Drive", drives),
            ("sensor", "Sensor", sensors),
            ("brakes", "Brakes", brakes),
        )
    ]
    has = {point["path"]: point["chosen"] or point["implied"] for point in points}
    left = (1 if has["drive"] else 2) * (1 if has["sensor"] else 2 if weak else 3) - (
        not has["drive"] and not has["sensor"]
    )
    return {
        "design": "test_drive",
        "title": "A car to try",
        "chosen": chosen,
        "total": "49400",
        "left": str(left),
        "configuration": "c1" if left == 1 else None,
        "choices": {},
        "conflict": [],
        "points": points,
        "totals": [
            {
                "name": "cost",
                "title": "Price",
                "unit": "EUR",
                "low": 21400.0,
                "high": 21400.0 if left == 1 else 38250.0,
            },
            {"name": "mass", "title": "Mass", "unit": "kg", "low": 1480.0, "high": 1480.0 if left == 1 else 1795.5},
        ],
    }


@contextmanager
def served(drives: FakeDrives) -> Iterator[FakeDrives]:
    """*drives* on a free port of this machine."""
    with socket.create_server(("127.0.0.1", 0)) as line:
        drives.port = line.getsockname()[1]
        server = uvicorn.Server(uvicorn.Config(drives.application(), log_level="error", timeout_graceful_shutdown=1))
        thread = threading.Thread(target=server.run, kwargs={"sockets": [line]}, daemon=True)
        thread.start()
        try:
            yield drives
        finally:
            server.should_exit = True
            thread.join()
