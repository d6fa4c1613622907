"""What a run looks like from outside: a road, the host, other road users, what sensors see, weather, instruments."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from dse.report.content.data import Floats
from dse.report.drawing.road_picture import Area, Marking, StandingLight, StandingObject, StandingSign, Strip

CLASSES = ("none", "car", "truck", "motorcycle", "bicycle", "pedestrian", "obstacle")
"""The items of `actor_class`, in their order."""

COLOURS = ("none", "off", "red", "red_yellow", "yellow", "green")
"""The items of a light head's colour, in their order."""


@dataclass(frozen=True, slots=True, eq=False)
class Ground:
    """What is driven on: lanes, slippery areas, traffic lights, and what is beside.

    *kind* is "motorway", "town" or "rural"; without *markings* a page draws those that such a road has.
    """

    strips: tuple[Strip, ...]
    areas: tuple[Area, ...]
    lights: tuple[StandingLight, ...] = ()
    markings: tuple[Marking, ...] = ()
    signs: tuple[StandingSign, ...] = ()
    objects: tuple[StandingObject, ...] = ()
    kind: str = "rural"


@dataclass(frozen=True, slots=True, eq=False)
class Host:
    """The car itself: *columns* over time by their names (x, y, z in m of its centre of gravity on the road; heading,
    roll, pitch, steering in rad; speed in m/s; brake, drive in N m at the wheels; spin of the wheels in rad/s), and its
    size in m; *front* is from its centre of gravity to its bumper, *wheel* the radius of its wheels. *doubts*
    are sentences on sizes that no part of the bench states, or several parts differently."""

    columns: Mapping[str, Floats]
    length: float
    width: float
    front: float
    wheel: float = 0.31
    height: float = 1.5
    doubts: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class Sensor:
    """What looks around: *returns* are columns valid, range, azimuth of what it tells, seen from *mount* m ahead of the
    centre of gravity and *left* m beside it, *turn* rad to the left; it reaches *reach* m within *angle* rad (0: not
    known). *scan* are number and age (s) of the scan, if a trace needs them."""

    name: str
    title: str
    mount: float
    reach: float
    angle: float
    returns: tuple[Mapping[str, Floats], ...]
    left: float = 0.0
    turn: float = 0.0
    scan: Mapping[str, Floats] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, eq=False)
class Instrument:
    """A signal beside the scene, in *unit*: *values* over time with their *target*, or the *items* they stand for."""

    title: str
    unit: str
    values: Floats
    target: Floats | None = None
    items: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """A run to look at: all columns have a value for each *time* in s, which are equally far apart.

    *others* are columns id, class, length, width, height, x, y, z, heading, speed of one place each; class 0: nobody is
    there. *driver* is what driver displays show, as far as the run has it: limit (m/s), offset, width of the own lane,
    gap, detected of the vehicle ahead. *lights* are places in `COLOURS` over time, by ids of the ground's lights; of
    others nobody told what they show. *weather* are fog (1/m), rain, snow (m/s) and darkness (0 ... 1); and, where the
    run has them, water (m on the road), azimuth and elevation of the sun (rad).
    """

    title: str
    subtitle: str
    time: Floats
    ground: Ground
    host: Host
    others: tuple[Mapping[str, Floats], ...]
    sensors: tuple[Sensor, ...]
    weather: Mapping[str, Floats]
    instruments: tuple[Instrument, ...]
    lights: Mapping[str, Floats] = field(default_factory=dict)
    driver: Mapping[str, Floats] = field(default_factory=dict)
    mark: str = ""
    """What it was made from, as a digest; "" if nobody asks later."""
