"""Piecewise polynomials: made of cubics, added, turned round, joined; and quintic pieces of curves."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

from dse.errors import fail
from dse.world.opendrive.curves import Curve, Frames, Reals
from dse.world.opendrive.structure import Cubic
from dse.world.tables import Piecewise

CLOSE = 5e-8
"""How near quintic pieces stay to their curve, in m, and to its direction, in rad: half of what tables promise.

So borders of lanes 20 m from the reference line are within 1e-6 m.
"""

_MOST_PIECES = 100_000


def value(piecewise: Piecewise, stations: NDArray[np.float64], order: int = 0) -> Reals:
    """The values, or those of the derivative of *order*, at *stations*; the first and last pieces go on outside."""
    starts = piecewise.starts
    piece = np.clip(np.searchsorted(starts, stations, side="right") - 1, 0, len(starts) - 1)
    ds = stations - starts[piece]
    coefficients = piecewise.coefficients[piece]
    result = np.zeros(np.shape(stations))
    for power in range(coefficients.shape[-1] - 1, order - 1, -1):
        result = result * ds + math.perm(power, order) * coefficients[..., power]
    return result


def constant(number: float, columns: int = 4) -> Piecewise:
    """The same everywhere."""
    return Piecewise(np.zeros(1), np.array([[number] + [0.0] * (columns - 1)]))


def steps(values: Sequence[tuple[float, float]], start: float, end: float, before: float) -> Piecewise:
    """Constant from each (station, value) on, from *start* to *end*; *before* where there is none yet."""
    cubics = [(s, (value_, 0.0, 0.0, 0.0)) for s, value_ in values]
    made = _between([(-math.inf, (before, 0.0, 0.0, 0.0)), *cubics], start, end)
    return Piecewise(made.starts, made.coefficients[:, :1])


def from_cubics(cubics: Sequence[Cubic], start: float, end: float) -> Piecewise:
    """The cubics of a road from its station *start* to *end*, over the distance from *start*; 0 before the first."""
    listed = [(cubic.s, (cubic.a, cubic.b, cubic.c, cubic.d)) for cubic in cubics]
    return _between([(-math.inf, (0.0, 0.0, 0.0, 0.0)), *listed], start, end)


def total(one: Piecewise, other: Piecewise, sign: float = 1.0) -> Piecewise:
    """The sum, or with *sign* -1 the difference, of two over the same way."""
    starts = np.union1d(one.starts, other.starts)
    return Piecewise(starts, _expanded(one, starts) + sign * _expanded(other, starts))


def widened(piecewise: Piecewise, columns: int) -> Piecewise:
    """The same with at least so many coefficients."""
    more = max(columns - piecewise.coefficients.shape[1], 0)
    return Piecewise(piecewise.starts, np.pad(piecewise.coefficients, ((0, 0), (0, more))))


def backwards(piecewise: Piecewise, length: float, sign: float = 1.0) -> Piecewise:
    """*sign* times the same over a way of *length*, from its other end."""
    ends = np.append(piecewise.starts[1:], length)
    shifted = _shifted(piecewise.coefficients, ends - piecewise.starts)
    turned = shifted * (-1.0) ** np.arange(shifted.shape[1])
    starts = length - ends[::-1]
    starts[0] = 0.0
    return Piecewise(starts, sign * turned[::-1])


def in_a_row(parts: Sequence[tuple[Piecewise, float]]) -> Piecewise:
    """One after the other, each over its length."""
    begins = np.concatenate([np.zeros(1), np.cumsum([length for _, length in parts])])
    starts = np.concatenate([part.starts + begin for (part, _), begin in zip(parts, begins[:-1], strict=True)])
    return Piecewise(starts, np.concatenate([part.coefficients for part, _ in parts]))


def joined(parts: Sequence[tuple[Piecewise, float]]) -> Piecewise:
    """One after the other, each over its length; pieces that only go on with the same constant are one."""
    row = in_a_row(parts)
    coefficients = row.coefficients
    same = np.all(coefficients[1:] == coefficients[:-1], axis=1) & np.all(coefficients[1:, 1:] == 0.0, axis=1)
    kept = np.append(True, ~same)
    return Piecewise(row.starts[kept], coefficients[kept])


def quintics(curve: Curve, start: float, end: float) -> tuple[Piecewise, Piecewise]:
    """x and y of a curve from *start* to *end*, over the distance from *start*: pieces that keep within ``CLOSE``.

    Position, direction and curvature are the curve's where pieces meet. Raises DseError located at its geometry if
    it winds too much.
    """
    pieces, length = 1, end - start
    while True:
        frames = curve.at(np.linspace(start, end, 8 * pieces + 1))
        nodes = Frames(frames.x[::8], frames.y[::8], frames.heading[::8], frames.curvature[::8], frames.pace)
        x, y = _hermite(nodes, length / pieces)
        worst = float(np.max(_off(x, y, frames, length / pieces)))
        if worst <= CLOSE:
            break
        # Between its ends a quintic's slope is off by the fifth power of its length, its place by the sixth.
        needed = pieces * (worst / CLOSE) ** (1 / 5) if math.isfinite(worst) else 32 * pieces
        pieces = max(pieces + 1, min(math.ceil(needed), 32 * pieces))
        if pieces > _MOST_PIECES:
            raise fail("this curve winds too much to be followed", curve.geometry.where)
    starts = np.linspace(0.0, length, pieces + 1)[:-1]
    x[:, 0] += curve.geometry.x
    y[:, 0] += curve.geometry.y
    return Piecewise(starts, x), Piecewise(starts, y)


def _off(x: Reals, y: Reals, frames: Frames, h: float) -> Reals:
    """How far quintics of length *h* are from *frames*, eight of each, and their slopes from its directions."""
    ds = h * np.arange(8) / 8
    at = partial(np.polynomial.polynomial.polyval, ds)
    slopes = np.arange(1, 6)
    place = np.hypot(at(x.T).ravel() - frames.x[:-1], at(y.T).ravel() - frames.y[:-1])
    cosine, sine = frames.pace * np.cos(frames.heading[:-1]), frames.pace * np.sin(frames.heading[:-1])
    slope = np.hypot(at((slopes * x[:, 1:]).T).ravel() - cosine, at((slopes * y[:, 1:]).T).ravel() - sine)
    return np.maximum(place, slope)


def _hermite(nodes: Frames, h: float) -> tuple[Reals, Reals]:
    """The quintics between neighbours of *nodes* that are *h* apart, by their coefficients."""
    heading, pace = nodes.heading, nodes.pace
    bend = pace**2 * nodes.curvature
    return (
        _quintic(nodes.x, pace * np.cos(heading), -bend * np.sin(heading), h),
        _quintic(nodes.y, pace * np.sin(heading), bend * np.cos(heading), h),
    )


def _quintic(p: Reals, v: Reals, a: Reals, h: float) -> Reals:
    d = p[1:] - p[:-1] - h * v[:-1] - h**2 / 2 * a[:-1]
    e = h * (v[1:] - v[:-1] - h * a[:-1])
    f = h**2 * (a[1:] - a[:-1])
    rest = (10 * d - 4 * e + f / 2) / h**3, (-15 * d + 7 * e - f) / h**4, (6 * d - 3 * e + f / 2) / h**5
    return np.stack([p[:-1], v[:-1], a[:-1] / 2, *rest], axis=1)


def _between(pieces: Sequence[tuple[float, Sequence[float]]], start: float, end: float) -> Piecewise:
    """The pieces that count from *start* to *end*, over the distance from *start*."""
    at_start = max(i for i, (s, _) in enumerate(pieces) if s <= start)
    # Of two at the same station the last one is meant.
    inside = {s: c for s, c in pieces[at_start + 1 :] if start < s < end}
    first_s, first = pieces[at_start]
    shift = start - first_s if math.isfinite(first_s) else 0.0
    starts = np.array([0.0, *(s - start for s in inside)])
    coefficients = np.array([first, *inside.values()])
    coefficients[:1] = _shifted(coefficients[:1], np.array([shift]))
    return Piecewise(starts, coefficients)


def _expanded(piecewise: Piecewise, starts: Reals) -> Reals:
    piece = np.searchsorted(piecewise.starts, starts, side="right") - 1
    return _shifted(piecewise.coefficients[piece], starts - piecewise.starts[piece])


def _shifted(coefficients: Reals, by: Reals) -> Reals:
    """The coefficients (n, m) of the same polynomials, counted from *by* (n) on."""
    columns = coefficients.shape[1]
    result = np.zeros_like(coefficients)
    for low in range(columns):
        for high in range(columns - 1, low - 1, -1):
            result[:, low] = result[:, low] * by + math.comb(high, low) * coefficients[:, high]
    return result
