"""What a segment of a road can be."""

from __future__ import annotations

import math

from dse.domain.road import Curve, Hill, Intersection, Lanes, Lights, Roundabout, Shape, Straight
from dse.errors import fail
from dse.formats import Entry
from dse.loading.road.quantities import MOST, STEEPEST, length_of, require_word, within
from dse.loading.sections import Plain, Section


class LanesSection(Section):
    """Lanes with the road, and against it."""

    forward: int = 1
    backward: int = 1
    width: Plain = "3.5 m"


class CurveSection(Section):
    """An arc between spirals."""

    radius: Plain
    angle: Plain
    direction: str = "left"
    spiral: Plain | list[Plain] = 0
    bank: Plain = 0


class HillSection(Section):
    """Up over a crest and down again."""

    grade: Plain
    radius: Plain
    sag: Plain | None = None
    slope: Plain = 0


class LightsSection(Section):
    """Traffic lights in two phases."""

    cycle: Plain
    main: Plain | None = None
    yellow: Plain = "3 s"
    clearing: Plain = "2 s"
    shift: Plain = 0


class CrossingSection(Section):
    """What intersections and roundabouts share."""

    arms: int = 4
    side: str | None = None
    exit: str | None = None
    arm: Plain = "100 m"


class IntersectionSection(CrossingSection):
    """Roads that meet at right angles."""

    lanes: int | LanesSection | None = None
    corner: Plain = "8 m"
    lights: LightsSection | None = None


class RoundaboutSection(CrossingSection):
    """A ring with one lane."""

    radius: Plain


SHAPES = ("straight", "curve", "hill", "intersection", "roundabout")
"""The keys of a segment that say what it is."""

_MOST_LANES = 8
_LEAST_RADIUS = 2.0


def shape_of(entry: Entry, written: object, lanes: Lanes) -> Shape:
    """What is *written* at *entry*, on a road with *lanes*. Raises DseError."""
    match written:
        case CurveSection():
            return _curve(entry, written)
        case HillSection():
            return _hill(entry, written)
        case IntersectionSection():
            return _intersection(entry, written, lanes)
        case RoundaboutSection():
            return _roundabout(entry, written, lanes)
        case str() | int() | float():
            return Straight(length_of(written, entry))
    raise AssertionError(written)


def lanes_of(written: int | LanesSection, entry: Entry) -> Lanes:
    """Lanes: so many each way, or as a mapping says. Raises DseError."""
    section = LanesSection(forward=written, backward=written) if isinstance(written, int) else written
    for word, count, least in (("forward", section.forward, 1), ("backward", section.backward, 0)):
        if not least <= count <= _MOST_LANES:
            raise fail(f"{count} lanes {word}", entry[word].where, f"from {least} to {_MOST_LANES}")
    return Lanes(section.forward, section.backward, within(section.width, "m", entry["width"], 1.0, 20.0))


def _curve(entry: Entry, section: CurveSection) -> Curve:
    angle = within(section.angle, "deg", entry["angle"], 1e-4, 8 * math.pi)
    require_word(section.direction, ("left", "right"), entry["direction"])
    spirals = section.spiral if isinstance(section.spiral, list) else [section.spiral, section.spiral]
    if len(spirals) != 2:
        raise fail("'spiral' has two lengths, before and behind the arc", entry["spiral"].where, "[60 m, 40 m]")
    radius = within(section.radius, "m", entry["radius"], _LEAST_RADIUS, MOST)
    into, out = (within(raw, "m", entry["spiral"], 0.0, MOST) for raw in spirals)
    bank = within(section.bank, "", entry["bank"], -0.5, 0.5)
    curve = Curve(radius, angle if section.direction == "left" else -angle, into, out, bank)
    if curve.arc < 0:
        what = f"spirals of {into:g} m and {out:g} m turn by more than the angle"
        hint = f"at most {radius * angle:.3f} m each, in the mean, at this radius and angle"
        raise fail(what, entry["spiral"].where, hint)
    if bank and not (into and out):
        what = "a curve with a bank needs spirals, along which the road tilts"
        raise fail(what, entry["bank"].where, "add 'spiral: 60 m'")
    return curve


def _hill(entry: Entry, section: HillSection) -> Hill:
    grade = within(section.grade, "", entry["grade"], -STEEPEST, STEEPEST)
    if abs(grade) < 1e-4:
        raise fail("a hill without a grade is a straight", entry["grade"].where, "grade: 5 %")
    crest = within(section.radius, "m", entry["radius"], 10.0, MOST)
    sag = crest if section.sag is None else within(section.sag, "m", entry["sag"], 10.0, MOST)
    return Hill(grade, crest, sag, within(section.slope, "m", entry["slope"], 0.0, MOST))


def _sides(entry: Entry, section: CrossingSection) -> tuple[tuple[str, ...], str]:
    """Where roads lead from a crossing, and which of them the next segment is on."""
    if section.arms not in (3, 4):
        raise fail(f"{section.arms} arms are not supported", entry["arms"].where, "3 or 4, with the one that comes in")
    sides: tuple[str, ...] = ("straight", "left", "right")
    if section.arms == 3:
        side = section.side or "right"
        require_word(side, ("left", "right", "both"), entry["side"])
        sides = ("left", "right") if side == "both" else ("straight", side)
    elif section.side is not None:
        raise fail("with four arms there is one at each side", entry["side"].key, "remove 'side', or write 'arms: 3'")
    leads = section.exit or sides[0]
    require_word(leads, sides, entry["exit"])
    return sides, leads


def _intersection(entry: Entry, section: IntersectionSection, lanes: Lanes) -> Intersection:
    sides, leads = _sides(entry, section)
    across = lanes if section.lanes is None else lanes_of(section.lanes, entry["lanes"])
    corner = within(section.corner, "m", entry["corner"], 1.0, 100.0)
    lights = None if section.lights is None else _lights(entry["lights"], section.lights)
    return Intersection(sides, leads, across, corner, length_of(section.arm, entry["arm"]), lights)


def _lights(entry: Entry, section: LightsSection) -> Lights:
    cycle, yellow, clearing = (
        within(raw, "s", entry[word], 0.0, 3600.0)
        for word, raw in (("cycle", section.cycle), ("yellow", section.yellow), ("clearing", section.clearing))
    )
    green = cycle - 2 * (yellow + clearing)
    if green <= 0:
        hint = f"more than {2 * (yellow + clearing):g} s: yellow and clearing come twice"
        raise fail("no time is left for green", entry["cycle"].where, hint)
    main = green / 2 if section.main is None else within(section.main, "s", entry["main"], 0.0, 3600.0)
    if not 0 < main < green:
        raise fail("both ways need a time for green", entry["main"].where, f"more than 0 s, less than {green:g} s")
    return Lights(main, green - main, yellow, clearing, within(section.shift, "s", entry["shift"], -3600.0, 3600.0))


def _roundabout(entry: Entry, section: RoundaboutSection, lanes: Lanes) -> Roundabout:
    if (lanes.forward, lanes.backward) != (1, 1):
        what = "a roundabout joins roads with one lane each way"
        raise fail(what, entry.key, f"here are {lanes.forward} forward and {lanes.backward} backward")
    radius = within(section.radius, "m", entry["radius"], 3 * lanes.width, 200.0)
    sides, leads = _sides(entry, section)
    return Roundabout(radius, sides, leads, length_of(section.arm, entry["arm"]))
