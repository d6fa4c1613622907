"""The lanes of a section, side by side as one who drives in one of them sees them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from dse.errors import Problem
from dse.world.in_the_way import user_bits
from dse.world.lane_graph import LanePlace
from dse.world.opendrive.checks import GAP
from dse.world.opendrive.driving import DRIVEN
from dse.world.opendrive.structure import Cubic, Lane, Road, Section
from dse.world.pieces import backwards, from_cubics, steps, total, value
from dse.world.tables import Piecewise

_SAMPLES = 33


@dataclass(frozen=True, eq=False, slots=True)
class Band:
    """Borders and friction of a lane over a section, in a direction of travel, and the bits of its users."""

    left: Piecewise
    right: Piecewise
    friction: Piecewise
    users: int


def borders_of(road: Road, section: Section) -> dict[int, tuple[Piecewise, Piecewise]]:
    """The right and left borders of all lanes, t over the distance from the start of the section, by their ids.

    Those on the left of the centre lane go outwards first, then those on its right.
    """
    centre = from_cubics(road.offsets, section.s, section.end)
    borders: dict[int, tuple[Piecewise, Piecewise]] = {}
    for sign in (1, -1):
        inner = centre
        for lane in section.lanes.values():
            if lane.id * sign > 0:
                outer = _outer(lane, inner, sign, section)
                borders[lane.id] = (inner, outer) if sign > 0 else (outer, inner)
                inner = outer
    return borders


def bands_of(road: Road, place: LanePlace, *, along: bool, every_lane: bool = False) -> dict[int, Band]:
    """The lanes for vehicles, or *every_lane*, in the section of *place*, numbered from its own to the left.

    They are seen *along* the road.
    """
    section = road.sections[place.section]
    borders = borders_of(road, section)
    ids = sorted(id_ for id_ in borders if every_lane or id_ == place.lane or section.lanes[id_].type in DRIVEN)
    own = ids.index(place.lane)
    sign = 1 if along else -1
    return {
        sign * (i - own): _seen(section, borders[id_], section.lanes[id_], along=along) for i, id_ in enumerate(ids)
    }


def overlaps(road: Road, place: LanePlace) -> Iterator[Problem]:
    """Lanes in the section of *place* whose outer border lies inside the inner one; only borders can say so."""
    section = road.sections[place.section]
    samples = np.linspace(0.0, section.end - section.s, _SAMPLES)
    for id_, (right, left) in borders_of(road, section).items():
        narrowest = float(np.min(value(left, samples) - value(right, samples)))
        if narrowest < -GAP and not section.lanes[id_].widths:
            what = f"lane {id_} is up to {-narrowest:.3g} m inside the lanes beside it"
            yield Problem(what, section.lanes[id_].where)


def _outer(lane: Lane, inner: Piecewise, sign: int, section: Section) -> Piecewise:
    # Widths go before borders; those are t of the reference line (OpenDRIVE 1.8.1, 11.6).
    cubics: tuple[Cubic, ...] = lane.widths or lane.borders
    said = from_cubics(cubics, section.s, section.end)
    return total(inner, said, sign) if lane.widths else said


def _seen(section: Section, sides: tuple[Piecewise, Piecewise], lane: Lane, *, along: bool) -> Band:
    friction, users = steps(lane.frictions, section.s, section.end, 1.0), user_bits(lane.users)
    if along:
        return Band(sides[1], sides[0], friction, users)
    length = section.end - section.s
    right, left = (backwards(side, length, -1.0) for side in sides)
    return Band(right, left, backwards(friction, length), users)
