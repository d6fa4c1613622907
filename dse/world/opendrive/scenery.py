"""What of an OpenDRIVE road is only seen: markings, signs, objects beside it, and what kind of road it is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True)
class RoadMark:
    """The marking at the outer border of a lane from *s* on: its *kind* as OpenDRIVE names it, *width* in m."""

    s: float
    kind: str
    width: float
    colour: str


@dataclass(frozen=True, slots=True)
class PlacedSign:
    """A sign at *s*, *t*, for drivers along the road ("+"), against it ("-") or both; *text* is the number on it.

    *kind* is "limit", or the code of the German catalogue.
    """

    s: float
    t: float
    orientation: str
    kind: str
    text: str


@dataclass(frozen=True, slots=True)
class PlacedObject:
    """Something that stands at *s*, *t* (m), *raised* over the road, turned by *heading* against it; sizes in m."""

    s: float
    t: float
    raised: float
    heading: float
    kind: str
    length: float
    width: float
    height: float


@dataclass(frozen=True, slots=True)
class Scenery:
    """What is seen of a road: *marks* by start of their section and id of their lane, 0 for the centre."""

    kind: str = ""
    marks: Mapping[tuple[float, int], tuple[RoadMark, ...]] = field(default_factory=dict)
    signs: tuple[PlacedSign, ...] = ()
    objects: tuple[PlacedObject, ...] = ()
