"""Paths evaluated in Python: for drawing, for tests, and as what the C core is compared with."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dse.world.opendrive.curves import Reals
from dse.world.pieces import value
from dse.world.tables import RoadPath

_SPACING = 5.0
_TRIED = 32
_STEPS = 50


@dataclass(frozen=True, eq=False, slots=True)
class PathPoint:
    """Points beside a path, in the world: m and rad. *curvature* is that of the reference line there, in 1/m.

    *grade* and *bank* are dz/ds along the reference line and the angle across it.
    """

    x: Reals
    y: Reals
    z: Reals
    heading: Reals
    curvature: Reals
    grade: Reals
    bank: Reals


def wrapped(path: RoadPath, stations: Reals) -> Reals:
    """Stations on the path: those of a closed one go round, others stay as they are."""
    return np.mod(stations, path.length) if path.closed else stations


def place(path: RoadPath, stations: Reals, t: Reals | float = 0.0) -> PathPoint:
    """Where points are that lie *t* m to the left of the reference line at *stations*."""
    s = wrapped(path, np.asarray(stations, dtype=np.float64))
    x, dx, ddx = (value(path.x, s, order) for order in range(3))
    y, dy, ddy = (value(path.y, s, order) for order in range(3))
    pace = np.hypot(dx, dy)
    bank = value(path.bank, s)
    return PathPoint(
        x - t * dy / pace,
        y + t * dx / pace,
        value(path.height, s) + t * np.tan(bank),
        np.arctan2(dy, dx),
        (dx * ddy - dy * ddx) / pace**3,
        value(path.height, s, 1) / pace,
        bank,
    )


def lane_middle(path: RoadPath, stations: Reals, number: int = 0) -> Reals:
    """The t of the middle of a lane of the path at *stations*."""
    s = wrapped(path, np.asarray(stations, dtype=np.float64))
    lane = next(lane for lane in path.lanes if lane.number == number)
    return (value(lane.left, s) + value(lane.right, s)) / 2


def project(path: RoadPath, x: float, y: float) -> tuple[float, float]:
    """Station and t of the point of the reference line that is nearest to *x*, *y*; ends are not gone beyond."""
    starts, ends = path.x.starts, np.append(path.x.starts[1:], path.length)
    counts = np.ceil((ends - starts) / _SPACING).astype(int) + 2
    pieces = np.repeat(np.arange(len(ends)), counts)
    along = np.concatenate(
        [np.linspace(0.0, end - start, n) for start, end, n in zip(starts, ends, counts, strict=True)]
    )
    powers = along[:, None] ** np.arange(path.x.coefficients.shape[1])
    off = np.hypot((path.x.coefficients[pieces] * powers).sum(1) - x, (path.y.coefficients[pieces] * powers).sum(1) - y)
    tried = np.argsort(off, kind="stable")[:_TRIED]
    _, station, t = min(_foot(path, int(pieces[i]), float(along[i]), x, y) for i in tried)
    return station, t


def _foot(path: RoadPath, piece: int, ds: float, x: float, y: float) -> tuple[float, float, float]:
    """Newton's method on a piece, from *ds* on: distance, station and t where it ends."""
    start = float(path.x.starts[piece])
    end = float(path.x.starts[piece + 1]) if piece + 1 < len(path.x.starts) else path.length
    line = np.polynomial.Polynomial(path.x.coefficients[piece] + 1j * path.y.coefficients[piece])
    slope, bend = line.deriv(), line.deriv(2)
    for _ in range(_STEPS):
        to, v = complex(x, y) - line(ds), slope(ds)
        change = (to * v.conjugate()).real / max(abs(v) ** 2 - (to * bend(ds).conjugate()).real, 1e-3)
        before, ds = ds, min(max(ds + change, 0.0), end - start)
        if abs(ds - before) <= 1e-13 * max(1.0, end):
            break
    to, v = complex(x, y) - line(ds), slope(ds)
    return round(abs(to), 9), start + ds, (to * v.conjugate()).imag / abs(v)
