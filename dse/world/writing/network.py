"""A network as OpenDRIVE has it: what is written, element for element, in SI."""

from __future__ import annotations

from dataclasses import dataclass

from dse.world.writing.pieces import Piece


@dataclass(frozen=True, slots=True)
class CubicRecord:
    """From *start* on a + b ds + c ds² + d ds³."""

    start: float
    a: float = 0.0
    b: float = 0.0
    c: float = 0.0
    d: float = 0.0


def ramp(start: float, length: float, first: float, last: float) -> CubicRecord:
    """From *first* to *last*, level at both ends."""
    change = last - first
    return CubicRecord(
        start, first, 0.0, 3 * change / length**2 if change else 0.0, -2 * change / length**3 if change else 0.0
    )


@dataclass(frozen=True, slots=True)
class Link:
    """To the *contact*, "start" or "end", of the road *id*; "" if that is a junction's."""

    id: int
    contact: str


@dataclass(frozen=True, slots=True)
class LaneRecord:
    """A lane by its *number*, > 0 left of the reference line; *mark* is its outer line.

    *before* and *behind* are the lanes it goes on as, 0 for none. *frictions* hold from an offset in the section on.
    """

    number: int
    width: CubicRecord
    mark: str
    before: int
    behind: int
    frictions: tuple[tuple[float, float], ...] = ()


@dataclass(frozen=True, slots=True)
class LaneSection:
    """The lanes from *start* on, those on the left first; *mark* is the line in the middle."""

    start: float
    mark: str
    lanes: tuple[LaneRecord, ...]


@dataclass(frozen=True, slots=True)
class PatchRecord:
    """A part of a road with a friction of its own: from *right* to *left*, in m to the left of the reference line."""

    start: float
    end: float
    right: float
    left: float
    friction: float


@dataclass(frozen=True, slots=True)
class SignalRecord:
    """A traffic light beside the road, for who comes in its direction ("+") or against it ("-")."""

    id: int
    station: float
    offset: float
    orientation: str


@dataclass(frozen=True, slots=True)
class RoadRecord:
    """One road, which is *within* a junction or none (0)."""

    id: int
    name: str
    pieces: tuple[Piece, ...]
    length: float
    heights: tuple[CubicRecord, ...]
    sections: tuple[LaneSection, ...]
    speeds: tuple[tuple[float, float], ...]
    within: int = 0
    banks: tuple[CubicRecord, ...] = ()
    offset: CubicRecord | None = None
    before: Link | None = None
    behind: Link | None = None
    patches: tuple[PatchRecord, ...] = ()
    signals: tuple[SignalRecord, ...] = ()


@dataclass(frozen=True, slots=True)
class ConnectionRecord:
    """From *lane* of the *incoming* road the *connecting* one goes on, whose lane is -1."""

    incoming: int
    connecting: int
    lane: int


@dataclass(frozen=True, slots=True)
class LightGroup:
    """*signals* that show the same: *phases* are colours and for how many s each, the first from *shift* s on."""

    signals: tuple[int, ...]
    phases: tuple[tuple[str, float], ...]
    shift: float


@dataclass(frozen=True, slots=True)
class JunctionRecord:
    """Where roads meet, with its lights; *priorities* are pairs of roads in it of which the first goes before."""

    id: int
    name: str
    connections: tuple[ConnectionRecord, ...]
    priorities: tuple[tuple[int, int], ...] = ()
    lights: tuple[LightGroup, ...] = ()


@dataclass(frozen=True, slots=True)
class NetworkRecord:
    """All of a file; *route* are the roads along its segments, where one lane leads there."""

    name: str
    roads: tuple[RoadRecord, ...]
    junctions: tuple[JunctionRecord, ...]
    route: tuple[int, ...] = ()
