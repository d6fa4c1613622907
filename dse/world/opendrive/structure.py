"""What an OpenDRIVE file says, in its own words; everything knows where it stands in the file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum
from typing import TypeAlias

from dse.errors import Location, Problem
from dse.world.opendrive.scenery import Scenery


class End(Enum):
    """The two ends of a road."""

    START = "start"
    END = "end"


@dataclass(frozen=True, slots=True)
class Cubic:
    """a + b ds + c ds² + d ds³ with ds from *s* on, which counts from the start of the road."""

    s: float
    a: float
    b: float
    c: float
    d: float
    where: Location


@dataclass(frozen=True, slots=True)
class Line:
    """Straight on."""


@dataclass(frozen=True, slots=True)
class Arc:
    """A part of a circle; *curvature* > 0 turns left."""

    curvature: float


@dataclass(frozen=True, slots=True)
class Spiral:
    """A clothoid: the curvature goes from *start* to *end*, linear in the length."""

    start: float
    end: float


@dataclass(frozen=True, slots=True)
class Polynomial:
    """v(u), with the coefficients *v*, in axes along and across the heading at the start; as long as is said."""

    v: tuple[float, float, float, float]


@dataclass(frozen=True, slots=True)
class Parametric:
    """u(p), v(p) in axes along and across the heading at the start, for p from 0 to *last*."""

    u: tuple[float, float, float, float]
    v: tuple[float, float, float, float]
    last: float


Shape: TypeAlias = Line | Arc | Spiral | Polynomial | Parametric


@dataclass(frozen=True, slots=True)
class Geometry:
    """A piece of a reference line that begins at *s*, in *x*, *y* with *heading*."""

    s: float
    x: float
    y: float
    heading: float
    length: float
    shape: Shape
    where: Location


@dataclass(frozen=True, slots=True)
class Limit:
    """A speed limit in m/s from *s* on; 0: none."""

    s: float
    speed: float


@dataclass(frozen=True, slots=True)
class Fault:
    """What real maps have, and a path refuses unless its tolerance is as large: a *step* in m, a *kink* in rad."""

    problem: Problem
    step: float = 0.0
    kink: float = 0.0


@dataclass(frozen=True, slots=True)
class Lane:
    """A lane in a section; ids > 0 lie left of the centre lane, in order.

    *widths* go before *borders*, which are the t of its outer border. *frictions* are (s, value). *reversed_* lanes are
    driven against what their side of the road says. *users* are the classes that may drive along it (`in_the_way`).
    """

    id: int
    type: str
    reversed_: bool
    widths: tuple[Cubic, ...]
    borders: tuple[Cubic, ...]
    predecessors: tuple[int, ...]
    successors: tuple[int, ...]
    limits: tuple[Limit, ...]
    frictions: tuple[tuple[float, float], ...]
    users: frozenset[str]
    faults: tuple[Fault, ...]
    refused: tuple[Problem, ...]
    where: Location


@dataclass(frozen=True, slots=True)
class Section:
    """The lanes of a road from *s* to *end*.

    *left_goes_on* and *right_goes_on*: the section before has the same lanes on that side, and links are not asked.
    """

    s: float
    end: float
    lanes: Mapping[int, Lane]
    left_goes_on: bool
    right_goes_on: bool
    where: Location


@dataclass(frozen=True, slots=True)
class RoadLink:
    """What a road meets at one of its ends: a "road" at its *contact*, or a "junction"."""

    element: str
    id: str
    contact: End
    where: Location


@dataclass(frozen=True, slots=True)
class Slick:
    """A rectangle on the road with a *friction* of its own, from *start* to *end* and from t = *right* to *left*."""

    start: float
    end: float
    right: float
    left: float
    friction: float
    where: Location


@dataclass(frozen=True, slots=True)
class Signal:
    """A traffic light of a road at *s*, for the lanes of *lanes* (from, to) or all; *orientation* "+", "-" or "none".

    *phases* are colours and the seconds each is shown, from *shift* s on; none if the file does not say.
    """

    id: str
    s: float
    orientation: str
    lanes: tuple[tuple[int, int], ...]
    phases: tuple[tuple[str, float], ...]
    shift: float
    where: Location


@dataclass(frozen=True, slots=True)
class Sign:
    """A speed limit in m/s (0: its end) that a sign tells, which stands as a Signal does."""

    s: float
    orientation: str
    lanes: tuple[tuple[int, int], ...]
    speed: float


@dataclass(frozen=True, slots=True)
class TrafficOrder:
    """A sign of the German catalogue that says who has the right of way, which stands as a Signal does.

    *kind* is 205 (give way), 206 (stop), 301 (right of way at the next junction), 306 (priority road) or 307 (its end).
    """

    s: float
    orientation: str
    lanes: tuple[tuple[int, int], ...]
    kind: str


@dataclass(frozen=True, slots=True)
class Road:
    """A road: its reference line, heights, lanes and what stands on it.

    *junction* is "" for a road that is not in one. What cannot be followed along it is in *refused*: it is told when a
    path uses the road; so are *faults*, unless it tolerates them. *ignored* is what may matter and has no effect.
    """

    id: str
    length: float
    left_hand: bool
    junction: str
    links: Mapping[End, RoadLink]
    geometries: tuple[Geometry, ...]
    elevation: tuple[Cubic, ...]
    superelevation: tuple[Cubic, ...]
    offsets: tuple[Cubic, ...]
    sections: tuple[Section, ...]
    limits: tuple[Limit, ...]
    slicks: tuple[Slick, ...]
    signals: tuple[Signal, ...]
    signs: tuple[Sign, ...]
    orders: tuple[TrafficOrder, ...]
    refused: tuple[Problem, ...]
    faults: tuple[Fault, ...]
    ignored: tuple[Problem, ...]
    where: Location
    scenery: Scenery = field(default_factory=Scenery)


@dataclass(frozen=True, slots=True)
class Connection:
    """The way out of *incoming* into *road*, which it meets at *contact*; *links* are pairs of lanes.

    Without links, lanes of the same id go on in each other.
    """

    incoming: str
    road: str
    contact: End
    links: tuple[tuple[int, int], ...]
    where: Location


@dataclass(frozen=True, slots=True)
class Junction:
    """Where roads meet; *kind* is "default", "direct" or one that is not followed.

    *priorities* are pairs of ids: who is on the first road goes before who is on the second.
    """

    id: str
    kind: str
    connections: tuple[Connection, ...]
    priorities: tuple[tuple[str, str], ...]
    where: Location


@dataclass(frozen=True, slots=True)
class Network:
    """All roads and junctions of a file, by their ids, in its order; *route*: the roads of the way it was made for.

    *roundabouts* are the ids of the junctions of each.
    """

    roads: Mapping[str, Road]
    junctions: Mapping[str, Junction]
    where: Location
    route: tuple[str, ...] = ()
    roundabouts: tuple[frozenset[str], ...] = ()
