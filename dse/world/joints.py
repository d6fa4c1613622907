"""Whether a path goes on where its parts meet, and how it is smoothed there if its user tolerates steps and kinks.

Real maps have steps of some dm and kinks of some degrees. A step d at a joint becomes two quintics over windows before
and behind it: the line before moves by d/2 until the joint, the one behind by -d/2 from there, both end in the mean
direction, and neither turns suddenly where a window begins or ends. Windows of ``_PER_STEP`` m for each m and
``_PER_KINK`` m for each rad keep the added turn of direction below 0.05 rad and the curvature to what a car can drive.
As turning the line moves a lane beside it, the rest of a step is measured and smoothed again.

Example: a step of 0.4 m to the left, straight roads, windows of 16 m. The line leaves the first road 16 m before its
end, is 0.2 m to the left of it there, and is on the second road 16 m later; its direction is never off by more than
1.875 * 0.2 / 16 = 0.023 rad.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from dse.errors import Location, Problem, raise_if_any
from dse.world.evaluation import PathPoint, lane_middle, place
from dse.world.opendrive.curves import Reals
from dse.world.pieces import total, widened
from dse.world.tables import Piecewise, RoadPath

STEP = 0.1
"""How far apart the middles of lanes may be where they go on in each other, in m, along, across and up."""
BEND = 0.1
"""How much a lane may turn there, in rad."""

_PER_STEP, _PER_KINK = 40.0, 60.0
_LEAST, _MOST = 5.0, 50.0  # m of a window
_SHARE = 0.49  # of the way to the next joint
_ROUNDS, _DONE = 4, 1e-9
_SMALL = 0.02  # m, rad: what is not smoothed
_ROUNDING = 1e-9
_SAME = 1e-6  # m: a station so near to the start of a piece is that start


@dataclass(frozen=True, slots=True)
class Tolerance:
    """The largest *step* in m and *kink* in rad of a road that a path smooths; what is below ``_SMALL`` stays."""

    step: float = 0.0
    kink: float = 0.0

    def covers(self, step: float, kink: float) -> bool:
        """Whether something that is so far off is let pass."""
        return step <= self.step + _ROUNDING and kink <= self.kink + _ROUNDING


STRICT = Tolerance()
_HINT = "steps and kinks of real maps are smoothed up to the 'tolerance' of the road's source"


@dataclass(frozen=True, slots=True)
class Joint:
    """A *station* of a path where *what* goes on *there*, at *where*."""

    station: float
    where: Location
    what: str
    there: str


@dataclass(frozen=True, slots=True)
class _Gap:
    """How the middle of the path's own lane goes on at a joint."""

    joint: Joint
    off: tuple[float, float, float]
    before: PathPoint
    after: PathPoint

    @property
    def step(self) -> float:
        return math.hypot(*self.off)

    @property
    def kink(self) -> float:
        return math.remainder(float(self.after.heading[0] - self.before.heading[0]), math.tau)

    def problem(self, step: float, kink: float) -> Problem | None:
        """What is wrong with it where a *step* and a *kink* are allowed."""
        begins = f"{self.joint.what} continues"
        if not self.step <= step:
            return Problem(f"{begins} {self.step:.3g} m off {self.joint.there}", self.joint.where)
        if not abs(self.kink) <= kink:
            return Problem(f"{begins} with a kink of {self.kink:.3g} rad {self.joint.there}", self.joint.where)
        return None


def with_hint(problem: Problem) -> Problem:
    """*problem*, and what would let it pass."""
    return problem if problem.hint else replace(problem, hint=_HINT)


def joined_up(path: RoadPath, joints: Sequence[Joint], tolerance: Tolerance) -> RoadPath:
    """*path*, smoothed at *joints*, the last of which is its end; what was smoothed is in its ``smoothed``.

    Raises DseError with the joints where it does not go on, beyond the *tolerance*.
    """
    inner = sorted((_snapped(path, joint) for joint in (joints if path.closed else joints[:-1])), key=_station)
    least = (STEP, BEND) if tolerance == STRICT else (_SMALL, _SMALL)
    found = [(gap, problem) for gap in _gaps(path, inner) if (problem := gap.problem(*least))]
    raise_if_any(
        with_hint(problem)
        for gap, problem in found
        if not tolerance.covers(gap.step, abs(gap.kink)) and gap.problem(STEP, BEND) is not None
    )
    if not found:
        return path
    wide = [max(_PER_STEP * gap.step, _PER_KINK * abs(gap.kink)) for gap, _ in found]
    windows = list(_windows(path, [gap.joint.station for gap, _ in found], wide))
    where = [gap.joint for gap, _ in found]
    raise_if_any(
        replace(problem, hint="there is too little room between it and the next one to smooth it")
        for (_, problem), window in zip(found, windows, strict=True)
        if min(window) < 1.0
    )
    for _ in range(_ROUNDS):
        gaps = list(_gaps(path, where))
        if max(max(gap.step, abs(gap.kink)) for gap in gaps) <= _DONE:
            break
        path = _smoothed(path, gaps, windows)
    notes = tuple(
        Problem(f"smoothed over {sum(window):.3g} m: {problem.what}", problem.where)
        for (_, problem), window in zip(found, windows, strict=True)
    )
    return replace(path, smoothed=notes)


def _station(joint: Joint) -> float:
    return joint.station


def _snapped(path: RoadPath, joint: Joint) -> Joint:
    """The joint where a piece of the path begins, to the last bit."""
    starts = np.append(path.x.starts, path.length)
    nearest = float(starts[np.argmin(np.abs(starts - joint.station))])
    return replace(joint, station=nearest) if abs(nearest - joint.station) <= _SAME else joint


def _gaps(path: RoadPath, joints: Sequence[Joint]) -> Iterator[_Gap]:
    for joint in joints:
        ends = np.array([np.nextafter(joint.station, 0.0)]), np.array([joint.station])
        ends = ends if joint.station < path.length else (ends[0], np.zeros(1))
        one, other = (place(path, s, lane_middle(path, s)) for s in ends)
        off = float(other.x[0] - one.x[0]), float(other.y[0] - one.y[0]), float(other.z[0] - one.z[0])
        yield _Gap(joint, off, one, other)


def _windows(path: RoadPath, stations: Sequence[float], wide: Sequence[float]) -> Iterator[tuple[float, float]]:
    """How far to smooth before and behind each joint: at most half the way to the next one."""
    count = len(stations)
    for i, (station, wish) in enumerate(zip(stations, wide, strict=True)):
        back, ahead = station, path.length - station
        if i or path.closed:
            back = (station - stations[i - 1]) % path.length or path.length
        if i + 1 < count or path.closed:
            ahead = (stations[(i + 1) % count] - station) % path.length or path.length
        is_first, is_last = not path.closed and i == 0, not path.closed and i == count - 1
        most = min(max(wish, _LEAST), _MOST)
        yield min(most, back if is_first else _SHARE * back), min(most, ahead if is_last else _SHARE * ahead)


def _smoothed(path: RoadPath, gaps: Sequence[_Gap], windows: Sequence[tuple[float, float]]) -> RoadPath:
    bends: list[list[tuple[float, Reals]]] = [[], [], []]
    for gap, (back, ahead) in zip(gaps, windows, strict=True):
        one, other = float(gap.before.heading[0]), float(gap.after.heading[0])
        mean, start = one + gap.kink / 2, gap.joint.station % path.length
        slopes = [(unit(mean) - unit(one), unit(mean) - unit(other)) for unit in (math.cos, math.sin)]
        for rows, off, (before, after) in zip(bends, gap.off, [*slopes, (0.0, 0.0)], strict=True):
            rows.append((gap.joint.station - back, _quintic(off / 2, before, back)))
            rows.append((start, _turned(-off / 2, after, ahead)))
            rows.append((start + ahead, np.zeros(6)))
    x, y, height = (
        total(widened(line, 6), _in_order(path, bend))
        for line, bend in zip((path.x, path.y, path.height), bends, strict=True)
    )
    has_steps = any(gap.off[2] for gap in gaps)
    return replace(path, x=x, y=y, height=height if has_steps else path.height)


def _in_order(path: RoadPath, bends: Sequence[tuple[float, Reals]]) -> Piecewise:
    """The pieces of a correction in the order of their stations: of two at one, the one that was put last counts."""
    rows = {0.0: np.zeros(6)}
    for start, row in sorted(bends, key=lambda each: each[0]):
        rows[max(start, 0.0)] = row if np.any(row) or start not in rows else rows[start]
    kept = [(start, row) for start, row in sorted(rows.items()) if start < path.length]
    return Piecewise(np.array([start for start, _ in kept]), np.array([row for _, row in kept]))


def _quintic(p: float, v: float, h: float) -> Reals:
    """From nothing to the value *p* with the slope *v* at *h*, without curvature at both ends."""
    return np.array(
        [0.0, 0.0, 0.0, (10 * p - 4 * v * h) / h**3, (7 * v * h - 15 * p) / h**4, (6 * p - 3 * v * h) / h**5]
    )


def _turned(p: float, v: float, h: float) -> Reals:
    """From the value *p* with the slope *v* to nothing at *h*, without curvature at both ends."""
    return np.array([p, v, 0.0, (-10 * p - 6 * v * h) / h**3, (15 * p + 8 * v * h) / h**4, (-6 * p - 3 * v * h) / h**5])
