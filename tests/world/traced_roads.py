"""Roads for tests, put together from lines, arcs and clothoids whose closed forms are here."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import fresnel

from dse.world import LaneBand, Patch, Piecewise, RoadPath

Array = NDArray[np.float64]
Segment = tuple[float, float, float]
"""Length, and the curvatures at its start and end."""


def constant(value: float) -> Piecewise:
    return Piecewise(np.zeros(1), np.array([[value]]))


ZERO = constant(0.0)


def lane(number: int, right: float, left: float, friction: float = 1.0) -> LaneBand:
    return LaneBand(number, constant(left), constant(right), constant(friction))


TWO_LANES = (lane(0, -3.5, 0.0), lane(1, 0.0, 3.5))
ONE_LANE = (lane(0, -1.75, 1.75),)


@dataclass(frozen=True)
class Frame:
    """A place on a reference line."""

    x: float
    y: float
    heading: float
    curvature: float

    def beside(self, t: float) -> tuple[float, float]:
        return self.x - t * math.sin(self.heading), self.y + t * math.cos(self.heading)


@dataclass(frozen=True)
class Traced:
    """A reference line from *start* on along *segments*."""

    segments: Sequence[Segment]
    start: Frame = Frame(0.0, 0.0, 0.0, 0.0)

    @property
    def length(self) -> float:
        return sum(length for length, _, _ in self.segments)

    def at(self, s: float) -> Frame:
        """Lines, arcs and clothoids by their closed forms, the latter with Fresnel's integrals."""
        here = self.start
        for number, (length, first, last) in enumerate(self.segments):
            u = s if number == len(self.segments) - 1 else min(s, length)
            here = _along(here, u, first, (last - first) / length)
            s -= u
            if s <= 0:
                break
        return here

    def path(
        self,
        *,
        name: str = "path",
        closed: bool = False,
        height: Piecewise = ZERO,
        bank: Piecewise = ZERO,
        speed_limit: Piecewise = ZERO,
        lanes: tuple[LaneBand, ...] = ONE_LANE,
        patches: tuple[Patch, ...] = (),
    ) -> RoadPath:
        """The path in pieces of at most 0.03 rad."""
        starts: list[float] = []
        begin = 0.0
        for length, first, last in self.segments:
            count = 1 + int(length * max(abs(first), abs(last)) / 0.03)
            starts += [begin + length * i / count for i in range(count)]
            begin += length
        ends = [*starts[1:], begin]
        # At a border of two segments the curvature may jump: each piece has the one of its own side.
        pairs = [(self._side(a, 1e-9), self._side(b, -1e-9), b - a) for a, b in zip(starts, ends, strict=True)]
        x = [_hermite(_of_x(a), _of_x(b), h) for a, b, h in pairs]
        y = [_hermite(_of_y(a), _of_y(b), h) for a, b, h in pairs]
        lines = (Piecewise(np.array(starts), np.array(rows)) for rows in (x, y))
        return RoadPath(name, self.length, closed, *lines, height, bank, speed_limit, lanes, patches)

    def _side(self, s: float, by: float) -> Frame:
        place, aside = self.at(s), self.at(s + by)
        return Frame(place.x, place.y, place.heading, aside.curvature)


def _along(a: Frame, u: float, curvature: float, rate: float) -> Frame:
    heading = a.heading + curvature * u + rate * u * u / 2
    if rate == 0:
        half = curvature * u / 2
        chord = u * float(np.sinc(half / math.pi))
        middle = a.heading + half
        return Frame(a.x + chord * math.cos(middle), a.y + chord * math.sin(middle), heading, curvature)
    # From the clothoid's own origin, where its curvature is zero.
    scale = math.sqrt(math.pi / abs(rate))
    origin = curvature / rate
    s0, c0 = fresnel(origin / scale)
    s1, c1 = fresnel((origin + u) / scale)
    along, aside = scale * (c1 - c0), math.copysign(scale, rate) * (s1 - s0)
    base = a.heading - rate * origin**2 / 2
    return Frame(
        a.x + along * math.cos(base) - aside * math.sin(base),
        a.y + along * math.sin(base) + aside * math.cos(base),
        heading,
        curvature + rate * u,
    )


def _of_x(a: Frame) -> tuple[float, float, float]:
    return a.x, math.cos(a.heading), -a.curvature * math.sin(a.heading)


def _of_y(a: Frame) -> tuple[float, float, float]:
    return a.y, math.sin(a.heading), a.curvature * math.cos(a.heading)


def _hermite(a: tuple[float, float, float], b: tuple[float, float, float], h: float) -> list[float]:
    """The quintic over *h* with these values and first two derivatives at its ends."""
    rows = [[math.factorial(j) // math.factorial(j - k) * h ** (j - k) if j >= k else 0 for j in range(3, 6)]
            for k in range(3)]  # fmt: skip
    taylor = [a[0] + a[1] * h + a[2] * h * h / 2, a[1] + a[2] * h, a[2]]
    scaled = np.array(rows, float) * np.array([[1.0], [h], [h * h]]) / np.array([h**3, h**4, h**5])
    right = np.array([b[k] - taylor[k] for k in range(3)]) * np.array([1.0, h, h * h])
    rest = np.linalg.solve(scaled, right) / np.array([h**3, h**4, h**5])
    return [a[0], a[1], a[2] / 2, *rest.tolist()]


def cubics(rows: Sequence[tuple[float, Sequence[float]]]) -> Piecewise:
    """Polynomials from the given stations on."""
    most = max(len(row) for _, row in rows)
    return Piecewise(
        np.array([s for s, _ in rows]), np.array([[*row, *[0.0] * (most - len(row))] for _, row in rows], float)
    )
