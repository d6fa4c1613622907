"""Segments between two crossings as one road: geometry, height, bank, lanes, friction."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

from dse.domain.road import Curve, Hill, Intersection, Lanes, Rise, Roundabout, Segment, Slippery, Straight
from dse.world.writing.network import CubicRecord, LaneRecord, LaneSection, PatchRecord, RoadRecord, ramp
from dse.world.writing.pieces import Bend, Piece, Pose, laid


@dataclass(frozen=True, slots=True)
class Place:
    """Where a road has come to: a pose, a height in m, a grade."""

    pose: Pose
    height: float = 0.0
    grade: float = 0.0


def stretch(
    number: int, name: str, segments: Sequence[Segment], start: Place, before: Lanes
) -> tuple[RoadRecord, Place]:
    """The road *number* of *segments* without crossings, of which the first follows lanes *before*; and its end."""
    station, place = 0.0, start
    pieces: list[Piece] = []
    speeds: list[tuple[float, float]] = []
    heights: list[CubicRecord] = []
    banks, patches, changes, whole = [CubicRecord(0.0)], [], [(0.0, before, before)], []
    lanes = before
    for segment in segments:
        made, pose = laid(place.pose, bends(segment))
        pieces = _joined_lines([*pieces, *made])
        length = sum(piece.bend.length for piece in made)
        risen = list(_rise(segment, length, place))
        for cubic in risen:
            if not _is_straight(cubic, heights):
                heights.append(replace(cubic, start=station + cubic.start))
        place = Place(pose, *_end(risen[-1], length))
        banks += [replace(cubic, start=station + cubic.start) for cubic in _banks(segment)]
        if not speeds or speeds[-1][1] != segment.speed_limit:
            speeds.append((station, segment.speed_limit))
        if segment.lanes != lanes:
            changes += [(station, lanes, segment.lanes), (station + segment.widening, segment.lanes, segment.lanes)]
            lanes = segment.lanes
        moved = [replace(patch, start=station + patch.start, end=station + patch.end) for patch in segment.slippery]
        whole += [patch for patch in moved if patch.right is None]
        patches += [
            PatchRecord(p.start, p.end, p.right, p.left, p.friction)
            for p in moved
            if p.right is not None and p.left is not None
        ]
        station += length
    made_sections = tuple(_sections(changes, station, whole))
    tilts = tuple(banks) if len(banks) > 1 else ()
    road = RoadRecord(
        number,
        name,
        tuple(pieces),
        station,
        tuple(heights),
        made_sections,
        tuple(speeds),
        banks=tilts,
        patches=tuple(patches),
    )
    return road, place


def _is_straight(cubic: CubicRecord, before: Sequence[CubicRecord]) -> bool:
    """Whether the height rises as straight as it did *before*."""
    return bool(before) and (before[-1].b, before[-1].c, before[-1].d) == (cubic.b, cubic.c, cubic.d) == (cubic.b, 0, 0)


def _joined_lines(pieces: Sequence[Piece]) -> list[Piece]:
    """The *pieces*, of which lines that follow each other are one."""
    found: list[Piece] = []
    for piece in pieces:
        if found and not any((found[-1].bend.first, found[-1].bend.last, piece.bend.first, piece.bend.last)):
            whole = Bend(found[-1].bend.length + piece.bend.length)
            found[-1] = replace(found[-1], bend=whole)
        else:
            found.append(piece)
    return found


def bends(segment: Segment) -> tuple[Bend, ...]:
    """What the segment is in the plane."""
    match segment.shape:
        case Straight(length):
            return (Bend(length),)
        case Hill():
            return (Bend(segment.shape.length),)
        case Curve() as curve:
            curvature = math.copysign(1 / curve.radius, curve.angle)
            return (
                Bend(curve.spiral_in, 0.0, curvature),
                Bend(curve.arc, curvature, curvature),
                Bend(curve.spiral_out, curvature, 0.0),
            )
        case Intersection() | Roundabout():
            raise AssertionError(segment)


def _rise(segment: Segment, length: float, place: Place) -> Iterator[CubicRecord]:
    """The height along the segment, from 0."""
    if isinstance(segment.shape, Hill):
        yield from _joined(_over(segment.shape), place)
        return
    match segment.rise:
        case Rise(height=(first, second, third)):
            yield CubicRecord(0.0, place.height, first, second, third)
        case Rise(grade, 0.0):
            yield CubicRecord(0.0, place.height, grade)
        case Rise(grade, rounding) if abs(grade - place.grade) > 1e-12:
            over = rounding * abs(grade - place.grade)
            parts = [(over, (grade - place.grade) / over)]
            yield from _joined([*parts, (length - over, 0.0)] if over < length else parts, place)
        case _:
            yield CubicRecord(0.0, place.height, place.grade)


def _over(hill: Hill) -> list[tuple[float, float]]:
    """Lengths, and the curvature of the profile along each."""
    sign, steep = math.copysign(1, hill.grade), abs(hill.grade)
    foot, top = (hill.sag * steep, sign / hill.sag), (hill.crest * steep, -sign / hill.crest)
    slope = (hill.slope, 0.0)
    return [part for part in (foot, slope, top, top, slope, foot) if part[0] > 0]


def _joined(parts: Iterable[tuple[float, float]], place: Place) -> Iterator[CubicRecord]:
    station, height, grade = 0.0, place.height, place.grade
    for length, curvature in parts:
        cubic = CubicRecord(station, height, grade, curvature / 2)
        yield cubic
        station += length
        height, grade = _end(cubic, station)


def _end(cubic: CubicRecord, station: float) -> tuple[float, float]:
    """Value and slope at *station*."""
    ds = station - cubic.start
    value = cubic.a + ds * (cubic.b + ds * (cubic.c + ds * cubic.d))
    slope = cubic.b + ds * (2 * cubic.c + 3 * ds * cubic.d)
    return value, 0.0 if abs(slope) < 1e-12 else slope


def _banks(segment: Segment) -> Iterator[CubicRecord]:
    """The tilt to the right, in rad, along the segment, where there is one."""
    match segment.shape:
        case Curve(bank=bank) as curve if bank:
            tilt = -math.copysign(math.atan(bank), curve.angle)
            yield ramp(0.0, curve.spiral_in, 0.0, tilt)
            yield CubicRecord(curve.spiral_in, tilt)
            yield ramp(curve.spiral_in + curve.arc, curve.spiral_out, tilt, 0.0)
            yield CubicRecord(curve.length)


def _sections(
    changes: Sequence[tuple[float, Lanes, Lanes]], length: float, whole: Sequence[Slippery]
) -> Iterator[LaneSection]:
    ends = [start for start, _, _ in changes[1:]] + [length]
    kept = [(*change, end) for change, end in zip(changes, ends, strict=True) if end - change[0] > 1e-9]
    for number, (start, first, last, end) in enumerate(kept):
        inner = (number > 0, number < len(kept) - 1)
        frictions = tuple(_frictions(whole, start, end))
        yield section(start, end - start, first, last, inner, frictions)


def section(
    start: float,
    length: float,
    first: Lanes,
    last: Lanes,
    inner: tuple[bool, bool],
    frictions: tuple[tuple[float, float], ...] = (),
) -> LaneSection:
    """Lanes that change from *first* to *last*; *inner* says whether a section comes before, and one behind."""
    made = []
    for sign, one, other in ((1, first.backward, last.backward), (-1, first.forward, last.forward)):
        most = max(one, other)
        for count in range(1, most + 1):
            widths = first.width if count <= one else 0.0, last.width if count <= other else 0.0
            links = (
                sign * count if inner[0] and count <= one else 0,
                sign * count if inner[1] and count <= other else 0,
            )
            mark = "solid" if count == most else "broken"
            made.append(LaneRecord(sign * count, ramp(0.0, length, *widths), mark, *links, frictions))
    made.sort(key=lambda lane: -lane.number)
    both = {max(first.forward, last.forward), max(first.backward, last.backward)}
    return LaneSection(start, "broken" if both == {1} else "solid", tuple(made))


def _frictions(whole: Sequence[Slippery], start: float, end: float) -> Iterator[tuple[float, float]]:
    """From which offset in a section on which friction holds, where it is not that of dry asphalt all along."""
    found: dict[float, float] = {}
    for patch in sorted(whole, key=lambda patch: patch.start):
        low, high = max(patch.start, start), min(patch.end, end)
        if low < high:
            found[low - start] = patch.friction
            if high < end:
                found[high - start] = 1.0
    if found:
        yield from ({0.0: 1.0} | found).items()
