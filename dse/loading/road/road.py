"""Reads roads: segments in the user's words."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

from dse.domain.road import Curve, Hill, Intersection, Lanes, Rise, Road, Roundabout, Segment, Slippery, Straight
from dse.errors import Problems, fail, raise_if_any
from dse.formats import Entry
from dse.loading.include import read_document
from dse.loading.names import check_name
from dse.loading.road.quantities import FLAT, LEVEL, MOST, STEEPEST, pair_of, within
from dse.loading.road.shapes import (
    SHAPES,
    CurveSection,
    HillSection,
    IntersectionSection,
    LanesSection,
    RoundaboutSection,
    lanes_of,
    shape_of,
)
from dse.loading.sections import Plain, Section, read_section


class SlipperySection(Section):
    """A part of a segment with a friction of its own."""

    along: list[Plain]
    across: list[Plain] | None = None
    friction: Plain


class SegmentSection(Section):
    """One segment: exactly one of the first five keys."""

    straight: Plain | None = None
    curve: CurveSection | None = None
    hill: HillSection | None = None
    intersection: IntersectionSection | None = None
    roundabout: RoundaboutSection | None = None
    lanes: int | LanesSection | None = None
    widening: Plain | None = None
    speed_limit: Plain | None = None
    grade: Plain | None = None
    rounding: Plain | None = None
    height: list[Plain] | None = None
    friction: list[SlipperySection] = []


class RoadFile(Section):
    """``roads/*.yaml``."""

    road: str
    title: str = ""
    lanes: int | LanesSection = 1
    speed_limit: Plain | None = None
    closed: bool = False
    segments: list[SegmentSection]


@dataclass(frozen=True, slots=True)
class _Now:
    """What holds where a segment begins; *is_open* says whether a stretch of road leads there."""

    lanes: Lanes
    speed_limit: float = 0.0
    grade: float = 0.0
    is_open: bool = False
    is_first: bool = True


def read_road(path: Path, inside: Path) -> Road:
    """One file of ``roads/`` of the workspace *inside*. Raises DseError with every problem in it."""
    entry = read_document(path, inside)
    file = read_section(entry, RoadFile)
    problems = Problems()
    check_name(file.road, entry["road"].where, problems)
    now = _Now(Lanes(1, 1, 3.5))
    with problems:
        now = replace(now, lanes=lanes_of(file.lanes, entry["lanes"]))
    if file.speed_limit is not None:
        with problems:
            now = replace(now, speed_limit=_speed(file.speed_limit, entry))
    if not file.segments:
        problems.add("the road has no segments", entry["segments"].where, "segments: [{straight: 200 m}]")
    segments: list[Segment] = []
    for number, section in enumerate(file.segments):
        with problems:
            segment, now = _segment(entry["segments"][number], section, now)
            segments.append(segment)
        now = replace(now, is_first=False)
    if file.closed and any(isinstance(segment.shape, Intersection | Roundabout) for segment in segments):
        what = "a closed road has no intersections or roundabouts"
        problems.add(what, entry["closed"].where, "remove 'closed: true'")
    raise_if_any(problems)
    return Road(file.road, file.title, file.closed, tuple(segments), entry["road"].where)


def _speed(raw: Plain, entry: Entry) -> float:
    return within(raw, "m/s", entry["speed_limit"], 0.1, 200.0)


def _segment(entry: Entry, section: SegmentSection, now: _Now) -> tuple[Segment, _Now]:
    """The segment at *entry*, and what holds behind it. Raises DseError."""
    given = [word for word in SHAPES if getattr(section, word) is not None]
    if len(given) != 1:
        what = "does not define its shape" if not given else f"is {' and '.join(given)} at once"
        raise fail(f"the segment {what}", entry.where, f"give one of {', '.join(SHAPES)}")
    (kind,), before = given, now
    problems = Problems()
    if section.lanes is not None:
        with problems:
            now = replace(now, lanes=lanes_of(section.lanes, entry["lanes"]))
    if section.speed_limit is not None:
        with problems:
            now = replace(now, speed_limit=_speed(section.speed_limit, entry))
    raise_if_any(problems)
    shape = shape_of(entry[kind], getattr(section, kind), now.lanes)
    if isinstance(shape, Intersection | Roundabout):
        after = _behind_crossing(entry, section, shape, now)
        return Segment(shape, now.lanes, 0.0, now.speed_limit, None, (), entry.where), after
    widening, rise, slippery = 0.0, None, []
    with problems:
        widening = _widening(entry, section, shape.length, before, now.lanes)
    with problems:
        rise, grade = _rise(entry, section, shape, now)
        now = replace(now, grade=grade)
    for number, patch in enumerate(section.friction):
        with problems:
            slippery.append(_slippery(entry["friction"][number], patch, shape.length))
    whole = sorted((patch.start, patch.end) for patch in slippery if patch.right is None)
    if any(end > start for (_, end), (start, _) in pairwise(whole)):
        what = "patches across the whole road overlap"
        problems.add(what, entry["friction"].where, "let one end where the other begins, or set what they are 'across'")
    raise_if_any(problems)
    made = Segment(shape, now.lanes, widening, now.speed_limit, rise, tuple(slippery), entry.where)
    return made, replace(now, is_open=True)


def _behind_crossing(entry: Entry, section: SegmentSection, shape: Intersection | Roundabout, now: _Now) -> _Now:
    """What holds behind a crossing. Raises DseError for what only a stretch of road can have, or a slope before it."""
    for word in ("lanes", "widening", "grade", "rounding", "height"):
        if getattr(section, word) is not None:
            raise fail(f"'{word}' belongs to a stretch of road", entry[word].key, "write it at the segment before")
    if section.friction:
        what = "a crossing cannot have a friction"
        raise fail(what, entry["friction"].key, "write it at the segments before and behind")
    if not now.is_open:
        raise fail("a crossing needs a stretch of road that leads there", entry.where, "- straight: 100 m")
    if abs(now.grade) > FLAT:
        raise fail(f"a crossing is level, and the road comes with {now.grade:.2%}", entry.where, LEVEL)
    if isinstance(shape, Intersection) and shape.exit != "straight":
        now = replace(now, lanes=shape.lanes)
    return replace(now, is_open=False)


def _widening(entry: Entry, section: SegmentSection, length: float, before: _Now, after: Lanes) -> float:
    if section.lanes is not None and before.is_first:
        raise fail(
            "the lanes that a road begins with are defined above its segments", entry["lanes"].key, "move them there"
        )
    if before.lanes == after:
        if section.widening is not None:
            raise fail("nothing widens here: the lanes stay as they are", entry["widening"].key, "remove it")
        return 0.0
    if section.widening is None:
        raise fail("the lanes change, but not within which length", entry["lanes"].key, "add 'widening: 60 m'")
    return within(section.widening, "m", entry["widening"], 1.0, length)


_ROUNDING = "1000 m"


def _rise(
    entry: Entry, section: SegmentSection, shape: Straight | Curve | Hill, now: _Now
) -> tuple[Rise | None, float]:
    """What the segment says of its height, and the grade it ends with."""
    said = [word for word in ("grade", "height") if getattr(section, word) is not None]
    if isinstance(shape, Hill) and said:
        raise fail(f"a hill has a '{said[0]}' of its own", entry[said[0]].key, "remove it")
    if isinstance(shape, Hill) and abs(now.grade) > FLAT:
        raise fail(f"a hill begins level, and the road comes with {now.grade:.2%}", entry.where, LEVEL)
    if len(said) > 1:
        raise fail("'grade' and 'height' both define how it rises", entry["height"].key, "remove one")
    if section.rounding is not None and section.grade is None:
        raise fail("'rounding' is that of a change of 'grade'", entry["rounding"].key, "add 'grade: 3 %'")
    if section.grade is not None:
        return _graded(entry, section.grade, section.rounding, shape.length, now)
    if section.height is not None:
        return _polynomial(entry["height"], section.height, shape.length, now)
    return None, now.grade


def _graded(entry: Entry, raw: Plain, rounding: Plain | None, length: float, now: _Now) -> tuple[Rise, float]:
    grade = within(raw, "", entry["grade"], -STEEPEST, STEEPEST)
    if now.is_first and rounding is None:  # it has this grade from its start on
        return Rise(grade), grade
    radius = within(_ROUNDING if rounding is None else rounding, "m", entry["rounding"], 10.0, MOST)
    needed = radius * abs(grade - now.grade)
    if needed > length:
        what = f"from {now.grade:.2%} to {grade:.2%} a radius of {radius:g} m takes {needed:.1f} m of road"
        hint = f"the segment has {length:.1f} m: give a smaller 'rounding'"
        raise fail(what, entry["grade"].where, hint)
    return Rise(grade, radius), grade


def _polynomial(entry: Entry, written: list[Plain], length: float, now: _Now) -> tuple[Rise, float]:
    if len(written) != 3:
        raise fail("'height' has the factors of s, s² and s³", entry.where, "height: [0, 1e-4, 0]")
    first, second, third = (within(raw, "", entry[number], -1.0, 1.0) for number, raw in enumerate(written))
    if not now.is_first and abs(first - now.grade) > 1e-9:
        what = f"the road comes with a grade of {now.grade:.9g}, and continues with {first:.9g}"
        raise fail(what, entry[0].where, f"write {now.grade:.9g}: a road has no kinks")
    grade = first + 2 * second * length + 3 * third * length**2
    if max(abs(first), abs(grade)) > STEEPEST:
        raise fail(f"the grade comes to {grade:.1%}", entry.where, f"at most {STEEPEST:.0%}")
    return Rise(height=(first, second, third)), grade


def _slippery(entry: Entry, section: SlipperySection, length: float) -> Slippery:
    start, end = pair_of(section.along, entry["along"], 0.0, length, "[20 m, 40 m]")
    friction = within(section.friction, "", entry["friction"], 0.01, 2.0)
    if section.across is None:
        return Slippery(start, end, None, None, friction)
    form = "[-3.5 m, -1.75 m], from right to left"
    right, left = pair_of(section.across, entry["across"], -100.0, 100.0, form)
    return Slippery(start, end, right, left, friction)
