"""Where the pieces of a reference line lie in the plane, to the accuracy of doubles."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from dse.errors import fail
from dse.world.opendrive.structure import Arc, Geometry, Line, Parametric, Polynomial, Spiral
from dse.world.quadrature import gauss, weighed

Reals: TypeAlias = NDArray[np.float64]
Points: TypeAlias = NDArray[np.complex128]
Local: TypeAlias = Callable[[Reals], tuple[Points, Reals, Reals]]
"""From stations to places in axes along and across the heading at the start, angles turned and curvatures."""

_MOST_CELLS = 2**14
_LEAST_PACE = 1e-6


@dataclass(frozen=True, eq=False, slots=True)
class Frames:
    """Points of a line: *x*, *y* from where it begins in m, headings in rad, curvatures in 1/m.

    *pace* is m of line per m of station: 1 but for curves whose length is not quite what the file says.
    """

    x: Reals
    y: Reals
    heading: Reals
    curvature: Reals
    pace: float


@dataclass(frozen=True, eq=False, slots=True)
class Curve:
    """A geometry, ready to be asked; *length* is what the shape itself says, near the one that the file gives."""

    geometry: Geometry
    length: float
    local: Local

    def at(self, stations: Reals) -> Frames:
        """The frames at *stations*, in m from the start of the piece."""
        g = self.geometry
        pace = self.length / g.length
        along, turned, curvature = self.local(stations * pace)
        turned_into = along * complex(math.cos(g.heading), math.sin(g.heading))
        return Frames(turned_into.real, turned_into.imag, g.heading + turned, curvature, pace)


def curve_of(geometry: Geometry) -> Curve:
    """The curve of a geometry; raises DseError located there where it stands still or its length cannot be found."""
    match geometry.shape:
        case Line():
            return Curve(geometry, geometry.length, _line)
        case Arc(curvature):
            return Curve(geometry, geometry.length, lambda s: _arc(curvature, s))
        case Spiral(start, end):
            return Curve(geometry, geometry.length, _spiral(start, end, geometry.length))
        case Polynomial(v):
            # A curve v(u) is no shorter than u, so that u goes no further than the length.
            lengths = _lengths(geometry, (0.0, 1.0, 0.0, 0.0), v, geometry.length)
            return Curve(geometry, geometry.length, _parametric((0.0, 1.0, 0.0, 0.0), v, lengths))
        case Parametric(u, v, last):
            lengths = _lengths(geometry, u, v, last)
            return Curve(geometry, float(lengths.sums[-1].real), _parametric(u, v, lengths))


class _Antiderivative:
    """The integral of *f* from the first of *edges* on, by sixteen points a cell (Gauss and Legendre)."""

    def __init__(self, f: Callable[[Reals], Points], edges: Reals) -> None:
        self.f, self.edges = f, edges
        self.sums = np.concatenate([np.zeros(1), np.cumsum(self._between(edges[:-1], edges[1:]))])

    def __call__(self, p: Reals) -> Points:
        cell = np.clip(np.searchsorted(self.edges, p, side="right") - 1, 0, len(self.edges) - 2)
        return np.asarray(self.sums[cell] + self._between(self.edges[cell], p))

    def inverse(self, values: Reals) -> Reals:
        """Where the integral of a positive *f* has *values*, by Newton's method."""
        p = np.interp(values, self.sums.real, self.edges)
        for _ in range(60):
            change = (self(p).real - values) / self.f(p).real
            p = p - change
            if np.max(np.abs(change), initial=0.0) <= 1e-14 * abs(self.edges[-1]):
                break
        return p

    def _between(self, a: Reals, b: Reals) -> Points:
        points, _ = gauss()
        return np.asarray((b - a) * weighed(self.f(a[:, None] + (b - a)[:, None] * points)))


def _line(s: Reals) -> tuple[Points, Reals, Reals]:
    return np.asarray(s, dtype=np.complex128), np.zeros_like(s), np.zeros_like(s)


def _arc(curvature: float, s: Reals) -> tuple[Points, Reals, Reals]:
    # By its chord, which stays exact for circles of any size.
    half = curvature * s / 2
    return np.asarray(s * np.sinc(half / np.pi) * np.exp(1j * half)), 2 * half, np.full_like(s, curvature)


def _spiral(start: float, end: float, length: float) -> Local:
    # Not by Fresnel integrals, which lose their digits where the curvature hardly changes.
    rate = (end - start) / length
    cells = 1 + int(max(abs(start), abs(end)) * length)
    along = _Antiderivative(lambda s: np.exp(1j * s * (start + rate * s / 2)), np.linspace(0, length, cells + 1))

    def at(s: Reals) -> tuple[Points, Reals, Reals]:
        return along(s), s * (start + rate * s / 2), start + rate * s

    return at


Coefficients = tuple[float, float, float, float]


def _lengths(geometry: Geometry, u: Coefficients, v: Coefficients, last: float) -> _Antiderivative:
    """Length over parameter, from 0 to *last*; with cells so many that twice as many change nothing."""
    slope = _derivative(u, v, 1)

    def pace(p: Reals) -> Points:
        return np.abs(slope(p)) + 0j

    cells = 4
    made = _Antiderivative(pace, np.linspace(0, last, cells + 1))
    while True:
        finer = _Antiderivative(pace, np.linspace(0, last, 2 * cells + 1))
        total = float(finer.sums[-1].real)
        slowest = float(np.min(pace(np.linspace(0, last, 8 * cells + 1)).real))
        if not slowest * last > _LEAST_PACE * total:
            raise fail("the curve has no direction at a point where its derivative is zero", geometry.where)
        if abs(total - made.sums[-1].real) <= 1e-11 * total + 1e-12:
            return finer
        cells, made = 2 * cells, finer
        if cells > _MOST_CELLS:
            raise fail("the length of this curve cannot be found", geometry.where)


def _parametric(u: Coefficients, v: Coefficients, lengths: _Antiderivative) -> Local:
    place, slope, bend = (_derivative(u, v, order) for order in range(3))

    def at(s: Reals) -> tuple[Points, Reals, Reals]:
        p = lengths.inverse(s)
        first = slope(p)
        return place(p), np.angle(first), (first.conj() * bend(p)).imag / np.abs(first) ** 3

    return at


def _derivative(u: Coefficients, v: Coefficients, order: int) -> Callable[[Reals], Points]:
    coefficients = np.polynomial.polynomial.polyder(np.array(u) + 1j * np.array(v), order)
    return lambda p: np.asarray(np.polynomial.polynomial.polyval(p, coefficients))
