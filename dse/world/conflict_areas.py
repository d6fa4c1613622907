"""Where the lanes of two paths cross or join, by their geometry."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from dse.world.evaluation import lane_middle, place
from dse.world.in_the_way import on_one_level
from dse.world.opendrive.curves import Reals
from dse.world.pieces import value
from dse.world.tables import RoadPath

WIDTH = 2.0
"""Of a usual vehicle, in m: a car with its mirrors. It drives on the middle of its path's own lane."""
JOINED = 0.25
"""Middles of lanes that stay nearer, in m, in one direction, are one lane: there one follows the other."""

_TURNED = 0.3  # rad between the directions of joined lanes
_STAYING = 5.0  # m for which they are near each other, or to the end of a path
_COARSE, _FINE = 2.0, 0.1  # m between stations
_BLOCK, _SPLIT, _ROUNDS = 80, 33, 3  # stations at once; borders are halved so often, to 3e-6 m
_SLACK = 1e-6  # m: what was found to touch still does when it is asked again

Range = tuple[float, float]
Truths = NDArray[np.bool_]
Points = NDArray[np.complex128]


@dataclass(frozen=True, slots=True)
class ConflictArea:
    """The stations of two paths between which vehicles of ``WIDTH`` on them would be in each other's way.

    A station is in the way if the vehicle's width there, at a right angle to its lane, touches what the other one
    sweeps; so lanes that cross at an angle a are in the way for (1 + |cos a|)/sin a times the width. Where lanes join,
    it ends where they are one. Found to 1 mm where lanes meet at more than 15 degrees. Stations beyond the length of a
    closed path go round.
    """

    entry: float
    exit: float
    other_entry: float
    other_exit: float


def find_conflict_areas(one: RoadPath, other: RoadPath) -> Iterator[ConflictArea]:
    """Where *one* crosses or joins *other*, on the middles of their own lanes; where they part they do not meet."""
    a, b = _Course(one), _Course(other)
    a, b = a.away_from(b), b.away_from(a)
    for whole in _touching(a, b, a.all, b.all):
        for there in _touching(b, a, b.all, (whole.start, whole.end)):
            for here in _touching(a, b, (whole.start, whole.end), (there.start, there.end)):
                parts = here.joined == here.start or there.joined == there.start
                if not parts and _on_one_level(a, b, here, there):
                    yield ConflictArea(*a.counted(here), *b.counted(there))


@dataclass(frozen=True, slots=True)
class _Touch:
    """Stations from *start* to *end* that touch the other path; *joined*: where they are one, else the end."""

    start: float
    end: float
    joined: float


def _on_one_level(a: _Course, b: _Course, here: _Touch, there: _Touch) -> bool:
    """Whether the lanes are, at the nearer end of what they touch of each other."""
    ends = (here.start, there.start), (here.joined, there.joined)
    return any(on_one_level(a.height(s) - b.height(other)) for s, other in ends)


class _Course:
    """The middle of a path's own lane."""

    def __init__(self, path: RoadPath, start: float = 0.0) -> None:
        self._path = path
        self.all: Range = (start, start + path.length)

    def away_from(self, other: _Course) -> _Course:
        """On a closed path, counted from where it is not near the other one, so that no touch is cut in two."""
        far = np.flatnonzero(~_near(self.coarse, other.coarse, WIDTH + _COARSE))
        if not self._path.closed or not len(far):
            return self
        return _Course(self._path, float(_spaced(self.all, _COARSE)[far[0]]))

    def counted(self, touch: _Touch) -> Range:
        """Its stations, counted from where the path begins."""
        rounds = touch.start // self._path.length * self._path.length if self._path.closed else 0.0
        return touch.start - rounds, touch.joined - rounds

    def at(self, s: Reals) -> tuple[Points, Points]:
        """Points as complex numbers, and directions of length 1."""
        t = lane_middle(self._path, s)
        placed = place(self._path, s, t)
        wrapped = np.mod(s, self._path.length) if self._path.closed else s
        lane = self._path.lanes[0]
        slope = (value(lane.left, wrapped, 1) + value(lane.right, wrapped, 1)) / 2
        direction = np.exp(1j * (placed.heading + np.arctan2(slope, 1 - placed.curvature * t)))
        return placed.x + 1j * placed.y, direction

    def height(self, s: float) -> float:
        """Of the lane there."""
        station = np.array([s])
        return float(place(self._path, station, lane_middle(self._path, station)).z[0])

    @cached_property
    def coarse(self) -> Points:
        """Points along all of it."""
        return self.at(_spaced(self.all, _COARSE))[0]

    @cached_property
    def fine(self) -> Points:
        """Points along all of it, closer to each other."""
        return self.at(_spaced(self.all, _FINE))[0]

    def line(self, range_: Range) -> Points:
        """Points along a part of it."""
        return self.fine if range_ == self.all else self.at(_spaced(range_, _FINE))[0]


def _spaced(range_: Range, step: float) -> Reals:
    return np.linspace(*range_, max(int(np.ceil((range_[1] - range_[0]) / step)), 1) + 1)


def _touching(a: _Course, b: _Course, on: Range, of: Range) -> Iterator[_Touch]:
    """The parts of *a* in the range *on* that touch *b* in the range *of*."""
    whole = on == a.all and of == b.all
    stations = _spaced(on, _COARSE)
    points = (a.coarse, b.coarse) if whole else (a.at(stations)[0], b.at(_spaced(of, _COARSE))[0])
    near = np.flatnonzero(_near(*points, WIDTH + _COARSE))
    if not len(near):
        return
    line = b.line(of)

    def touches(s: Reals) -> Truths:
        return _against(a, s, line)[0]

    def joins(s: Reals) -> Truths:
        return _against(a, s, line)[1]

    for run in np.split(near, np.flatnonzero(np.diff(near) > 1) + 1):
        first, last = max(run[0] - 1, 0), min(run[-1] + 1, len(stations) - 1)
        s = _spaced((float(stations[first]), float(stations[last])), _FINE)
        touch, joined = _against(a, s, line)
        for start, end in _runs(touch):
            begins = float(s[start]) if start == 0 else _border(touches, s[start - 1], s[start])
            ends = float(s[end]) if end == len(s) - 1 else _border(touches, s[end + 1], s[end])
            ones = (i for i, j in _runs(joined[: end + 1]) if i >= start and (s[j] - s[i] >= _STAYING or j == end))
            one = next(ones, -1)
            if one < 0:
                yield _Touch(begins, ends, ends)
            elif one == start:
                yield _Touch(begins, ends, begins)
            else:
                yield _Touch(begins, ends, _border(joins, s[one - 1], s[one]))


def _runs(true: Truths) -> Iterator[tuple[int, int]]:
    """The first and last index of each run of what is true."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], true, [False]]).astype(int)))
    return zip(edges[::2].tolist(), (edges[1::2] - 1).tolist(), strict=True)


def _border(holds: Callable[[Reals], Truths], outside: float, inside: float) -> float:
    """Where between two stations it begins to hold."""
    for _ in range(_ROUNDS):
        s = np.linspace(inside, outside, _SPLIT)
        false = np.flatnonzero(~holds(s))
        first = int(false[0]) if len(false) else len(s) - 1
        inside, outside = float(s[max(first - 1, 0)]), float(s[first])
    return inside


def _near(points: Points, others: Points, reach: float) -> Truths:
    """Which of the *points* may be within *reach* of the *others*: by squares of that size."""
    x, y = (np.floor(part / reach).astype(np.int64) for part in (points.real, points.imag))
    u, v = (np.floor(part / reach).astype(np.int64) for part in (others.real, others.imag))
    wide = np.int64(1 << 31)
    taken = np.unique(u * wide + v)
    near = np.zeros(len(points), bool)
    for i in (-1, 0, 1):
        for j in (-1, 0, 1):
            near |= np.isin((x + i) * wide + y + j, taken)
    return near


def _against(a: _Course, stations: Reals, line: Points) -> tuple[Truths, Truths]:
    """Which *stations* of *a* touch what is swept along the *line*, and which are one lane with it."""
    touch, joined = np.zeros(len(stations), bool), np.zeros(len(stations), bool)
    points, directions = a.at(stations)
    for at in range(0, len(stations), _BLOCK):
        block = slice(at, at + _BLOCK)
        p, d = points[block], directions[block]
        around = np.max(np.abs(p - p[0])) + WIDTH + _FINE
        close = np.flatnonzero(np.abs(line - p[0]) <= around)
        segments = np.unique(np.concatenate([close, close - 1]))
        segments = segments[(segments >= 0) & (segments < len(line) - 1)]
        if len(segments):
            touch[block], joined[block] = _seen(p[:, None], d[:, None], line[segments], line[segments + 1])
    return touch, joined


def _seen(p: Points, d: Points, c: Points, e: Points) -> tuple[Truths, Truths]:
    """Whether the width at *p* is within half a width of a segment from *c* to *e*, and whether *p* is on one."""
    side = 1j * d * (WIDTH / 2)
    way = e - c
    off = np.minimum(_off(p + side - c, way), _off(p - side - c, way))
    off = np.minimum(off, _off(c - p + side, 2 * side))
    here = _cross(way, p + side - c) * _cross(way, p - side - c) <= 0
    there = _cross(side, c - p) * _cross(side, e - p) <= 0
    touch: Truths = np.any((off <= WIDTH / 2 + _SLACK) | (here & there), axis=1)
    apart = _off(p - c, way)
    nearest = np.argmin(apart, axis=1)
    turned = np.abs(np.angle(way[nearest] / d[:, 0]))
    joined: Truths = (np.min(apart, axis=1) <= JOINED) & (turned <= _TURNED)
    return touch, joined


def _off(to: Points, way: Points) -> Reals:
    """How far points are from segments along *way* that begin at 0."""
    u = np.clip((to * np.conj(way)).real / np.abs(way) ** 2, 0.0, 1.0)
    distance: Reals = np.abs(to - u * way)
    return distance


def _cross(a: Points, b: Points) -> Reals:
    product: Reals = (np.conj(a) * b).imag
    return product
