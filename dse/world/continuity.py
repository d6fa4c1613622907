"""Whether a path goes on where roads meet."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from dse.errors import Location, Problem
from dse.world.evaluation import place
from dse.world.pieces import value
from dse.world.tables import RoadPath

STEP = 0.1
"""How far apart the middles of lanes may be where they go on in each other, in m, along, across and up."""
BEND = 0.1
"""How much a lane may turn there, in rad."""


def broken(path: RoadPath, joints: Sequence[float], where: Sequence[Location]) -> Iterator[Problem]:
    """Jumps of the path's own lane at *joints*, its stations where roads meet; *where* are the roads that follow."""
    stations = np.array([*joints, path.length] if path.closed else joints)
    if not len(stations):
        return
    own = path.lanes[0]
    before, after = np.nextafter(stations, 0.0), np.where(stations >= path.length, 0.0, stations)
    ends, begins = (place(path, s, (value(own.left, s) + value(own.right, s)) / 2) for s in (before, after))
    for i in range(len(stations)):
        there = where[(i + 1) % len(where)]
        off = math.dist((ends.x[i], ends.y[i], ends.z[i]), (begins.x[i], begins.y[i], begins.z[i]))
        bend = math.remainder(begins.heading[i] - ends.heading[i], math.tau)
        if not off <= STEP:
            yield Problem(f"the lane of the path continues {off:.3g} m off in this road", there)
        elif not abs(bend) <= BEND:
            yield Problem(f"the lane of the path continues with a kink of {bend:.3g} rad in this road", there)
