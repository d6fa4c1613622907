"""One simulation of SUMO, in a process that has no other: traffic around a host, as movers along paths."""

from __future__ import annotations

import json
import math
import os
from bisect import bisect_right
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from dse.world.sumo.demand import HOST, demand_text

SLOTS = 8
_CLASSES = {"truck": 2, "trailer": 2, "bus": 2, "coach": 2, "delivery": 2, "motorcycle": 3, "moped": 3, "bicycle": 4}
_CAR = 1
_CHOICE_EVERY = 0.1  # s; who matters most does not change from step to step
_BEHIND = 2.0  # times as far as one who is ahead
_ELSEWHERE = 20.0  # m farther is who drives along another path
_OFF_ROAD = 2.5  # m from the middle of every lane of SUMO: the host drives where SUMO has no road
_MISFIT = 1.0  # m between where the host is along the path and where it says it is
_STRAY = 20.0  # m aside
_STEEPEST = 0.5  # rad against the lane
_NEARLY = 1e-6
_INSIDE = 0.01  # m
_LEAST_SLOPE = 0.3  # below, a lane has a length for SUMO alone: between two roads that touch

Values = Mapping[str, float]


class SumoError(Exception):
    """The simulation cannot go on; says why."""


@dataclass(frozen=True)
class Edge:
    """An edge of SUMO: the *stations* at its *positions*."""

    positions: list[float]
    stations: list[float]

    def at(self, position: float) -> tuple[float, float]:
        """The station at a *position*, and stations per m; the first and last pieces go on outside."""
        return _along(self.positions, self.stations, position)


@dataclass(frozen=True)
class Lane:
    """A lane of an *edge* of SUMO along a *path*: at *stations*, the *offsets* and places of its middle."""

    name: str
    edge: Edge
    path: int
    number: int
    stations: list[float]
    offsets: list[float]
    points: list[tuple[float, float]]

    def offset_at(self, station: float) -> float:
        """Of its middle from that of our lane at a *station*, to the left."""
        inside = min(max(station, self.stations[0]), self.stations[-1])
        return _along(self.stations, self.offsets, inside)[0]

    def place(self, station: float, x: float, y: float) -> tuple[float, float]:
        """How far to the left of its middle x, y lies, and how far from *station*."""
        i = _piece(self.stations, station)
        (x0, y0), (x1, y1) = self.points[i], self.points[i + 1]
        along = math.hypot(x1 - x0, y1 - y0) or 1.0
        ahead = ((x - x0) * (x1 - x0) + (y - y0) * (y1 - y0)) / along
        aside = ((y - y0) * (x1 - x0) - (x - x0) * (y1 - y0)) / along
        return aside, self.stations[i] + ahead / along * (self.stations[i + 1] - self.stations[i]) - station


def _piece(starts: list[float], value: float) -> int:
    return max(0, min(bisect_right(starts, value) - 1, len(starts) - 2))


def _along(starts: list[float], values: list[float], value: float) -> tuple[float, float]:
    i = _piece(starts, value)
    span = starts[i + 1] - starts[i]
    slope = (values[i + 1] - values[i]) / span if span > 0 else 0.0
    return values[i] + (value - starts[i]) * slope, slope


class Simulation:
    """SUMO with the network in *folder* and what drives there by *parameters*, begun and warmed up.

    Raises SumoError.
    """

    def __init__(self, folder: Path, parameters: Values) -> None:
        os.environ["LIBSUMO_AS_TRACI"] = "quiet"
        import libsumo

        self._sumo: Any = libsumo
        self._parameters = parameters
        told = json.loads((folder / "lanes.json").read_text("utf-8"))
        if libsumo.__version__ != told["version"]:
            what = f"it was built for SUMO {told['version']}, but this is {libsumo.__version__}"
            raise SumoError(f"{what}: run the command again where it was built, or install that version")
        self._step = float(told["step"])
        self._laps: list[float] = told["laps"]
        edges = {name: Edge(*columns) for name, columns in told["edges"].items()}
        self._lanes = {name: _lane(name, edges[entry["edge"]], entry) for name, entry in told["lanes"].items()}
        self._own = [lane for lane in self._lanes.values() if lane.path == 0]
        self._kinds: dict[str, tuple[int, float, float, float]] = {}
        self._numbers: dict[str, int] = {}
        self._slots: list[str] = [""] * SLOTS
        self._steps = 0
        self._is_in = False
        self._begin(folder, told)

    def _begin(self, folder: Path, told: Mapping[str, Any]) -> None:
        demand = os.memfd_create("demand") if hasattr(os, "memfd_create") else -1
        if demand < 0:
            raise SumoError("traffic by SUMO needs Linux")
        os.write(demand, demand_text(self._parameters, told["routes"]).encode())
        routes = [f"/proc/self/fd/{demand}"]
        if (folder / "demand.rou.xml").is_file():
            routes.append(str(folder / "demand.rou.xml"))
        self._sumo.start([
            "sumo", "--net-file", str(folder / "road.net.xml"), "--route-files", ",".join(routes),
            "--step-length", repr(self._step), "--seed", str(int(self._parameters["seed"])),
            "--lanechange.duration", repr(self._parameters["change_duration"]),
            "--collision.action", "none", "--time-to-teleport", "-1", "--no-step-log", "--no-warnings",
            "--duration-log.disable", "--xml-validation", "never",
        ])  # fmt: skip
        for name, entry in told["lanes"].items():
            self._sumo.lane.setMaxSpeed(name, entry["limit"])
        for _ in range(round(self._parameters["warm_up"] / self._step)):
            self._sumo.simulation.step()

    def look(self, inputs: Values) -> list[float]:
        """The movers as the run begins; who would be too near to the host then drives no more."""
        host = self._host(inputs, must_fit=False)
        if host is not None:
            self._make_room(host, inputs)
        self._choose(inputs, host)
        return self._movers()

    def step(self, inputs: Values, h: float) -> list[float]:
        """The movers *h* s later, with the host as it is now."""
        count = round(h / self._step)
        if count < 1 or abs(count * self._step - h) > _NEARLY * h:
            what = f"a step of {h:g} s is not a multiple of SUMO's, which is {self._step:g} s"
            raise SumoError(f"{what}: give 'step' in the component's source")
        host = self._host(inputs, must_fit=self._steps == 0)
        self._put(host, inputs, h)
        for _ in range(count):
            self._sumo.simulation.step()
        every = max(1, round(_CHOICE_EVERY / h))
        if self._steps % every == 0 or not self._are_all_there():
            self._choose(inputs, host)
        self._steps += 1
        return self._movers()

    def _host(self, inputs: Values, *, must_fit: bool) -> tuple[str, float] | None:
        """The lane and position of the host's front; None where it is on no road of SUMO, or nobody minds it."""
        if not self._parameters["minds_host"]:
            return None
        front, heading = self._parameters["host_front"], inputs["motion.heading"]
        x, y = inputs["motion.x"] + front * math.cos(heading), inputs["motion.y"] + front * math.sin(heading)
        station = inputs["lane.station"] + front
        if self._laps[0]:
            station %= self._laps[0]
        near = []
        for lane in self._own:
            if lane.stations[0] - _MISFIT <= station <= lane.stations[-1] + _MISFIT:
                aside, off = lane.place(station, x, y)
                position = _along(lane.edge.stations, lane.edge.positions, station)[0]
                near.append((abs(aside), lane.name, position, abs(off)))
        if not near and must_fit:
            raise SumoError(f"the host is at the station {inputs['lane.station']:.2f} m, where SUMO's road has no lane")
        if not near:
            return None
        aside, name, position, off = min(near)
        if must_fit and (aside > _STRAY or off > _MISFIT):
            place = f"x = {inputs['motion.x']:.2f} m, y = {inputs['motion.y']:.2f} m"
            what = f"the host is at {place}, but SUMO's road has its station {inputs['lane.station']:.2f} m elsewhere"
            raise SumoError(f"{what}: road and traffic must name the same file and way, and both 'lane' and 'motion'")
        return (name, position) if aside <= _OFF_ROAD and off <= _MISFIT else None

    def _put(self, host: tuple[str, float] | None, inputs: Values, h: float) -> None:
        vehicle = self._sumo.vehicle
        if host is None:
            if self._is_in:
                vehicle.remove(HOST)
            self._is_in = False
            return
        name, position = host
        if not self._is_in:
            vehicle.add(HOST, "path0", typeID=HOST, departLane="0")
            vehicle.setSpeedMode(HOST, 0)
            vehicle.setLaneChangeMode(HOST, 0)
            self._is_in = True
        # It is where it will be after the step, to which SUMO drives it.
        speed = max(inputs["motion.speed"], 0.0)
        position = max(position - speed * h, _INSIDE)
        vehicle.moveTo(HOST, name, min(position, self._sumo.lane.getLength(name) - _INSIDE))
        vehicle.setSpeed(HOST, speed)

    def _make_room(self, host: tuple[str, float], inputs: Values) -> None:
        """Take away who is so near that nobody who drives behind another would be."""
        lane = self._lanes[host[0]]
        front = lane.edge.at(host[1])[0]
        length = self._parameters["host_front"] + self._parameters["host_rear"]
        vehicle = self._sumo.vehicle
        for name in vehicle.getIDList():
            of = self._lanes.get(vehicle.getLaneID(name))
            if of is None or of.path != 0 or of.number != lane.number:
                continue
            ahead = self._ahead(front, of.edge.at(vehicle.getLanePosition(name))[0])
            rear_speed = inputs["motion.speed"] if ahead > 0 else vehicle.getSpeed(name)
            gap = ahead - vehicle.getLength(name) if ahead > 0 else -ahead - length
            if gap < self._parameters["standstill_gap"] + self._parameters["time_gap"] * max(rear_speed, 0.0):
                vehicle.remove(name)

    def _ahead(self, start: float, end: float) -> float:
        lap = self._laps[0]
        return end - start - lap * round((end - start) / lap) if lap else end - start

    def _are_all_there(self) -> bool:
        there = set(self._sumo.vehicle.getIDList())
        return all(not name or name in there for name in self._slots)

    def _choose(self, inputs: Values, host: tuple[str, float] | None) -> None:
        """Who matters most: the nearest along the path; who is behind is twice as far. Who is told of stays put."""
        vehicle = self._sumo.vehicle
        station = self._lanes[host[0]].edge.at(host[1])[0] if host else inputs["lane.station"]
        ranked = []
        for name in vehicle.getIDList():
            lane = self._lanes.get(vehicle.getLaneID(name)) if name != HOST else None
            if lane is None:
                continue
            if lane.path == 0:
                ahead = self._ahead(station, lane.edge.at(vehicle.getLanePosition(name))[0])
                ranked.append((ahead if ahead >= 0 else -_BEHIND * ahead, name))
            else:
                x, y = vehicle.getPosition(name)
                away = math.hypot(x - inputs["motion.x"], y - inputs["motion.y"])
                ranked.append((away + _ELSEWHERE, name))
        chosen = {name for _, name in sorted(ranked)[:SLOTS]}
        self._slots = [name if name in chosen else "" for name in self._slots]
        for name in sorted(chosen.difference(self._slots)):
            self._slots[self._slots.index("")] = name
            self._numbers.setdefault(name, len(self._numbers) + 1)

    def _movers(self) -> list[float]:
        movers: list[float] = []
        for name in self._slots:
            movers += self._mover(name) if name else [0.0] * 14
        return movers

    def _mover(self, name: str) -> Sequence[float]:
        """The values of a mover, in the order of the interface."""
        vehicle = self._sumo.vehicle
        lane = self._lanes.get(vehicle.getLaneID(name))
        if lane is None:
            return [0.0] * 14
        if name not in self._kinds:
            kind = _CLASSES.get(vehicle.getVehicleClass(name), _CAR)
            self._kinds[name] = kind, vehicle.getLength(name), vehicle.getWidth(name), vehicle.getHeight(name)
        kind, length, width, height = self._kinds[name]
        front, slope = lane.edge.at(vehicle.getLanePosition(name))
        if slope < _LEAST_SLOPE:
            slope = 1.0
        station = front - length / 2
        offset = lane.offset_at(front)
        if self._laps[lane.path]:
            station %= self._laps[lane.path]
        speed, aside = vehicle.getSpeed(name), vehicle.getLateralSpeed(name)
        turn = max(-_STEEPEST, min(math.atan2(aside, max(speed, 1.0)), _STEEPEST))
        return (
            self._numbers[name], kind, length, width, height, 0.0, lane.path, lane.number, station,
            offset + vehicle.getLateralLanePosition(name), turn, math.hypot(speed * slope, aside), 0.0,
            vehicle.getAcceleration(name),
        )  # fmt: skip


def _lane(name: str, edge: Edge, entry: Mapping[str, Any]) -> Lane:
    stations, offsets, x, y = (list(column) for column in zip(*entry["knots"], strict=True))
    return Lane(name, edge, entry["path"], entry["lane"], stations, offsets, list(zip(x, y, strict=True)))
