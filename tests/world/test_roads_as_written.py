"""Roads in YAML → OpenDRIVE: continuous, as long and as bent as asked, whatever is put together."""

from __future__ import annotations

import cmath
import json
import math
from itertools import pairwise
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np
import pytest
from defusedxml.ElementTree import fromstring
from hypothesis import given, strategies as st
from scipy.special import fresnel

from dse.loading import Workspace
from dse.world import open_roads, opendrive_of, place, road_tables

Pose = tuple[complex, float, float]
"""A point, a heading in rad and a curvature in 1/m."""


def roads_of(text: str) -> dict[str, Element]:
    return {road.get("id"): road for road in fromstring(text).iter("road")}


def number(element: Element, name: str) -> float:
    return float(element.get(name))


def pose(road: Element, s: float) -> Pose:
    """The reference line at *s*."""
    piece = [g for g in road.iter("geometry") if number(g, "s") <= s + 1e-12][-1]
    return after(piece, s - number(piece, "s"))


def after(geometry: Element, ds: float) -> Pose:
    start, heading = complex(number(geometry, "x"), number(geometry, "y")), number(geometry, "hdg")
    (shape,) = geometry
    if shape.tag == "line":
        return start + ds * cmath.exp(1j * heading), heading, 0.0
    if shape.tag == "arc":
        k = number(shape, "curvature")
        return start + (cmath.exp(1j * k * ds) - 1) / (1j * k) * cmath.exp(1j * heading), heading + k * ds, k
    first, last = number(shape, "curvStart"), number(shape, "curvEnd")
    rate = (last - first) / number(geometry, "length")
    # The clothoid with curvature 0 at its own start, from where this one begins.
    before, behind = _clothoid(first / rate, rate), _clothoid(first / rate + ds, rate)
    turned = cmath.exp(1j * (heading - first**2 / (2 * rate)))
    return start + (behind - before) * turned, heading + first * ds + rate * ds**2 / 2, first + rate * ds


def _clothoid(length: float, rate: float) -> complex:
    scale = math.sqrt(math.pi / abs(rate))
    sine, cosine = fresnel(length / scale)
    return scale * complex(cosine, math.copysign(sine, length * rate))


def cubic(records: list[Element], s: float, name: str = "s") -> float:
    """The value at *s* of the last record that begins before."""
    found = [record for record in records if number(record, name) <= s + 1e-9]
    if not found:
        return 0.0
    ds = s - number(found[-1], name)
    return sum(number(found[-1], letter) * ds**power for power, letter in enumerate("abcd"))


def lane_borders(road: Element, lane: int, s: float, *, last: bool = False) -> tuple[float, float]:
    """The t of a lane's inner and outer border at *s*; of two sections that meet there the earlier one if *last*."""
    sections = [x for x in road.iter("laneSection") if number(x, "s") <= s - (1e-9 if last and s > 0 else -1e-9)]
    section, sign = sections[-1], math.copysign(1, lane)
    widths = {int(x.get("id")): x.findall("width") for x in section.iter("lane")}
    t = cubic(list(road.iter("laneOffset")), s)
    for number_ in range(1, abs(lane) + 1):
        width = cubic(widths[int(sign * number_)], s - number(section, "s"), "sOffset")
        inner, t = t, t + sign * width
    return inner, t


def lane_middle(road: Element, lane: int, s: float) -> tuple[complex, float]:
    """The middle of a lane and the heading there."""
    point, heading, _ = pose(road, s)
    return point + 1j * sum(lane_borders(road, lane, s)) / 2 * cmath.exp(1j * heading), heading


ROOT = Path(__file__).parents[2]
EXACT = 1e-9


def written(folder: Path, **road: object) -> str:
    """The road as OpenDRIVE; JSON is YAML."""
    path = folder / "road.yaml"
    path.write_text(json.dumps({"road": "road", **road}), encoding="utf-8")
    return opendrive_of(Workspace(folder).road(str(path)))


@st.composite
def curves(draw: st.DrawFn) -> dict:
    radius, angle = draw(st.floats(10, 2000)), draw(st.floats(2, 350))
    most = radius * math.radians(angle)
    spiral = [draw(st.sampled_from([0.0, 0.2, 0.7])) * most for _ in range(2)]
    bank = draw(st.sampled_from([0, 0.03, -0.02])) if all(spiral) else 0
    side = draw(st.sampled_from(["left", "right"]))
    return {"curve": {"radius": radius, "angle": angle, "direction": side, "spiral": spiral, "bank": bank}}


straights = st.builds(lambda length: {"straight": length}, st.floats(1, 5000))
hills = st.builds(
    lambda grade, radius, slope: {"hill": {"grade": grade, "radius": radius, "slope": slope}, "_level": True},
    st.floats(0.01, 0.12),
    st.floats(100, 3000),
    st.sampled_from([0, 50.0]),
)


@st.composite
def stretches(draw: st.DrawFn) -> list[dict]:
    """Segments, whose grades and lanes change between them."""
    segments = draw(st.lists(st.one_of(straights, curves(), hills), min_size=1, max_size=8))
    grade, lanes = 0.0, 1
    for number_, segment in enumerate(segments):
        if segment.pop("_level", False):
            if grade:
                segments[number_] = {"straight": 400.0, "grade": 0, "rounding": 500}
                grade = 0.0
            continue
        length = segment.get("straight") or _length(segment["curve"])
        wanted = draw(st.sampled_from([grade, 0.0, 0.03, -0.05]))
        if wanted != grade and abs(wanted - grade) * 1000 < length and number_:
            segment |= {"grade": wanted}
            grade = wanted
        many = draw(st.integers(1, 3))
        if many != lanes and number_ and length > 20:
            segment |= {"lanes": many, "widening": draw(st.sampled_from([0.99 * length, length / 2]))}
            lanes = many
    return segments


def _length(curve: dict) -> float:
    return curve["radius"] * math.radians(curve["angle"]) + sum(curve["spiral"]) / 2


@given(segments=stretches())
def test_any_list_of_segments_is_a_continuous_road_of_the_length_and_angle_asked_for(tmp_path_factory, segments):
    (road,) = roads_of(written(tmp_path_factory.mktemp("road"), segments=segments)).values()
    pieces = list(road.iter("geometry"))
    for one, other in pairwise(pieces):
        point, heading, _ = after(one, number(one, "length"))
        begins, ahead, _ = after(other, 0.0)
        assert abs(point - begins) < EXACT
        assert abs(heading - ahead) < EXACT
        assert number(other, "s") == pytest.approx(number(one, "s") + number(one, "length"), abs=EXACT)
    curves = [segment["curve"] for segment in segments if "curve" in segment]
    lengths = [_length(curve) for curve in curves] + [s["straight"] for s in segments if "straight" in s]
    # Up and down: feet and crest turn the profile by four grades, the slopes lie between.
    hills_ = [segment["hill"] for segment in segments if "hill" in segment]
    lengths += [4 * hill["grade"] * hill["radius"] + 2 * hill["slope"] for hill in hills_]
    assert number(road, "length") == pytest.approx(sum(lengths), rel=1e-12)
    turns = [math.radians(curve["angle"]) * (1 if curve["direction"] == "left" else -1) for curve in curves]
    assert pose(road, number(road, "length"))[1] == pytest.approx(sum(turns), abs=EXACT)


@given(segments=stretches())
def test_height_grade_bank_and_lanes_have_no_steps(tmp_path_factory, segments):
    (road,) = roads_of(written(tmp_path_factory.mktemp("road"), segments=segments)).values()
    for tag, order in (("elevation", 1), ("superelevation", 1)):
        for one, other in pairwise(list(road.iter(tag))):
            ds = number(other, "s") - number(one, "s")
            a, b, c, d = (number(one, letter) for letter in "abcd")
            assert a + b * ds + c * ds**2 + d * ds**3 == pytest.approx(number(other, "a"), abs=EXACT)
            assert b + 2 * c * ds + 3 * d * ds**2 == pytest.approx(number(other, "b"), abs=EXACT), order
    for section in list(road.iter("laneSection"))[1:]:
        s = number(section, "s")
        for lane in section.iter("lane"):
            id_ = int(lane.get("id"))
            before = lane.find("link/predecessor")
            if id_ and before is not None:
                assert lane_borders(road, id_, s, last=True) == pytest.approx(lane_borders(road, id_, s), abs=EXACT)
            elif id_:  # it begins here, with no width
                inner, outer = lane_borders(road, id_, s)
                assert inner == pytest.approx(outer, abs=EXACT)


def test_a_spiral_is_the_clothoid_and_the_arc_has_the_radius_and_the_bank(tmp_path):
    curve = {"radius": "120 m", "angle": "90 deg", "spiral": "60 m", "bank": "5 %"}
    (road,) = roads_of(written(tmp_path, segments=[{"straight": "50 m"}, {"curve": curve}])).values()
    # At the end of a spiral of length L to radius R the heading is L / 2R.
    point, heading, curvature = pose(road, 110.0)
    assert (heading, curvature) == pytest.approx((0.25, 1 / 120), abs=1e-12)
    # Its coordinates by their series, x = L (1 - tau²/10 + tau⁴/216), y = L (tau/3 - tau³/42 + tau⁵/1320).
    tau, length = 0.25, 60.0
    assert point.real - 50 == pytest.approx(length * (1 - tau**2 / 10 + tau**4 / 216 - tau**6 / 9360), abs=1e-6)
    assert point.imag == pytest.approx(length * (tau / 3 - tau**3 / 42 + tau**5 / 1320), abs=1e-6)
    banks = list(road.iter("superelevation"))
    # To the left: the left side is lower.
    assert math.tan(cubic(banks, 150.0)) == pytest.approx(-0.05)
    assert cubic(banks, 49.0) == cubic(banks, number(road, "length")) == 0.0


def test_a_hill_has_its_crest_radius_and_its_height(tmp_path):
    (road,) = roads_of(written(tmp_path, segments=[{"hill": {"grade": 0.08, "radius": 1000, "slope": 100}}])).values()
    heights, half = list(road.iter("elevation")), number(road, "length") / 2
    # Two parabolas climb by g² R / 2 each, the slope by g L.
    assert cubic(heights, half) == pytest.approx(0.08**2 * 1000 + 8)
    bend = (cubic(heights, half + 1) - 2 * cubic(heights, half) + cubic(heights, half - 1)) / 1.0
    assert bend == pytest.approx(-1 / 1000)


CROSSINGS = st.one_of(
    st.builds(
        lambda arms, lanes, corner: {"intersection": {"arms": arms, "lanes": lanes, "corner": corner}},
        st.sampled_from([3, 4]),
        st.integers(1, 3),
        st.floats(2, 20),
    ),
    st.builds(
        lambda radius, arms: {"roundabout": {"radius": radius, "arms": arms}},
        st.floats(11, 60),
        st.sampled_from([3, 4]),
    ),
)


@given(CROSSINGS, st.sampled_from(["straight", "left", "right"]), st.integers(1, 3), st.booleans())
def test_lanes_go_through_crossings_without_a_step_or_a_kink(tmp_path_factory, crossing, leads, lanes, goes_on):
    (kind,) = crossing
    shape = crossing[kind]
    shape["exit"] = leads
    if shape["arms"] == 3:
        shape["side"] = leads if leads != "straight" else "left"
    bend = {"curve": {"radius": 150, "angle": 33, "spiral": 20}}
    segments = [bend, {kind: shape}, *([{"straight": 80}] if goes_on else [])]
    text = written(tmp_path_factory.mktemp("road"), segments=segments, lanes=lanes if kind == "intersection" else 1)
    roads = roads_of(text)
    seen = 0
    for road in roads.values():
        for end, s in (("predecessor", 0.0), ("successor", number(road, "length"))):
            link = road.find(f"link/{end}")
            if link is None or link.get("elementType") == "junction" or road.get("junction") == "-1":
                continue
            other = roads[link.get("elementId")]
            there = 0.0 if link.get("contactPoint") == "start" else number(other, "length")
            lane = int(road.find(f".//right/lane/link/{end}").get("id"))
            point, heading = lane_middle(road, -1, s)
            meets, ahead = lane_middle(other, lane, there)
            turned = ahead + (math.pi if lane > 0 else 0.0)
            assert abs(point - meets) < EXACT
            assert abs(math.remainder(heading - turned, math.tau)) < EXACT
            # Curvature is that of the arm, which is straight there, or that of the ring.
            assert pose(road, s)[2] == pytest.approx(pose(other, there)[2], abs=EXACT)
            seen += 1
    assert seen >= 12


@pytest.mark.parametrize("path", sorted((ROOT / "roads").glob("*.yaml")), ids=lambda path: path.stem)
def test_the_roads_that_come_along_are_read_back_as_paths(path):
    workspace = Workspace(ROOT)
    tables = road_tables(open_roads(str(path), workspace))
    assert tables.paths[0].length > 300


@pytest.mark.parametrize("leads", ["straight", "left", "right"])
@pytest.mark.parametrize("kind", ["intersection", "roundabout"])
def test_the_way_along_the_segments_is_driven_unless_another_is_asked_for(tmp_path, kind, leads):
    shape = {"exit": leads} | ({"radius": 15} if kind == "roundabout" else {})
    lanes = 1 if kind == "roundabout" else 2
    road = {"road": "far", "lanes": lanes, "segments": [{"straight": 30}, {kind: shape}, {"straight": 45}]}
    (tmp_path / "far.yaml").write_text(json.dumps(road), encoding="utf-8")
    (path,) = road_tables(open_roads(str(tmp_path / "far.yaml"), Workspace(tmp_path))).paths
    begins, ends = place(path, np.array([0.0])), place(path, np.array([path.length]))
    assert (begins.x[0], begins.heading[0]) == pytest.approx((0, 0))
    turned = {"straight": 0.0, "left": math.pi / 2, "right": -math.pi / 2}[leads]
    assert ends.heading[0] == pytest.approx(turned)
    # The arms that are not on the way are 100 m long.
    assert path.length < 160


def test_ice_on_all_lanes_and_on_half_a_lane_is_read_back_where_it_was_written(tmp_path):
    ice = [{"along": [20, 30], "friction": 0.1}, {"along": [30, 35], "friction": 0.3}]
    half = [{"along": ["40 m", "60 m"], "across": ["-3.5 m", "-1.75 m"], "friction": 0.2}]
    road = {"road": "icy", "segments": [{"straight": 10}, {"straight": 90, "friction": ice + half}]}
    (tmp_path / "icy.yaml").write_text(json.dumps(road), encoding="utf-8")
    (path,) = road_tables(open_roads(str(tmp_path / "icy.yaml"), Workspace(tmp_path))).paths
    for lane in path.lanes:
        values = list(zip(lane.friction.starts, lane.friction.coefficients[:, 0], strict=True))
        assert values == [(0.0, 1.0), (30.0, 0.1), (40.0, 0.3), (45.0, 1.0)]
    (patch,) = path.patches
    assert (patch.start, patch.end, patch.right, patch.left, patch.friction) == (50, 70, -3.5, -1.75, 0.2)


def test_lights_of_both_ways_share_the_cycle_and_are_never_green_together(tmp_path):
    lights = {"cycle": 60, "main": 30, "yellow": 3, "clearing": 2, "shift": 7}
    road = {"road": "lit", "segments": [{"straight": 50}, {"intersection": {"lights": lights}}, {"straight": 50}]}
    (tmp_path / "lit.yaml").write_text(json.dumps(road), encoding="utf-8")
    network = open_roads(str(tmp_path / "lit.yaml"), Workspace(tmp_path))
    signals = [signal for road in network.roads.values() for signal in road.signals]
    assert len(signals) == 4
    assert {signal.shift for signal in signals} == {7.0}
    shown = {signal.phases for signal in signals}
    assert len(shown) == 2
    assert {sum(seconds for _, seconds in phases) for phases in shown} == {60.0}

    def colour(phases, second):
        for name, seconds in phases:
            if second < seconds:
                return name
            second -= seconds
        raise AssertionError(second)

    for second in range(60):
        assert sorted({colour(phases, second + 0.5) for phases in shown} | {"red"})[-1] in ("red", "yellow")
        assert "red" in {colour(phases, second + 0.5) for phases in shown}


def test_a_closed_road_leads_to_itself_and_one_that_does_not_says_by_how_much(tmp_path):
    bend = {"curve": {"radius": 100, "angle": 180, "spiral": 50}}
    oval = [{"straight": 300}, bend, {"straight": 300}, bend]
    (road,) = roads_of(written(tmp_path, segments=oval, closed=True)).values()
    assert {link.get("elementId") for link in road.find("link")} == {road.get("id")}
    with pytest.raises(Exception, match=r"road.yaml:1:\d+: the road is not closed: it ends .* m to the left"):
        written(tmp_path, segments=oval[:3], closed=True)
