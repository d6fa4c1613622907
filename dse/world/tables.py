"""What the world's C core reads of a road network: paths as piecewise polynomials over their stations."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dse.errors import Problem
from dse.world.in_the_way import ALL_USERS


@dataclass(frozen=True, eq=False)
class Piecewise:
    """Polynomials one after the other: on piece i the value is sum over j of coefficients[i, j] (s - starts[i])^j.

    *starts* (n), in m, increase and begin with 0; the last piece ends where the path does. *coefficients* (n, m).
    """

    starts: NDArray[np.float64]
    coefficients: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class LaneBand:
    """A lane beside a path: *number* 0 is the path's own, 1 the next to the left, -1 the next to the right.

    *left* and *right* are its borders, in m to the left of the reference line; where the lane is not there they are
    equal. *friction*, against dry asphalt, is constant in pieces. Only lanes that vehicles use are counted. *users* are
    the bits of the classes (`in_the_way.user_bits`) that may drive along all of it.
    """

    number: int
    left: Piecewise
    right: Piecewise
    friction: Piecewise
    users: int = ALL_USERS


@dataclass(frozen=True)
class Patch:
    """A part of the road with a *friction* of its own, against dry asphalt; it goes before that of the lanes.

    *start* and *end* are m along the path, *right* and *left* m to the left of its reference line.
    """

    start: float
    end: float
    right: float
    left: float
    friction: float


@dataclass(frozen=True)
class Light:
    """A traffic light at a *station* of a path: *phases* are colours and s each is shown, from *shift* s on.

    Without phases nobody has said what it shows.
    """

    id: str
    station: float
    phases: tuple[tuple[str, float], ...]
    shift: float


@dataclass(frozen=True)
class Leg:
    """A road that a path passes, from *start*, a station of the path, on; *junction* is "" outside of junctions."""

    start: float
    road: str
    junction: str
    left_hand: bool


@dataclass(frozen=True)
class PathOrder:
    """A sign at a *station* of a path that says who has the right of way, by its number in the German catalogue."""

    station: float
    kind: str


@dataclass(frozen=True)
class Conflict:
    """Where a path crosses or joins another one, by stations; both are counted from 0.

    *gives_way* says whether who is on the path does; neither does where lights see to it.
    """

    path: int
    entry: float
    exit: float
    other_path: int
    other_entry: float
    other_exit: float
    gives_way: bool


@dataclass(frozen=True, eq=False)
class RoadPath:
    """A way through a road network in its direction of travel: a reference line, and all that lies along it.

    *x*, *y* (degree 5, m, with the same pieces) are the reference line in the plane, within 1e-7 m of the road's; its
    stations are lengths as far as the road's are. Where a path goes from one road to the next the line may jump to its
    side, and the borders of the lanes with it, so that the lanes go on without a jump. *height* in m, *bank* in rad
    (> 0: left side higher) belong to the reference line; a point at t to its left is t tan(bank) above it, and t is
    measured in the plane. *speed_limit* in m/s, 0 where there is none, is constant in pieces. *lanes* has the path's
    own lane first; from *leftmost* to *rightmost* they are driven in its direction where it begins. *smoothed* is what
    a tolerance let pass, or smoothed.
    """

    name: str
    length: float
    closed: bool
    x: Piecewise
    y: Piecewise
    height: Piecewise
    bank: Piecewise
    speed_limit: Piecewise
    lanes: tuple[LaneBand, ...]
    patches: tuple[Patch, ...] = ()
    lights: tuple[Light, ...] = ()
    orders: tuple[PathOrder, ...] = ()
    legs: tuple[Leg, ...] = ()
    leftmost: int = 0
    rightmost: int = 0
    smoothed: tuple[Problem, ...] = ()


@dataclass(frozen=True, eq=False)
class RoadTables:
    """The paths of a network that a road component carries, and where they meet; the host drives the first."""

    paths: tuple[RoadPath, ...]
    conflicts: tuple[Conflict, ...] = ()
