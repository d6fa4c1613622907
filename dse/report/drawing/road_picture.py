"""What a picture of a road network shows, and its parts that are enlarged."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dse.report.content.data import Floats


@dataclass(frozen=True, slots=True, eq=False)
class Strip:
    """A lane in the plane: *left* and *right* border (n, 2) in m, in the direction in which it is driven.

    *left_height*, *right_height* (n) are those of the borders. *is_driven*: vehicles use it; *is_inside*: it is in a
    junction. *kind* is the lane's type in OpenDRIVE.
    """

    left: Floats
    right: Floats
    left_height: Floats
    right_height: Floats
    is_driven: bool
    is_inside: bool
    kind: str = "driving"


@dataclass(frozen=True, slots=True, eq=False)
class Marking:
    """A marking along *line* (n, 3) in m; *kind* and *colour* are OpenDRIVE's words, *width* is in m."""

    line: Floats
    kind: str
    width: float
    colour: str


@dataclass(frozen=True, slots=True, eq=False)
class StandingSign:
    """A traffic sign at *place* (3), whose face is for those who drive towards *heading*; *text* is on it.

    *kind* is "limit", or the code of the German catalogue.
    """

    place: Floats
    heading: float
    kind: str
    text: str


@dataclass(frozen=True, slots=True, eq=False)
class StandingObject:
    """An object at *place* (3), turned to *heading*; *kind* is OpenDRIVE's word, *size* its length, width, height."""

    place: Floats
    heading: float
    kind: str
    size: tuple[float, float, float]


@dataclass(frozen=True, slots=True, eq=False)
class Area:
    """An *outline* (n, 2) in m with a *friction* of its own, against dry asphalt."""

    outline: Floats
    friction: float


@dataclass(frozen=True, slots=True, eq=False)
class StandingLight:
    """A traffic light: *place* (3) in m, beside the lanes it is for, whose users drive towards *heading* in rad.

    *line* (2, 3) are the ends of the line to stop at, left and right; *id* is what the road's file calls it.
    """

    id: str
    place: Floats
    heading: float
    line: Floats


@dataclass(frozen=True, slots=True, eq=False)
class AlongBand:
    """A lane along the path: its borders, in m to the left of the middle of the own lane; NaN where it is not."""

    right: Floats
    left: Floats
    is_own: bool


@dataclass(frozen=True, slots=True, eq=False)
class Along:
    """What lies along a path, at *stations* in m.

    *x* and *y* are the middle of its own lane; *height* in m, *slope* across (> 0: left side higher) and *curvature* in
    1/m those of the reference line. *areas* are outlines in station and m to the left of the middle of the lane,
    *lights* stations, *limits* stations and speeds in m/s, 0 for none.
    """

    stations: Floats
    x: Floats
    y: Floats
    height: Floats
    slope: Floats
    curvature: Floats
    bands: tuple[AlongBand, ...]
    areas: tuple[Area, ...]
    lights: Floats
    limits: tuple[tuple[float, float], ...]


@dataclass(frozen=True, slots=True, eq=False)
class Driven:
    """A path that was driven: *x*, *y* in the plane; and *offset* to the left of the lane's middle over *station*."""

    label: str
    x: Floats
    y: Floats
    station: Floats
    offset: Floats


@dataclass(frozen=True, slots=True, eq=False)
class RoadPicture:
    """A network, what lies along the path that is driven unless told otherwise, and paths that were driven."""

    title: str
    strips: tuple[Strip, ...]
    areas: tuple[Area, ...]
    lights: Floats
    along: Along
    driven: tuple[Driven, ...] = ()


@dataclass(frozen=True, slots=True)
class MapExtent:
    """A part of the plane."""

    left: float
    right: float
    below: float
    above: float

    @property
    def wide(self) -> float:
        """Along x."""
        return self.right - self.left

    @property
    def tall(self) -> float:
        """Along y."""
        return self.above - self.below

    def holds(self, points: Floats) -> NDArray[np.bool_]:
        """Which of the *points* (n, 2) are in it."""
        x, y = points.T
        inside: NDArray[np.bool_] = (self.left <= x) & (x <= self.right) & (self.below <= y) & (y <= self.above)
        return inside

    def meets(self, other: MapExtent) -> bool:
        """Whether they overlap."""
        apart = (
            self.right < other.left or other.right < self.left or self.above < other.below or other.above < self.below
        )
        return not apart

    def joined(self, other: MapExtent) -> MapExtent:
        """What holds both."""
        return MapExtent(
            min(self.left, other.left),
            max(self.right, other.right),
            min(self.below, other.below),
            max(self.above, other.above),
        )


def around(strips: Sequence[Strip], margin: float) -> MapExtent:
    """What holds the *strips*, with a *margin* in m, and some more."""
    return around_points(np.concatenate([side for strip in strips for side in (strip.left, strip.right)]), margin)


def around_points(points: Floats, margin: float) -> MapExtent:
    """What holds the *points* (n, 2), with a *margin* in m, and some more."""
    (left, below), (right, above) = points.min(axis=0), points.max(axis=0)
    margin += 0.03 * float(max(right - left, above - below))
    return MapExtent(float(left) - margin, float(right) + margin, float(below) - margin, float(above) + margin)


def crossings(strips: Sequence[Strip]) -> Iterator[MapExtent]:
    """Around lanes within junctions, those together that are near each other."""
    boxes: list[MapExtent] = []
    for strip in strips:
        if strip.is_inside:
            box = around([strip], 8.0)
            near = [other for other in boxes if other.meets(box)]
            boxes = [other for other in boxes if other not in near]
            for other in near:
                box = box.joined(other)
            boxes.append(box)
    yield from boxes
