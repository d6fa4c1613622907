"""IDM and MOBIL a second time, in numpy: whole states are compared with a vehicle here and there."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

HOST = -1


@dataclass
class Traffic:
    """Rows are the vehicles and, as the last one, the host, which is a vehicle whose state is given."""

    there: Any  # bool[n + 1]
    x: Any  # m, centres
    v: Any  # m/s
    lane: Any  # int[n + 1]; of the host unused
    length: Any  # m
    driver: Any  # [n, 5]: desired speed, time gap, standstill gap, acceleration, comfortable deceleration
    plus: bool = False
    lap: float = 0.0
    lanes: tuple[int, int] = (0, 0)
    duration: float = 4.0
    politeness: float = 0.2
    threshold: float = 0.1
    keep_right: float = 0.0
    safe: float = 4.0
    brakes: float = 9.0
    host_lanes: tuple[int, ...] = (0,)
    old: Any = None  # int[n + 1]: the lane a vehicle comes from
    u: Any = field(init=False)

    def __post_init__(self) -> None:
        self.u = np.ones(len(self.x))

    def members(self, lane: int) -> Any:
        leaving = (self.u < 0.6) & (self.old == lane)
        found = self.there & ((self.lane == lane) | leaving)
        found[HOST] = self.there[HOST] and lane in self.host_lanes
        return found

    def next(self, i: int, lane: int, sense: int) -> tuple[int, float]:
        way = sense * (self.x - self.x[i])
        if self.lap:
            way = way % self.lap
        others = self.members(lane) & (way >= 0)
        others[i] = False
        if not others.any():
            return -1, np.inf
        j = int(np.argmin(np.where(others, way, np.inf)))
        return j, float(way[j] - (self.length[i] + self.length[j]) / 2)

    def acceleration(self, i: int, lane: int, judge: int) -> float:
        v0, headway, s0, a, b = self.driver[judge]
        j, gap = self.next(i, lane, 1)
        if gap <= 0:
            return -self.brakes
        v = self.v[i]
        closing = v - self.v[j] if j >= 0 else 0.0
        wanted = s0 + max(0.0, v * headway + v * closing / (2 * np.sqrt(a * b)))
        free, near = 1 - (v / v0) ** 4, (wanted / gap) ** 2
        return float(max(a * min(free, 1 - near) if self.plus else a * (free - near), -self.brakes))

    def after(self, i: int, lane: int) -> float:
        """What MOBIL says of the state in which *i* were on *lane*."""
        here = int(self.lane[i])
        new, new_gap = self.next(i, lane, -1)
        old, _ = self.next(i, here, -1)
        _, ahead = self.next(i, lane, 1)
        if new_gap <= 0 or ahead <= 0:
            return -np.inf
        other = replace(self, lane=self.lane.copy(), old=self.old.copy())
        other.u = self.u
        other.lane[i] = other.old[i] = lane
        own = other.acceleration(i, lane, i)
        gains = 0.0
        for follower, where in ((new, lane), (old, here)):
            if follower >= 0:
                judge = i if follower == len(self.x) - 1 else follower
                after = other.acceleration(follower, where, judge)
                gains += after - self.acceleration(follower, where, judge)
                if where == lane and after < -self.safe:
                    return -np.inf
        if own < -self.safe:
            return -np.inf
        bias = self.keep_right if lane > here else -self.keep_right
        return own - self.acceleration(i, here, i) + self.politeness * gains - self.threshold - bias

    def step(self, h: float) -> None:
        for i in range(len(self.x) - 1):
            if not self.there[i] or self.u[i] < 1 or self.v[i] == 0:
                continue
            options = [int(self.lane[i]) + 1, int(self.lane[i]) - 1]
            chances = [(self.after(i, lane), lane) for lane in options if self.lanes[0] <= lane <= self.lanes[1]]
            best = max(chances, default=(0.0, 0))
            if best[0] > 0:
                self.old[i], self.lane[i], self.u[i] = self.lane[i], best[1], 0.0
        a = np.zeros(len(self.x))
        for i in range(len(self.x) - 1):
            if self.there[i]:
                a[i] = self.acceleration(i, int(self.lane[i]), i)
                if self.u[i] < 0.6:
                    a[i] = min(a[i], self.acceleration(i, int(self.old[i]), i))
        with np.errstate(divide="ignore", invalid="ignore"):
            stops = self.v + a * h < 0
            way = np.where(stops, -(self.v**2) / (2 * a), self.v * h + a * h * h / 2)
        least = 1.875 * 3.5 / self.duration / 0.3
        self.x, self.v = self.x + way, np.maximum(self.v + a * h, 0)
        self.u = np.minimum(1, self.u + np.minimum(h, way / least) / self.duration)

    def offsets(self) -> Any:
        share = self.u**3 * (10 - 15 * self.u + 6 * self.u**2)
        return 3.5 * (self.old + (self.lane - self.old) * share)
