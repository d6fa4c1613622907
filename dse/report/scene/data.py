"""What a run looks like from outside: a road, the host, other road users, what sensors see, weather, instruments."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from dse.report.content.data import Floats
from dse.report.drawing.road_picture import Area, StandingLight, Strip

CLASSES = ("none", "car", "truck", "motorcycle", "bicycle", "pedestrian", "obstacle")
"""The items of `actor_class`, in their order."""

COLOURS = ("none", "off", "red", "red_yellow", "yellow", "green")
"""The items of a light head's colour, in their order."""


@dataclass(frozen=True, slots=True, eq=False)
class Ground:
    """What is driven on: lanes, slippery areas, and traffic lights."""

    strips: tuple[Strip, ...]
    areas: tuple[Area, ...]
    lights: tuple[StandingLight, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class Host:
    """The car itself: *columns* over time by their names (x, y, z in m of its centre of gravity on the road; heading,
    roll, pitch, steering in rad; speed in m/s), and its size in m;
    *front* is from its centre of gravity to its bumper."""

    columns: Mapping[str, Floats]
    length: float
    width: float
    front: float


@dataclass(frozen=True, slots=True, eq=False)
class Sensor:
    """What looks around: *returns* are columns valid, range, azimuth of what it tells, seen from *mount* m ahead of the
    centre of gravity and *left* m beside it, *turn* rad to the left; it reaches *reach* m within *angle* rad (0: not
    known)."""

    name: str
    title: str
    mount: float
    reach: float
    angle: float
    returns: tuple[Mapping[str, Floats], ...]
    left: float = 0.0
    turn: float = 0.0


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
    there. *lights* are places in `COLOURS` over time, by ids of the ground's lights; of others nobody told what they
    show. *weather* are fog (1/m), rain, snow (m/s) and darkness (0 ... 1).
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
    mark: str = ""
    """What it was made from, as a digest; "" if nobody asks later."""
