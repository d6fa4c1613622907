"""Lines, arcs and spirals: where they lead."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

from dse.world.quadrature import gauss, weighed


@dataclass(frozen=True, slots=True)
class Pose:
    """A place in the plane and a direction, in m and rad."""

    x: float
    y: float
    heading: float

    def moved(self, ahead: float, left: float = 0.0, turned: float = 0.0) -> Pose:
        """The pose so far ahead and to the left of this one."""
        cosine, sine = math.cos(self.heading), math.sin(self.heading)
        x, y = self.x + ahead * cosine - left * sine, self.y + ahead * sine + left * cosine
        return Pose(x, y, self.heading + turned)

    def seen(self, other: Pose) -> Pose:
        """*other* as seen from here."""
        x, y = other.x - self.x, other.y - self.y
        cosine, sine = math.cos(self.heading), math.sin(self.heading)
        return Pose(x * cosine + y * sine, y * cosine - x * sine, other.heading - self.heading)


@dataclass(frozen=True, slots=True)
class Bend:
    """A *length* in m along which the curvature goes from *first* to *last*, in 1/m, > 0 to the left."""

    length: float
    first: float = 0.0
    last: float = 0.0

    @property
    def turn(self) -> float:
        """By how much the heading changes, in rad."""
        return self.length * (self.first + self.last) / 2


@dataclass(frozen=True, slots=True)
class Piece:
    """A bend that lies in the plane, from *start* on."""

    start: Pose
    bend: Bend


_NOTHING = 1e-10
"""What is shorter, in m, comes of rounding."""


def laid(start: Pose, bends: Iterable[Bend]) -> tuple[tuple[Piece, ...], Pose]:
    """The *bends* one behind the other, without those of no length, and where they end."""
    pieces = []
    for bend in bends:
        if bend.length > _NOTHING:
            pieces.append(Piece(start, bend))
            start = after(start, bend)
    return tuple(pieces), start


def after(start: Pose, bend: Bend) -> Pose:
    """Where *bend* leads, to some 1e-15 of its length.

    Gauss-Legendre over parts that turn by no more than half a radian: the integrals are Fresnel's for a spiral.
    """
    parts = max(1, math.ceil(2 * bend.length * max(abs(bend.first), abs(bend.last))))
    along = (np.arange(parts)[:, None] + gauss()[0]) * (bend.length / parts)
    headings = start.heading + along * (bend.first + (bend.last - bend.first) / (2 * bend.length) * along)
    x, y = (bend.length / parts * float(weighed(ratio(headings)).sum()) for ratio in (np.cos, np.sin))
    return Pose(start.x + x, start.y + y, start.heading + bend.turn)


def turning(start: Pose, end: Pose) -> tuple[Bend, ...]:
    """A line, a spiral, an arc, a spiral and a line that lead from *start* to *end*, to one of whose sides they turn.

    Each spiral turns by a quarter. The lines that *start* and *end* lie on meet ahead of the one and behind the other.
    """
    seen = start.seen(end)
    angle = math.remainder(seen.heading, 2 * math.pi)
    behind = seen.y / math.sin(angle)
    ahead = seen.x - behind * math.cos(angle)
    # Of radius 1, to know how far from where the lines meet it begins.
    unit = (Bend(abs(angle) / 2, 0.0, math.copysign(1, angle)), Bend(abs(angle) / 2, *[math.copysign(1, angle)] * 2))
    shape = (unit[0], unit[1], Bend(unit[0].length, unit[0].last, 0.0))
    _, reached = laid(Pose(0.0, 0.0, 0.0), shape)
    tangent = min(ahead, behind)
    radius = tangent / (reached.x - reached.y / math.tan(angle))
    scaled = (Bend(bend.length * radius, bend.first / radius, bend.last / radius) for bend in shape)
    return (Bend(ahead - tangent), *scaled, Bend(behind - tangent))


def root(of: Callable[[float], float], low: float, high: float) -> float:
    """Where *of*, which rises from below 0 at *low*, is 0, to the last bits. By halving."""
    for _ in range(200):
        middle = (low + high) / 2
        if not low < middle < high:
            break
        low, high = (middle, high) if of(middle) < 0 else (low, middle)
    return (low + high) / 2
