"""What a car in a shared world is told of the others: cars, and the road users of the traffic."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
_FIRST_USER = 1_000_000
"""Numbers of the traffic's road users begin here: cars have smaller ones."""
_KEPT = 0.7
"""Factor of the distance of one that is seen already."""
_BEHIND = 2.0
"""Factor of the distance of those behind."""
_SPACING, _MOTORCYCLE = 1.0, 3.0


@dataclass(frozen=True, slots=True)
class Car:
    """A car as others see it; *place* is the middle of it ahead of its centre of gravity, all in m."""

    length: float = 4.5
    width: float = 1.8
    height: float = 1.5
    place: float = 0.05


@dataclass(frozen=True, slots=True)
class State:
    """How a car moves: m, rad, m/s, m/s2; *station* and *offset* are its place in its lane, NaN if nothing tells."""

    x: float
    y: float
    heading: float
    speed: float
    lateral_speed: float = 0.0
    acceleration: float = 0.0
    station: float = math.nan
    offset: float = 0.0

    def stopped(self) -> State:
        """The same, at rest."""
        return replace(self, speed=0.0, lateral_speed=0.0, acceleration=0.0)


def mover_of(number: int, car: Car, state: State, ahead: float) -> dict[str, float]:
    """*car* as a mover in the plane, *ahead* s after it was in *state*."""
    c, s = math.cos(state.heading), math.sin(state.heading)
    return {
        "id": float(number),
        "class": 1.0,
        "length": car.length,
        "width": car.width,
        "height": car.height,
        "path": -1.0,
        "station": state.x + car.place * c + (state.speed * c - state.lateral_speed * s) * ahead,
        "offset": state.y + car.place * s + (state.speed * s + state.lateral_speed * c) * ahead,
        "turn": state.heading,
        "speed": state.speed,
        "lateral_speed": state.lateral_speed,
        "acceleration": state.acceleration,
    }


def host_of(car: Car, state: State, ahead: float) -> dict[str, float]:
    """*car* as the traffic sees it, *ahead* s after it was in *state*; length 0 if nothing tells its station."""
    if math.isnan(state.station):
        return {}
    station = state.station + car.place + state.speed * ahead
    sizes = {"length": car.length, "width": car.width}
    return {**sizes, "station": station, "offset": state.offset, "speed": state.speed}


@dataclass(frozen=True, eq=False)
class Ways:
    """Where road users are in the plane that are placed along paths: *lines* are points of the middles of each path's
    lanes, as stations (n), the number of the first lane, x and y (lanes, n), all in m."""

    lines: tuple[tuple[Floats, int, Floats, Floats], ...]

    @classmethod
    def along(cls, paths: Sequence[Any]) -> Ways:
        """Of the `RoadPath` *paths*."""
        from dse.world import lane_middle, place

        lines = []
        for path in paths:
            s = np.linspace(0.0, path.length, int(path.length / _SPACING) + 2)
            numbers = sorted(lane.number for lane in path.lanes)
            points = [place(path, s, lane_middle(path, s, number)) for number in numbers]
            x, y = np.array([each.x for each in points]), np.array([each.y for each in points])
            own = numbers.index(0)
            steps = np.hypot(np.diff(x[own]), np.diff(y[own]))
            lines.append((np.concatenate([[0.0], np.cumsum(steps)]), numbers[0], x, y))
        return cls(tuple(lines))

    def plane(self, path: Floats, lane: Floats, station: Floats, offset: Floats) -> tuple[Floats, Floats]:
        """x and y; those that are on no path stay as they are."""
        x, y = station.copy(), offset.copy()
        for number, (along, first, xs, ys) in enumerate(self.lines):
            on = path == number
            if np.any(on):
                s, lateral, row = station[on] % along[-1], offset[on], np.clip(lane[on] - first, 0, len(xs) - 1)
                at = np.clip(np.searchsorted(along, s) - 1, 0, len(along) - 2)
                right = row.astype(int)
                left, share = np.minimum(right + 1, len(xs) - 1), row - right
                (x0, x1), (y0, y1) = (
                    [each[right, n] + share * (each[left, n] - each[right, n]) for n in (at, at + 1)]
                    for each in (xs, ys)
                )
                part = (s - along[at]) / np.maximum(along[at + 1] - along[at], 1e-9)
                length = np.maximum(np.hypot(x1 - x0, y1 - y0), 1e-9)
                x[on] = x0 + part * (x1 - x0) - lateral * (y1 - y0) / length
                y[on] = y0 + part * (y1 - y0) + lateral * (x1 - x0) / length
        return x, y


@dataclass(frozen=True, eq=False)
class Users:
    """The road users of the traffic in a step: *columns* by field of a mover, without empty places; *x*, *y* in m."""

    columns: Mapping[str, Floats]
    x: Floats
    y: Floats

    @cached_property
    def numbers(self) -> list[int]:
        """Their numbers among all that a car can see."""
        return [_FIRST_USER + int(each) for each in self.columns["id"]]

    @cached_property
    def _rows(self) -> dict[int, tuple[float, ...]]:
        rows = zip(*(values.tolist() for values in self.columns.values()), strict=True)
        return dict(zip(self.numbers, rows, strict=True))

    def mover(self, number: int, ahead: float) -> dict[str, float]:
        """The one with that *number*, *ahead* s later; nothing if it is not there."""
        row = self._rows.get(number)
        if row is None:
            return {}
        mover = dict(zip(self.columns, row, strict=True))
        mover["id"] = float(number)
        mover["station"] += mover["speed"] * math.cos(mover["turn"]) * ahead
        mover["offset"] += mover["speed"] * math.sin(mover["turn"]) * ahead
        return mover

    def near(self, station: float, reach: float) -> set[int]:
        """The vehicles on the path of the cars within *reach* m of *station*."""
        columns = self.columns
        is_near = (columns["path"] == 0) & (columns["class"] <= _MOTORCYCLE)
        is_near &= abs(columns["station"] - station) < reach
        return {self.numbers[row] for row in np.flatnonzero(is_near)}


def nearest(here: State, numbers: Sequence[int], x: Floats, y: Floats, shown: Sequence[int], most: int) -> list[int]:
    """The *most* of *numbers* at *x*, *y* that are nearest *here*; those *shown* already are preferred a little."""
    dx, dy = x - here.x, y - here.y
    away = np.hypot(dx, dy)
    away[dx * math.cos(here.heading) + dy * math.sin(here.heading) < 0] *= _BEHIND
    seen = set(shown)
    away[[number in seen for number in numbers]] *= _KEPT
    return [numbers[n] for n in np.argsort(away, kind="stable")[:most]]
