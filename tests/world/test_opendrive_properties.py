from __future__ import annotations

import math
import tempfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, strategies as st
from opendrive_texts import geometry, lane, network, road, section

from dse.world import Route, lane_middle, place, road_tables, value
from dse.world.opendrive.curves import curve_of
from dse.world.opendrive.structure import Geometry, Spiral
from dse.world.pieces import backwards

CURVATURES = st.floats(-0.08, 0.08)
CHAINS = st.lists(st.tuples(st.floats(0.5, 90.0), CURVATURES, CURVATURES), min_size=1, max_size=6)
Chain = list[tuple[float, float, float]]


def _road(chain: Chain) -> str:
    """Curves one after the other, each where the one before ends."""
    s, x, y, heading, pieces = 0.0, 3.0, -4.0, 0.5, ""
    for length, start, end in chain:
        shape = (
            f'<spiral curvStart="{start!r}" curvEnd="{end!r}"/>' if start != end else f'<arc curvature="{start!r}"/>'
        )
        pieces += geometry(s, x, y, heading, length, shape)
        # Any value will do for what a test of continuity begins with, but the one that is read.
        curve = Geometry(s, x, y, heading, length, Spiral(start, end), None)  # type: ignore[arg-type]
        frames = curve_of(curve).at(np.array([length]))
        s, x, y = s + length, x + float(frames.x[0]), y + float(frames.y[0])
        heading += (start + end) / 2 * length
    return road("1", pieces, s, section(0.0, lane(1), lane(-1)))


@pytest.mark.thorough
@given(CHAINS)
def test_a_chain_of_curves_is_continuous_and_its_lanes_are_as_long_as_its_pieces(chain: Chain) -> None:
    with tempfile.TemporaryDirectory() as folder:
        along, against = road_tables(network(Path(folder), _road(chain)), [Route((), -1), Route((), 1)]).paths
    assert math.isclose(along.length, sum(length for length, _, _ in chain), abs_tol=1e-9)
    joints = along.x.starts[1:]
    before, after = place(along, np.nextafter(joints, 0.0)), place(along, joints)
    assert np.all(np.hypot(before.x - after.x, before.y - after.y) <= 1e-7)
    assert np.all(np.abs(np.remainder(before.heading - after.heading + 1.0, math.tau) - 1.0) <= 1e-7)
    # One who drives the other way passes the same points.
    stations = np.linspace(0.0, along.length, 50)
    there, back = place(along, stations), place(against, along.length - stations)
    assert np.allclose(there.x, back.x, atol=2e-7)
    assert np.allclose(there.y, back.y, atol=2e-7)
    assert np.allclose(lane_middle(along, stations), -1.75)
    assert np.allclose(lane_middle(against, stations), -1.75)


@given(CHAINS)
def test_turned_round_twice_a_line_is_what_it_was(chain: Chain) -> None:
    with tempfile.TemporaryDirectory() as folder:
        (path,) = road_tables(network(Path(folder), _road(chain)), [Route((), -1)]).paths
    again = backwards(backwards(path.x, path.length), path.length)
    stations = np.linspace(0.0, path.length, 50)
    assert np.allclose(again.starts, path.x.starts, atol=1e-10)
    assert np.allclose(value(again, stations), value(path.x, stations), atol=1e-9)
