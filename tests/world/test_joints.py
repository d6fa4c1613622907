"""Steps and kinks of real maps: refused by their size, smoothed up to a tolerance, and told."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from opendrive_texts import factors, geometry, lane, network, road, section, to_road

from dse.errors import DseError
from dse.world import Network, RoadPath, Tolerance, lane_middle, place, road_files, road_tables
from dse.world.joints import STEP

WIDE = Tolerance(1.0, 0.5)


def pieces(step: float, kink: float) -> str:
    """A road of two straight pieces, the second *step* to the left and turned by *kink*."""
    return geometry(0.0, 0.0, 0.0, 0.0, 100.0) + geometry(100.0, 100.0, step, kink, 100.0)


def two_roads(step: float, kink: float, up: float = 0.0) -> tuple[str, str]:
    """The middle of the lane goes on *step* to the left in the second road, *up* and turned by *kink*."""
    lanes = section(0.0, "", lane(-1, before=-1, after=-1))
    heights = f'<elevationProfile><elevation s="0"{factors(up, 0.0)}/></elevationProfile>'
    x, y = 100.0 - 1.75 * math.sin(kink), step - 1.75 + 1.75 * math.cos(kink)
    one = road("1", geometry(0.0, 0.0, 0.0, 0.0, 100.0), 100.0, lanes, link=to_road("successor", "2", "start"))
    link = to_road("predecessor", "1", "end")
    return one, road("2", geometry(0.0, x, y, kink, 100.0), 100.0, lanes, link=link, more=heights)


def smoothed(read: Network, tolerance: Tolerance = WIDE) -> RoadPath:
    return road_tables(read, (), tolerance).paths[0]


def jumps(path: RoadPath) -> tuple[float, float, float]:
    """The largest step of the lane's middle beyond its stations, and turn between stations 1 cm apart; its height's."""
    s = np.linspace(0.0, path.length, int(path.length * 100) + 1)
    at = place(path, s, lane_middle(path, s))
    steps = np.hypot(np.diff(at.x), np.diff(at.y))
    turns = np.abs(np.angle(np.exp(1j * np.diff(at.heading))))
    return float(np.max(np.abs(steps - 0.01))), float(np.max(turns)), float(np.max(np.abs(np.diff(at.z))))


def test_a_step_within_the_tolerance_is_smoothed_and_told(tmp_path: Path) -> None:
    read = network(tmp_path, *two_roads(0.4, 0.0))
    with pytest.raises(DseError, match=r"the lane of the path continues 0\.4 m off in this road"):
        road_tables(read)
    path = smoothed(read, Tolerance(0.5, 0.0))
    assert [problem.what for problem in path.smoothed] == [
        "smoothed over 32 m: the lane of the path continues 0.4 m off in this road"
    ]
    assert path.smoothed[0].where.line == 13
    # By the closed form: half of the step each, and at most 1.875 * 0.2 / 16 off the direction.
    at = place(path, np.array([83.9, 100.0, 116.1]), -1.75)
    assert at.y == pytest.approx([-1.75, -1.55, -1.35], abs=1e-9)
    off, turn, _ = jumps(path)
    # The lane lies 1.75 m beside the line, which bends by up to 5.78 * 0.2 / 16^2.
    assert off < 0.01 * ((1.875 * 0.2 / 16) ** 2 / 2 + 1.75 * 5.78 * 0.2 / 16**2)
    assert turn < 1e-4


def test_a_kink_turns_on_a_curve(tmp_path: Path) -> None:
    read = network(tmp_path, *two_roads(0.0, 0.3))
    with pytest.raises(DseError, match=r"with a kink of 0\.3 rad in this road"):
        smoothed(read, Tolerance(1.0, 0.29))
    path = smoothed(read, Tolerance(0.5, 0.31))
    assert "a kink of 0.3 rad" in path.smoothed[0].what
    assert place(path, np.array([100.0])).heading == pytest.approx(0.15)
    off, turn, _ = jumps(path)
    # Half of the turn on each side, within 18 m; an arc would bend by 0.15 / 18.
    assert turn < 0.01 * 4.1 * 0.15 / 18
    assert off < 1e-3


def test_a_step_up_is_a_ramp(tmp_path: Path) -> None:
    path = smoothed(network(tmp_path, *two_roads(0.0, 0.0, up=0.25)))
    assert "0.25 m off" in path.smoothed[0].what
    assert jumps(path)[2] < 0.01 * 1.875 * 0.125 / 5 * 1.01
    assert place(path, np.array([0.0, 100.0, 200.0])).z == pytest.approx([0.0, 0.125, 0.25])


def test_what_is_larger_than_the_tolerance_is_refused_as_ever(tmp_path: Path) -> None:
    read = network(tmp_path, road("1", pieces(0.6, 0.0), 200.0))
    for tolerance in (Tolerance(0.59, 1.0), Tolerance(0.0, 1.0)):
        with pytest.raises(DseError, match=r"this <geometry> begins 0\.6 m off the end of the one before"):
            smoothed(read, tolerance)
    (path,) = road_tables(read, (), Tolerance(0.6, 0.0)).paths
    assert path.smoothed[0].what.startswith("smoothed over 48 m: the reference line continues 0.6 m off")


def test_what_a_road_may_have_stays_to_the_last_bit(tmp_path: Path) -> None:
    read = network(tmp_path, *two_roads(0.015, 0.015))
    one, other = road_tables(read).paths[0], smoothed(read)
    assert road_files(tables(one)) == road_files(tables(other))
    assert other.smoothed == ()
    # A step that a path lets pass is smoothed if its user tolerates any.
    (near,) = road_tables(network(tmp_path, *two_roads(0.9 * STEP, 0.0)), (), Tolerance(0.1, 0.1)).paths
    assert len(near.smoothed) == 1


def tables(path: RoadPath) -> Any:
    from dse.world import RoadTables

    return RoadTables((path,))


def test_the_seam_of_a_closed_path_is_smoothed_too(tmp_path: Path) -> None:
    length = 2 * math.pi * 50.0
    ring = geometry(0.0, 50.2, 0.0, math.pi / 2, length / 2, '<arc curvature="0.02"/>')
    ring += geometry(length / 2, -49.8, 0.0, -math.pi / 2, length / 2, '<arc curvature="0.02"/>').replace(
        "-49.8", "-50.2"
    )
    links = to_road("predecessor", "1", "end") + to_road("successor", "1", "start")
    read = network(tmp_path, road("1", ring, length, section(0.0, "", lane(-1, before=-1, after=-1)), link=links))
    path = smoothed(read)
    assert path.closed
    assert len(path.smoothed) == 2
    seam = place(path, np.array([0.0, np.nextafter(path.length, 0.0)]), lane_middle(path, np.array([0.0, 1.0])))
    assert seam.x[0] == pytest.approx(seam.x[1], abs=1e-8)
    assert seam.y[0] == pytest.approx(seam.y[1], abs=1e-8)
    assert jumps(path)[0] < 1e-3


def test_joints_too_near_to_each_other_are_refused(tmp_path: Path) -> None:
    near = (
        geometry(0.0, 0.0, 0.0, 0.0, 50.0) + geometry(50.0, 50.0, 0.3, 0.0, 1.0) + geometry(51.0, 51.0, 0.0, 0.0, 50.0)
    )
    with pytest.raises(DseError, match="there is too little room between it and the next one to smooth it"):
        smoothed(network(tmp_path, road("1", near, 101.0)))


def test_a_kerb_of_a_lane_is_tolerated_and_told(tmp_path: Path) -> None:
    high = section(0.0, "", lane(-1, more='<height sOffset="0" inner="0.12" outer="0.12"/>'))
    read = network(tmp_path, road("1", geometry(0.0, 0.0, 0.0, 0.0, 50.0), 50.0, high))
    path = smoothed(read, Tolerance(0.15, 0.0))
    assert [p.what for p in path.smoothed] == [
        "tolerated: a lane with a <height> of its own is not supported on a path"
    ]
    with pytest.raises(DseError, match="<height> of its own"):
        smoothed(read, Tolerance(0.1, 0.0))


def of_size(least: float, most: float) -> st.SearchStrategy[float]:
    return st.floats(least, most) | st.floats(-most, -least)


@settings(max_examples=25, deadline=None, derandomize=True)
@given(step=of_size(0.03, 0.9), kink=of_size(0.03, 0.45), up=of_size(0.03, 0.3), other=of_size(0.03, 0.4))
def test_no_smoothed_path_jumps(
    step: float, kink: float, up: float, other: float, tmp_path_factory: pytest.TempPathFactory
) -> None:
    folder = tmp_path_factory.mktemp("road")
    one, second = two_roads(step, kink, up)
    bent = geometry(0.0, 0.0, 0.0, 0.0, 60.0) + geometry(60.0, 60.0, other, 0.0, 40.0)
    parts = one.replace(geometry(0.0, 0.0, 0.0, 0.0, 100.0), bent), second
    path = smoothed(network(folder, *parts), Tolerance(2.0, 0.5))
    found = jumps(path)
    assert found[0] < 1e-3
    assert found[1] < 1e-3
    assert found[2] < 1e-3
