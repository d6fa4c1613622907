"""Roads as a user writes them: segments, one behind the other."""

from __future__ import annotations

from dataclasses import dataclass

from dse.errors import Location


@dataclass(frozen=True, slots=True)
class Lanes:
    """So many lanes in the direction of the road, right of its reference line, and so many against it; *width* in m."""

    forward: int
    backward: int
    width: float


@dataclass(frozen=True, slots=True)
class Slippery:
    """A part of a segment with a *friction* of its own, against dry asphalt.

    *start* and *end* are m along the segment; *right* and *left* m to the left of the road's reference line, both None
    where it is the whole width.
    """

    start: float
    end: float
    right: float | None
    left: float | None
    friction: float


@dataclass(frozen=True, slots=True)
class Straight:
    """A straight of a *length* in m."""

    length: float


@dataclass(frozen=True, slots=True)
class Curve:
    """Turns by *angle* (rad, > 0: to the left): an arc of *radius* between spirals of lengths from 0, in m.

    *bank* is the slope across in the arc, > 0 with the inner side lower.
    """

    radius: float
    angle: float
    spiral_in: float
    spiral_out: float
    bank: float

    @property
    def arc(self) -> float:
        """The length of the arc; < 0 if the spirals alone turn further."""
        return self.radius * abs(self.angle) - (self.spiral_in + self.spiral_out) / 2

    @property
    def length(self) -> float:
        """All of it, in m."""
        return self.spiral_in + self.arc + self.spiral_out


@dataclass(frozen=True, slots=True)
class Hill:
    """A straight that climbs with *grade*, passes a crest and falls as it climbed.

    Parabolas of the radius *crest* at the top and *sag* at both feet, in m, are joined by slopes of the length *slope*.
    """

    grade: float
    crest: float
    sag: float
    slope: float

    @property
    def length(self) -> float:
        """All of it, in m along the plane."""
        return 2 * (self.sag + self.crest) * abs(self.grade) + 2 * self.slope


@dataclass(frozen=True, slots=True)
class Lights:
    """Two-phase lights: *main* s of green for the way the road goes straight on, *side* s for the one that crosses.

    *yellow* s follow each green, then *clearing* s of red for all; *shift* s on, the first green begins.
    """

    main: float
    side: float
    yellow: float
    clearing: float
    shift: float


@dataclass(frozen=True, slots=True)
class Intersection:
    """Roads that meet at right angles: those of *sides* ("left", "right", "straight"), and the one that comes in.

    *exit* is where the next segment goes on. The others are *arm* m long; those at the side have *lanes*. From the
    border of one road it is *corner* m to where the lanes of the other one end.
    """

    sides: tuple[str, ...]
    exit: str
    lanes: Lanes
    corner: float
    arm: float
    lights: Lights | None


@dataclass(frozen=True, slots=True)
class Roundabout:
    """A ring with one lane whose middle has the *radius* in m; *sides*, *exit* and *arm* as of an intersection."""

    radius: float
    sides: tuple[str, ...]
    exit: str
    arm: float


Shape = Straight | Curve | Hill | Intersection | Roundabout


@dataclass(frozen=True, slots=True)
class Rise:
    """How a segment's height changes.

    Either to *grade*, rounded at its start with the radius *rounding* in m (0: it has the grade from its start on), or
    by the polynomial of *height*: factors of s, s² and s³, with s in m from its start.
    """

    grade: float = 0.0
    rounding: float = 0.0
    height: tuple[float, float, float] | None = None


@dataclass(frozen=True, slots=True)
class Segment:
    """A part of a road and what changes where it begins: its *lanes* within *widening* m, its *speed_limit* in m/s.

    *speed_limit* is 0 where there is none. *rise* None keeps the grade.
    """

    shape: Shape
    lanes: Lanes
    widening: float
    speed_limit: float
    rise: Rise | None
    slippery: tuple[Slippery, ...]
    where: Location


@dataclass(frozen=True, slots=True)
class Road:
    """Segments end to end, from (0, 0) on along the x-axis; where it is *closed* the last one leads to the first."""

    name: str
    title: str
    closed: bool
    segments: tuple[Segment, ...]
    where: Location
