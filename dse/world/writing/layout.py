"""Segments → a network of roads and junctions."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import groupby

from dse.domain.road import Intersection, Lanes, Lights, Road, Roundabout, Segment, Straight
from dse.errors import fail
from dse.world.writing.crossing import COMING, Arm, Ring, arms_of, ways
from dse.world.writing.network import (
    ConnectionRecord,
    CubicRecord,
    JunctionRecord,
    LaneRecord,
    LaneSection,
    LightGroup,
    Link,
    NetworkRecord,
    RoadRecord,
    SignalRecord,
    ramp,
)
from dse.world.writing.pieces import Bend, Piece, Pose, laid
from dse.world.writing.stretch import Place, stretch

_MET = 1e-6
"""How far apart, in m and rad, the ends of a closed road may be."""


def network_of(road: Road) -> NetworkRecord:
    """The roads and junctions of *road*. Raises DseError if it is closed and its ends do not meet."""
    made = _Made(road.name)
    place, lanes, number = Place(Pose(0.0, 0.0, 0.0)), road.segments[0].lanes, made.new()
    for is_crossing, run in groupby(road.segments, lambda each: isinstance(each.shape, Intersection | Roundabout)):
        segments = tuple(run)
        if not is_crossing:
            place = made.stretch(number, segments, place, lanes)
            lanes = segments[-1].lanes
            continue
        for crossing in segments:  # one: two of them have a stretch between
            arm, number = made.crossing(crossing, number, place, is_last=crossing is road.segments[-1])
            place, lanes = Place(arm.pose, place.height), arm.lanes
    if road.closed:
        made.close(number, road, place)
    return made.network()


class _Made:
    """What there is of a network so far."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._last = 0
        self._roads: dict[int, RoadRecord] = {}
        self._junctions: list[JunctionRecord] = []
        self._before: dict[int, Link] = {}
        self._behind: dict[int, Link] = {}
        self._signals: dict[int, tuple[SignalRecord, ...]] = {}
        # Of each crossing: by the lane in which one comes, the lane in which one leaves, and the roads there.
        self._passed: list[dict[int, tuple[int, tuple[int, ...]]]] = []

    def new(self) -> int:
        """A number that nothing has."""
        self._last += 1
        return self._last

    def network(self) -> NetworkRecord:
        """All of it, with its links."""
        roads = (
            replace(
                road,
                before=self._before.get(number),
                behind=self._behind.get(number),
                signals=self._signals.get(number, ()),
            )
            for number, road in self._roads.items()
        )
        return NetworkRecord(self._name, tuple(roads), tuple(self._junctions), self._along())

    def _along(self) -> tuple[int, ...]:
        """The roads along the segments, if there are crossings and a lane leads through all of them: the outermost."""
        first, *_ = self._roads.values()
        for start in range(-min(lane.number for section in first.sections for lane in section.lanes), 0, -1):
            found, lane = [first.id], start
            for passed in self._passed:
                if lane not in passed:
                    break
                lane, roads = passed[lane]
                found += roads
            else:
                return tuple(found) if self._passed else ()
        return ()

    def stretch(self, number: int, segments: Sequence[Segment], place: Place, before: Lanes) -> Place:
        """Add the road *number* of *segments*; where it ends."""
        self._roads[number], end = stretch(number, f"{self._name}_{number}", segments, place, before)
        return end

    def close(self, number: int, road: Road, end: Place) -> None:
        """Have the only road lead to itself. Raises DseError if it does not, by how much."""
        first, last = road.segments[0], road.segments[-1]
        turns = math.remainder(end.pose.heading, 2 * math.pi)
        apart = max(math.hypot(end.pose.x, end.pose.y), abs(turns), abs(end.height))
        if apart > _MET:
            what = (
                f"the road is not closed: it ends {end.pose.x:.6g} m before its start, {end.pose.y:.6g} m to the left,"
                f" {end.height:.6g} m higher, turned by {math.degrees(turns):.6g} deg"
            )
            raise fail(
                what, last.where, "the angles of its curves, with their signs, sum to 360 deg; or remove 'closed'"
            )
        if first.lanes != last.lanes:
            what = (
                f"a closed road ends with the lanes it begins with, not {last.lanes.forward} and {last.lanes.backward}"
            )
            raise fail(what, last.where, "change them back with 'lanes' and 'widening'")
        self._before[number], self._behind[number] = Link(number, "end"), Link(number, "start")
        made = self._roads[number]
        if abs(end.grade - made.heights[0].b) > _MET:
            what = f"a closed road ends with the grade it begins with, not {end.grade:.2%}"
            raise fail(what, last.where, "end it with 'grade: 0'")
        head, *rest = made.sections
        head = replace(head, lanes=tuple(replace(lane, before=lane.number) for lane in head.lanes))
        *rest, tail = (head, *rest)
        tail = replace(tail, lanes=tuple(replace(lane, behind=lane.number) for lane in tail.lanes))
        self._roads[number] = replace(made, sections=(*rest, tail))

    def crossing(self, segment: Segment, comes: int, place: Place, *, is_last: bool) -> tuple[Arm, int]:
        """Add a crossing at the end of the road *comes*; the arm that the next segment is on, and its road's number."""
        shape = segment.shape
        assert isinstance(shape, Intersection | Roundabout)  # noqa: S101  # the caller asked
        arms = arms_of(shape, segment.lanes, place.pose)
        ids = {side: comes if side == COMING else self.new() for side in arms}
        for side, arm in arms.items():
            if side != COMING and (side != shape.exit or is_last):
                end = replace(segment, shape=Straight(shape.arm), lanes=arm.lanes)
                self.stretch(ids[side], [end], Place(arm.pose, place.height), arm.lanes)
        if isinstance(shape, Intersection):
            self._intersection(shape, segment, arms, ids, place.height)
        else:
            self._roundabout(shape, segment, arms, ids, place.height)
        return arms[shape.exit], ids[shape.exit]

    def _intersection(
        self, shape: Intersection, segment: Segment, arms: Mapping[str, Arm], ids: Mapping[str, int], height: float
    ) -> None:
        junction = self.new()
        connections = []
        passed: dict[int, tuple[int, tuple[int, ...]]] = {}
        for way in ways(arms):
            number = self.new()
            coming, leaving = (arm.lane(lane) for arm, lane in ((way.start, -way.first), (way.end, way.last)))
            pieces, _ = laid(way.start.into(way.first), way.bends)
            widths = way.start.lanes.width, way.end.lanes.width
            name = f"{way.start.side}_{way.end.side}"
            self._roads[number] = _single(
                number, name, pieces, widths, height, segment.speed_limit, junction, (coming, leaving)
            )
            self._before[number] = _end(way.start, ids)
            self._behind[number] = _end(way.end, ids)
            connections.append(ConnectionRecord(ids[way.start.side], number, coming))
            if (way.start.side, way.end.side) == (COMING, shape.exit):
                passed[way.first] = (way.last, (number, ids[shape.exit]))
        self._passed.append(passed)
        for side, arm in arms.items():
            self._attach(arm, ids[side], junction)
        lights = () if shape.lights is None else tuple(self._lights(shape.lights, arms, ids))
        self._junctions.append(JunctionRecord(junction, f"intersection_{junction}", tuple(connections), lights=lights))

    def _attach(self, arm: Arm, road: int, junction: int) -> None:
        (self._behind if arm.side == COMING else self._before)[road] = Link(junction, "")

    def _lights(self, lights: Lights, arms: Mapping[str, Arm], ids: Mapping[str, int]) -> Iterator[LightGroup]:
        """Put up lights at all arms; those that show the same together."""
        yellow, clearing = lights.yellow, lights.clearing
        main = (("green", lights.main), ("yellow", yellow), ("red", clearing + lights.side + yellow + clearing))
        side = (
            ("red", lights.main + yellow + clearing),
            ("green", lights.side),
            ("yellow", yellow),
            ("red", clearing),
        )
        for phases, sides in ((main, (COMING, "straight")), (side, ("left", "right"))):
            signals = []
            for arm in (arms[name] for name in sides if name in arms):
                if arm.coming:
                    signals.append(self.new())
                    beside = arm.coming * arm.lanes.width + 1.0
                    inward = arm.side == COMING
                    station, offset = (self._roads[ids[arm.side]].length, -beside) if inward else (0.0, beside)
                    signal = SignalRecord(signals[-1], station, offset, "+" if inward else "-")
                    self._signals[ids[arm.side]] = (*self._signals.get(ids[arm.side], ()), signal)
            if signals:
                shown = tuple((colour, seconds) for colour, seconds in phases if seconds)
                yield LightGroup(tuple(signals), shown, lights.shift)

    def _roundabout(
        self, shape: Roundabout, segment: Segment, arms: Mapping[str, Arm], ids: Mapping[str, int], height: float
    ) -> None:
        width, limit = segment.lanes.width, segment.speed_limit
        ring = Ring.of(shape, width)
        first = arms[COMING].pose
        centre = first.moved(-ring.reach)
        around = sorted(arms.values(), key=lambda arm: _angle(centre, arm))
        junctions = {arm.side: self.new() for arm in around}
        parts = {arm.side: self.new() for arm in around}  # of the ring, each behind its arm

        def single(name: str, start: Pose, bends: Sequence[Bend], within: int, lanes: tuple[int, int]) -> int:
            number = parts[name] if name in parts else self.new()
            pieces, _ = laid(start, bends)
            self._roads[number] = _single(number, f"ring_{name}", pieces, (width, width), height, limit, within, lanes)
            return number

        # The ways onto the ring, past an arm and off the ring, by the arm.
        onto, past, off = dict[str, int](), dict[str, int](), dict[str, int]()
        for before, arm, behind in zip((around[-1], *around), around, (*around[1:], around[0]), strict=False):
            side, angle, junction = arm.side, _angle(centre, arm), junctions[arm.side]
            apart = math.remainder(_angle(centre, behind) - angle, 2 * math.pi) % (2 * math.pi)
            part = single(side, ring.at(centre, angle + ring.angle), [ring.along(apart - 2 * ring.angle)], 0, (0, 0))
            self._before[part], self._behind[part] = Link(junction, ""), Link(junctions[behind.side], "")
            came, goes, on = Link(parts[before.side], "end"), _end(arm, ids), Link(part, "start")
            leaves = ring.at(centre, angle - ring.angle)
            into, out = arm.lane(-1), arm.lane(1)
            past[side] = single(f"past_{side}", leaves, [ring.along(2 * ring.angle)], junction, (-1, -1))
            off[side] = single(f"to_{side}", leaves, ring.off, junction, (-1, out))
            onto[side] = single(f"from_{side}", arm.into(1), ring.bends, junction, (into, -1))
            for number, start, end in ((past[side], came, on), (off[side], came, goes), (onto[side], goes, on)):
                self._before[number], self._behind[number] = start, end
            self._attach(arm, ids[side], junction)
            connections = (
                ConnectionRecord(came.id, past[side], -1),
                ConnectionRecord(came.id, off[side], -1),
                ConnectionRecord(ids[side], onto[side], into),
            )
            before_entering = ((past[side], onto[side]),)
            self._junctions.append(
                JunctionRecord(junction, f"roundabout_{side}_{junction}", connections, before_entering)
            )
        sides = [arm.side for arm in around]
        comes = sides.index(COMING)
        passed = [*sides[comes + 1 :], *sides[:comes]]
        driven = [onto[COMING], parts[COMING]]
        for side in passed[: passed.index(shape.exit)]:
            driven += [past[side], parts[side]]
        self._passed.append({1: (1, (*driven, off[shape.exit], ids[shape.exit]))})


def _angle(centre: Pose, arm: Arm) -> float:
    """Where the arm is, seen from the *centre*: from -pi on, to the left."""
    seen = centre.seen(arm.pose)
    return math.atan2(seen.y, seen.x)


def _end(arm: Arm, ids: Mapping[str, int]) -> Link:
    return Link(ids[arm.side], "end" if arm.side == COMING else "start")


def _single(
    number: int,
    name: str,
    pieces: Sequence[Piece],
    widths: tuple[float, float],
    height: float,
    limit: float,
    within: int,
    lanes: tuple[int, int],
) -> RoadRecord:
    """A road of one lane whose middle *pieces* are; *lanes* are those it comes from and leads to."""
    length = sum(piece.bend.length for piece in pieces)
    width = ramp(0.0, length, *widths)
    lane = LaneRecord(-1, width, "none" if within else "solid", *lanes)
    offset = CubicRecord(0.0, width.a / 2, 0.0, width.c / 2, width.d / 2)
    sections = (LaneSection(0.0, lane.mark, (lane,)),)
    heights, speeds = (CubicRecord(0.0, height),), ((0.0, limit),)
    return RoadRecord(number, name, tuple(pieces), length, heights, sections, speeds, within=within, offset=offset)
