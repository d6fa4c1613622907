"""Intersections and roundabouts: where their arms begin, and the ways through them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from dse.domain.road import Intersection, Lanes, Roundabout
from dse.world.writing.pieces import Bend, Pose, laid, root, turning

COMING = "coming"
"""The arm on which the road comes in."""

_DIRECTIONS = {COMING: math.pi, "right": -math.pi / 2, "straight": 0.0, "left": math.pi / 2}


@dataclass(frozen=True, slots=True)
class Arm:
    """A road's end at a crossing: *pose* looks outward; *lanes* are those of the road in its own direction.

    The road that comes in is directed inward, all others outward.
    """

    side: str
    pose: Pose
    lanes: Lanes

    @property
    def coming(self) -> int:
        """How many lanes lead to the crossing."""
        return self.lanes.forward if self.side == COMING else self.lanes.backward

    @property
    def leaving(self) -> int:
        """How many lanes lead away from it."""
        return self.lanes.backward if self.side == COMING else self.lanes.forward

    def lane(self, number: int) -> int:
        """The lane of the road that is the *number*-th from its middle: > 0 for one that leaves, < 0 for one that comes
        in."""
        return number if self.side == COMING else -number

    def into(self, number: int) -> Pose:
        """Where, on its middle, the *number*-th lane that comes in reaches the crossing."""
        return self.pose.moved(0.0, (number - 0.5) * self.lanes.width, math.pi)

    def out(self, number: int) -> Pose:
        """Where the *number*-th lane that leaves begins."""
        return self.pose.moved(0.0, (0.5 - number) * self.lanes.width)


@dataclass(frozen=True, slots=True)
class JunctionWay:
    """A lane through a crossing, on its middle: from the *first* lane of an arm to the *last* of another one."""

    start: Arm
    end: Arm
    first: int
    last: int
    bends: tuple[Bend, ...]


def arms_of(shape: Intersection | Roundabout, lanes: Lanes, comes: Pose) -> dict[str, Arm]:
    """The arms by their sides, for a road with *lanes* that *comes* there."""
    across = shape.lanes if isinstance(shape, Intersection) else lanes
    wide = {True: _half(across), False: _half(lanes)}
    ring = None if isinstance(shape, Intersection) else Ring.of(shape, lanes.width)

    def reach(side: str) -> float:
        if isinstance(shape, Intersection):
            return wide[side in (COMING, "straight")] + shape.corner
        return ring.reach if ring else 0.0

    centre = comes.moved(reach(COMING))
    return {
        side: Arm(
            side,
            comes.moved(0.0, 0.0, math.pi)
            if side == COMING
            else centre.moved(0.0, 0.0, _DIRECTIONS[side]).moved(reach(side)),
            across if side in ("left", "right") else lanes,
        )
        for side in (COMING, *shape.sides)
    }


def _half(lanes: Lanes) -> float:
    return max(lanes.forward, lanes.backward) * lanes.width


def ways(arms: Mapping[str, Arm]) -> Iterator[JunctionWay]:
    """All ways through an intersection: straight on lane by lane, to the right and left between the outer and the inner
    lanes."""
    for start in arms.values():
        for end in arms.values():
            if start is end or not (start.coming and end.leaving):
                continue
            turn = math.remainder(_DIRECTIONS[end.side] - _DIRECTIONS[start.side] - math.pi, 2 * math.pi)
            if abs(turn) < 0.1:
                for number in range(1, min(start.coming, end.leaving) + 1):
                    length = math.dist(_xy(start.into(number)), _xy(end.out(number)))
                    yield JunctionWay(start, end, number, number, (Bend(length),))
                continue
            first, last = (1, 1) if turn > 0 else (start.coming, end.leaving)
            yield JunctionWay(start, end, first, last, turning(start.into(first), end.out(last)))


def _xy(pose: Pose) -> tuple[float, float]:
    return pose.x, pose.y


@dataclass(frozen=True, slots=True)
class Ring:
    """The ring of a roundabout, driven to the left, on the middle of its lane, of *radius*.

    *bends* lead onto it from an arm that begins *reach* from the centre: a spiral to the right, an arc, and a spiral
    that ends with the ring's curvature, *angle* to the left of the arm. The way off it is their mirror image.
    """

    radius: float
    reach: float
    angle: float
    bends: tuple[Bend, ...]

    @staticmethod
    def of(shape: Roundabout, width: float) -> Ring:
        """The ring, and the ways onto it from arms with lanes of this *width*."""
        radius = shape.radius
        entry = _ENTRY * radius
        spiral = _SPIRAL * entry

        def onto(arc: float) -> tuple[Bend, ...]:
            tight = -1 / entry
            return Bend(spiral, 0.0, tight), Bend(arc, tight, tight), Bend(2 * spiral, tight, 1 / radius)

        def centre(arc: float) -> Pose:
            """The ring's centre, where it is joined, seen from where the bends begin."""
            _, joined = laid(Pose(0.0, 0.0, 0.0), onto(arc))
            return joined.moved(0.0, radius)

        # The arm's lane that comes in has the centre half a lane to its left.
        arc = root(lambda arc: width / 2 - centre(arc).y, 0.0, math.pi / 2 * entry)
        found, middle = onto(arc), centre(arc)
        turned = sum(bend.turn for bend in found)
        return Ring(radius, middle.x, math.pi / 2 + turned, found)

    @property
    def off(self) -> tuple[Bend, ...]:
        """From the ring onto an arm."""
        return tuple(Bend(bend.length, bend.last, bend.first) for bend in reversed(self.bends))

    def at(self, centre: Pose, angle: float) -> Pose:
        """Where it passes, seen from its *centre* under *angle*."""
        return centre.moved(0.0, 0.0, angle).moved(self.radius, 0.0, math.pi / 2)

    def along(self, angle: float) -> Bend:
        """So far around it."""
        return Bend(self.radius * angle, 1 / self.radius, 1 / self.radius)


_ENTRY, _SPIRAL = 0.6, 0.15
"""The radius of the way onto a ring in radii of the ring; the length of its first spiral in radii of its own."""
