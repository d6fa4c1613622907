"""Messages of ASAM OSI against osi-python, which others read and write them with, and our own sensors and geometry."""

from __future__ import annotations

import ctypes
import math
import os
import random
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from google.protobuf.message import DecodeError
from hypothesis import given, settings, strategies as st
from numpy.typing import NDArray
from osi3.osi_groundtruth_pb2 import GroundTruth
from osi3.osi_sensordata_pb2 import SensorData
from osi3.osi_sensorview_pb2 import SensorView
from osi3.osi_version_pb2 import DESCRIPTOR as VERSION, current_interface_version

from dse.fmu.toolchain.compiler import find_compiler
from dse.report import Scene, Trace
from dse.report.scene.data import Ground, Host
from dse.report.trace.ground_truth import ground_truths

NewPart = Callable[..., Any]
ROOT = Path(__file__).parents[2]
CLASSES = ["none", "car", "truck", "motorcycle", "bicycle", "pedestrian", "obstacle"]
VEHICLES = {"car": "TYPE_CAR", "truck": "TYPE_HEAVY_TRUCK", "motorcycle": "TYPE_MOTORCYCLE", "bicycle": "TYPE_BICYCLE"}
MOTION = ("x", "y", "heading", "speed", "lateral_speed", "yaw_rate", "acceleration", "lateral_acceleration")
VECTORS = ("position", "orientation", "velocity", "acceleration", "orientation_rate")
SIDE_LAMP = math.log(20)  # extinction times visibility, at 5 % of the light

worlds = st.fixed_dictionaries(
    {
        "motion": st.lists(st.floats(-500, 500), min_size=8, max_size=8),
        "actors": st.lists(
            st.fixed_dictionaries(
                {
                    "class": st.sampled_from(CLASSES),
                    "length": st.floats(0.2, 20),
                    "width": st.floats(0.2, 3),
                    "height": st.floats(0.2, 4),
                    "clearance": st.floats(0, 0.1),
                    **{key: st.floats(-300, 300) for key in ("x", "y", "z", "heading", "speed", "lateral_speed")},
                    "acceleration": st.floats(-9, 9),
                }
            ),
            max_size=8,
        ),
        "slope": st.none() | st.tuples(st.floats(-0.3, 0.3), st.floats(-0.3, 0.3), st.floats(-50, 50)),
    }
)


def world(part: Any, given_world: Any) -> None:
    for name, value in zip(MOTION, given_world["motion"], strict=True):
        part[f"motion.{name}"] = value
    for number in range(1, 9):
        actor = given_world["actors"][number - 1] if number <= len(given_world["actors"]) else {"class": "none"}
        for name, value in {"id": 7 * number, **actor}.items():
            part[f"actors[{number}].{name}"] = value
    x, y, height = given_world["slope"] or (0, 0, 0)
    for wheel in range(1, 5):
        part[f"ground[{wheel}].slope_x"], part[f"ground[{wheel}].slope_y"] = x, y
        part[f"ground[{wheel}].height"] = height
        part[f"ground[{wheel}].friction"] = 0.0 if given_world["slope"] is None else 1.0


def view_of(part: Any) -> Any:
    return SensorView.FromString(part["view"])


def rotation(orientation: Any) -> NDArray[np.float64]:
    """From a body's axes to its parent's: yaw, then pitch, then roll (DIN ISO 8855)."""
    angles = orientation.roll, orientation.pitch, orientation.yaw
    (cr, sr), (cp, sp), (cy, sy) = ((math.cos(angle), math.sin(angle)) for angle in angles)
    yaw = np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]])
    pitch = np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]])
    roll = np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]])
    return np.asarray(yaw @ pitch @ roll)


def vector(of: Any) -> NDArray[np.float64]:
    return np.array([of.x, of.y, of.z])


def test_every_road_user_is_read_back_as_it_is(new_part: NewPart) -> None:
    part = new_part("osi_sensor_view")

    @settings(max_examples=60, deadline=None, derandomize=True)
    @given(worlds)
    def check(given_world: Any) -> None:
        world(part, given_world)
        part.init()
        truth = view_of(part).global_ground_truth
        moving = {o.id.value: o for o in truth.moving_object}
        still = {o.id.value: o for o in truth.stationary_object}
        there = {7 * (n + 1): actor for n, actor in enumerate(given_world["actors"]) if actor["class"] != "none"}
        assert moving.keys() == {0} | {n for n, actor in there.items() if actor["class"] != "obstacle"}
        assert still.keys() == {n for n, actor in there.items() if actor["class"] == "obstacle"}
        for number, actor in there.items():
            is_still = actor["class"] == "obstacle"
            found = (still if is_still else moving)[number]
            size, place = found.base.dimension, found.base.position
            assert [size.length, size.width, size.height] == [
                actor["length"],
                actor["width"],
                actor["height"] - actor["clearance"],
            ]
            ground = actor["z"] if given_world["slope"] else 0.0
            assert [place.x, place.y, place.z] == [
                actor["x"],
                actor["y"],
                ground + (actor["height"] + actor["clearance"]) / 2,
            ]
            yaw = found.base.orientation.yaw
            assert abs(yaw) <= math.pi
            assert math.remainder(yaw - actor["heading"], math.tau) == pytest.approx(0, abs=1e-12)
            if is_still:
                kind = found.classification
                assert (kind.type, kind.material, kind.density) == (1, 1, 1)  # "unknown" must not be in ground truth
                continue
            turn = rotation(found.base.orientation)
            expected = turn @ [actor["speed"], actor["lateral_speed"], 0]
            assert vector(found.base.velocity) == pytest.approx(expected, abs=1e-9)
            assert vector(found.base.acceleration) == pytest.approx(turn @ [actor["acceleration"], 0, 0], abs=1e-9)
            if actor["class"] == "pedestrian":
                assert found.type == found.TYPE_PEDESTRIAN
                assert found.HasField("pedestrian_attributes")
            else:
                assert found.type == found.TYPE_VEHICLE
                assert found.HasField("vehicle_attributes")
                kinds = found.VehicleClassification
                assert found.vehicle_classification.type == kinds.Type.Value(VEHICLES[actor["class"]])

    check()


def test_a_trace_file_has_the_same_ground_truth(new_part: NewPart) -> None:
    part = new_part("osi_sensor_view")

    @settings(max_examples=30, deadline=None, derandomize=True)
    @given(worlds)
    def check(given_world: Any) -> None:
        world(part, {**given_world, "slope": None})
        part.init()
        expected = GroundTruth.FromString(part["truth"])
        (found,) = ground_truths(trace_of(given_world))
        # A trace has no time of day, and the axles and wheels of the host as far as its chassis states them.
        expected.environmental_conditions.ClearField("time_of_day")
        for message in (expected, found):
            message.moving_object[0].ClearField("vehicle_attributes")
        assert str(nearly(found)) == str(nearly(expected))

    check()


def trace_of(given_world: Any) -> Trace:
    """The one moment of *given_world*, as a scene has it."""
    motion = dict(zip(MOTION, (np.array([value]) for value in given_world["motion"]), strict=True))
    host = {**motion, **dict.fromkeys(("z", "roll", "pitch", "steering"), np.zeros(1))}
    others = tuple(
        {
            "id": np.array([7.0 * n]),
            **{k: np.array([float(CLASSES.index(v) if k == "class" else v)]) for k, v in a.items()},
        }
        | {"z": np.zeros(1)}
        for n, a in enumerate(given_world["actors"], 1)
    )
    weather = dict.fromkeys(("fog", "rain", "snow", "darkness"), np.zeros(1))
    scene = Scene("", "", np.zeros(1), Ground((), ()), Host(host, 4.5, 1.8, 2.3), others, (), weather, ())
    return Trace(scene, {}, {}, 1.485)


def nearly(truth: Any) -> Any:
    """With numbers to seven places, and zeros that are stated and have no sign."""
    for item in (*truth.moving_object, *truth.stationary_object):
        for of in (getattr(item.base, name) for name in VECTORS if name in item.base.DESCRIPTOR.fields_by_name):
            for name in of.DESCRIPTOR.fields_by_name:
                setattr(of, name, round(getattr(of, name), 7) + 0.0)
    return truth


def test_the_bytes_are_those_that_osi_python_would_write(new_part: NewPart) -> None:
    part = new_part("osi_sensor_view")

    @settings(max_examples=30, deadline=None, derandomize=True)
    @given(worlds)
    def check(given_world: Any) -> None:
        world(part, given_world)
        part.init()
        view = view_of(part)
        assert view.SerializeToString(deterministic=True) == part["view"]
        assert GroundTruth.FromString(part["truth"]) == view.global_ground_truth
        assert view.global_ground_truth.SerializeToString(deterministic=True) == part["truth"]
        assert len(part["view"]) < 4096  # of 8192

    check()


def test_the_hosts_box_stands_on_the_road_and_its_coordinates_begin_at_the_rear_axle(new_part: NewPart) -> None:
    part = new_part("osi_sensor_view", mount_left=0.4, mount_turn=0.3)

    @settings(max_examples=40, deadline=None, derandomize=True)
    @given(worlds)
    def check(given_world: Any) -> None:
        world(part, given_world)
        part.init()
        view = view_of(part)
        host = next(o for o in view.global_ground_truth.moving_object if o.id.value == view.host_vehicle_id.value)
        x, y, heading, speed, lateral, rate, acceleration, lateral_acceleration = given_world["motion"]
        slope_x, slope_y, height = given_world["slope"] or (0.0, 0.0, 0.0)
        turn = rotation(host.base.orientation)
        up = np.array([-slope_x, -slope_y, 1]) / math.hypot(slope_x, slope_y, 1)
        assert turn[:, 2] == pytest.approx(up, abs=1e-12)  # its wheels are in the plane of the road
        assert math.remainder(math.atan2(turn[1, 0], turn[0, 0]) - heading, math.tau) == pytest.approx(0, abs=1e-9)
        middle = vector(host.base.position)
        below = middle - turn @ [2.3 - 4.5 / 2, 0, 1.5 / 2]
        assert below == pytest.approx([x, y, height], abs=1e-9)  # the road below the centre of gravity
        rear = middle + turn @ vector(host.vehicle_attributes.bbcenter_to_rear)
        front = middle + turn @ vector(host.vehicle_attributes.bbcenter_to_front)
        assert rear == pytest.approx(below + turn @ [-1.485, 0, 0.31], abs=1e-9)
        assert np.linalg.norm(front - rear) == pytest.approx(2.7)
        mounted = view.mounting_position
        assert rear + turn @ vector(mounted.position) == pytest.approx(below + turn @ [2.3, 0.4, 0.5], abs=1e-9)
        assert mounted.orientation.yaw == 0.3
        c, s = math.cos(heading), math.sin(heading)
        ahead = 2.3 - 4.5 / 2
        plane = [c * speed - s * (lateral + rate * ahead), s * speed + c * (lateral + rate * ahead)]
        assert vector(host.base.velocity)[:2] == pytest.approx(plane, abs=1e-9)
        inward = acceleration - rate * rate * ahead
        felt = [c * inward - s * lateral_acceleration, s * inward + c * lateral_acceleration]
        assert vector(host.base.acceleration)[:2] == pytest.approx(felt, abs=1e-7)
        assert host.base.orientation_rate.yaw == rate

    check()


def test_what_osi_demands_is_there(new_part: NewPart) -> None:
    part = new_part("osi_sensor_view")
    part.init()
    view = view_of(part)
    truth = view.global_ground_truth
    assert all(view.HasField(name) for name in ("timestamp", "sensor_id", "mounting_position", "host_vehicle_id"))
    assert truth.host_vehicle_id.value == view.host_vehicle_id.value == truth.moving_object[0].id.value
    assert view.sensor_id.value == 10000
    assert view.timestamp == truth.timestamp
    newest = VERSION.GetOptions().Extensions[current_interface_version]
    assert view.version == truth.version
    assert (view.version.version_major, view.version.version_minor) == (newest.version_major, 8)
    host = truth.moving_object[0]
    assert (host.type, host.vehicle_classification.type) == (host.TYPE_VEHICLE, host.VehicleClassification.TYPE_CAR)
    assert host.vehicle_attributes.number_wheels == 4


def test_time_is_counted_in_nanoseconds(new_part: NewPart) -> None:
    part = new_part("osi_sensor_view", time_of_day=86398)
    part.init()
    for k in range(350):
        part.step()
        view = view_of(part)
        assert view.timestamp.seconds * 10**9 + view.timestamp.nanos == k * 10**7
        day = view.global_ground_truth.environmental_conditions.time_of_day
        assert day.seconds_since_midnight == (86398 + k // 100) % 86400


@pytest.mark.parametrize(
    ("port", "values", "field", "items"),
    [
        (
            "rain_rate",
            [rate / 3.6e6 for rate in (0, 0.09, 0.11, 0.51, 2, 8.2, 35, 150)],
            "precipitation",
            ["NONE", "NONE", "VERY_LIGHT", "LIGHT", "MODERATE", "HEAVY", "VERY_HEAVY", "EXTREME"],
        ),
        (
            "fog_extinction",
            [0, *(SIDE_LAMP / sight for sight in (41000, 39000, 9000, 3000, 1500, 999, 199, 49))],
            "fog",
            [
                *("EXCELLENT_VISIBILITY", "EXCELLENT_VISIBILITY", "GOOD_VISIBILITY", "MODERATE_VISIBILITY"),
                *("POOR_VISIBILITY", "MIST", "LIGHT", "THICK", "DENSE"),
            ],
        ),
        (
            "darkness",
            [(5 - math.log10(light)) / 8 for light in (1e5, 9000, 900, 300, 15, 5, 2, 0.5, 0.005)],
            "ambient_illumination",
            [f"LEVEL{n}" for n in range(9, 0, -1)],
        ),
    ],
)
def test_weather_is_told_in_the_steps_of_osi(
    new_part: NewPart, port: str, values: list[float], field: str, items: list[str]
) -> None:
    part = new_part("osi_sensor_view")
    part["surface.temperature"] = 271.0
    told = []
    for value in values:
        part[f"visibility.{port}"] = value
        part.init()
        found = view_of(part).global_ground_truth.environmental_conditions
        assert found.temperature == 271
        told.append(type(found).DESCRIPTOR.fields_by_name[field].enum_type.values_by_number[getattr(found, field)].name)
    assert told == [f"{field.upper()}_{item}" for item in items]


def ideal(view: Any) -> Any:
    """What a sensor model that sees everything tells of a SensorView, by OSI's definitions."""
    truth, data = view.global_ground_truth, SensorData()
    data.version.CopyFrom(view.version)
    data.timestamp.CopyFrom(view.timestamp)
    data.mounting_position.CopyFrom(view.mounting_position)
    data.sensor_view.add().CopyFrom(view)
    host = truth.moving_object[0]
    body = rotation(host.base.orientation)
    at = vector(host.base.position) + body @ (
        vector(host.vehicle_attributes.bbcenter_to_rear) + vector(view.mounting_position.position)
    )
    axes = body @ rotation(view.mounting_position.orientation)
    spin = np.array([0, 0, host.base.orientation_rate.yaw])
    own = vector(host.base.velocity) + np.cross(spin, at - vector(host.base.position))
    for theirs in truth.moving_object[1:]:
        seen = data.moving_object.add()
        seen.header.tracking_id.value = theirs.id.value
        seen.header.existence_probability = 0.9
        seen.base.dimension.CopyFrom(theirs.base.dimension)
        for field, value in (
            (seen.base.position, vector(theirs.base.position) - at),
            (seen.base.velocity, vector(theirs.base.velocity) - own),
        ):
            field.x, field.y, field.z = axes.T @ value
        seen.base.orientation.yaw = (
            theirs.base.orientation.yaw - host.base.orientation.yaw - view.mounting_position.orientation.yaw
        )
        seen.candidate.add(probability=0.3, type=theirs.TYPE_OTHER)
        candidate = seen.candidate.add(probability=0.7, type=theirs.type)
        candidate.vehicle_classification.CopyFrom(theirs.vehicle_classification)
    return data


def told(part: Any, keys: tuple[str, ...]) -> list[list[float]]:
    returns = [f"scan.returns[{number}]" for number in range(1, 17)]
    return [[part[f"{one}.{key}"] for key in keys] for one in returns if part[f"{one}.valid"]]


SEEN = ("range", "azimuth", "width", "class", "range_rate")


def test_an_ideal_sensor_by_osi_tells_what_our_perfect_sensor_tells(new_part: NewPart) -> None:
    writer, reader, ours = (new_part(name) for name in ("osi_sensor_view", "osi_detections", "object_perfect"))
    counted = []

    @settings(max_examples=60, deadline=None, derandomize=True)
    @given(
        st.lists(st.floats(-30, 30), min_size=8, max_size=8),
        st.lists(st.tuples(st.floats(6, 25), st.floats(-4, 4), st.sampled_from(CLASSES[:-1])), min_size=8, max_size=8),
        st.floats(-3, 3),
    )
    def check(motion: Any, others: Any, turn: float) -> None:
        writer["mount_turn"] = turn
        for part in (writer, ours):
            for name, value in zip(MOTION, motion, strict=True):
                part[f"motion.{name}"] = value
            for number, (distance, heading, kind) in enumerate(others, 1):
                around = 0.2 + math.tau * number / 8 + motion[2]
                actor = {"id": number, "class": kind, "length": 3.5 + number / 8, "width": 1.4, "height": 1.5}
                x, y = distance * number * math.cos(around), distance * number * math.sin(around)
                place = {"x": motion[0] + x, "y": motion[1] + y}
                moves = {"heading": heading, "speed": heading * 7, "lateral_speed": heading / 3}
                for name, value in {**actor, **place, **moves}.items():
                    part[f"actors[{number}].{name}"] = value
            part.init()
        for name in ("ahead", "left", "turn"):
            reader[f"pose.{name}"] = writer[f"pose.{name}"]
        reader["data"] = ideal(view_of(writer)).SerializeToString()
        reader.init()
        expected = told(ours, SEEN)
        counted.append(len(expected))
        found = told(reader, SEEN)
        assert len(found) == len(expected)
        for mine, theirs in zip(found, expected, strict=True):
            # Where two sides fill as much of the view, rounding decides which is told; here none do.
            assert mine == pytest.approx(theirs, abs=1e-8)
        assert reader["scan.mount"] == ours["scan.mount"]
        assert (reader["malformed"], reader["left_out"]) == (0, 0)

    check()
    assert sum(counted) > 200


def message(*objects: tuple[float, float], **more: Any) -> Any:
    data = SensorData(**more)
    for x, y in objects:
        data.moving_object.add().base.position.MergeFrom(type(data.moving_object[0].base.position)(x=x, y=y))
    return data


def read(part: Any, data: Any) -> list[list[float]]:
    part["data"] = data if isinstance(data, bytes) else data.SerializeToString()
    part.step()
    return told(part, ("range", "azimuth"))


def test_what_is_stationary_is_an_obstacle_and_what_hardly_exists_is_not_told(new_part: NewPart) -> None:
    part = new_part("osi_detections")
    part.init()
    data = message((10, 0), (20, 0), (30, 0))
    data.moving_object[1].header.existence_probability = 0.49
    data.moving_object[2].header.existence_probability = 0.51
    data.stationary_object.add().base.position.x = 5
    part["data"] = data.SerializeToString()
    part.step()
    assert told(part, ("range", "class")) == [[5, 6], [10, 0], [30, 0]]


def test_errors_that_a_model_tells_stand_before_those_of_the_parameters(new_part: NewPart) -> None:
    part = new_part("osi_detections", range_deviation=0.7, azimuth_deviation=0.01, rate_deviation=0.3)
    part.init()
    data = message((30, 40), (60, 80))
    data.moving_object[0].base_rmse.position.x, data.moving_object[0].base_rmse.position.y = 2, 1
    data.moving_object[0].base.velocity.x = 5
    data.moving_object[0].base_rmse.velocity.x = 0.5
    part["data"] = data.SerializeToString()
    part.step()
    near, far = told(part, ("range_deviation", "azimuth_deviation", "range_rate", "rate_deviation"))
    assert near == pytest.approx([math.hypot(1.2, 0.8), math.hypot(1.6, 0.6) / 50, 3.0, 0.3])
    assert far == [0.7, 0.01, 0, 0]  # without a velocity there is no rate


@pytest.mark.parametrize("kind", ["radar", "lidar"])
def test_detections_of_radar_and_lidar_are_told_as_they_are(new_part: NewPart, kind: str) -> None:
    part = new_part("osi_detections", takes=kind)
    part["pose.ahead"], part["pose.left"], part["pose.turn"] = 2.0, -0.5, 1.0
    part.init()
    data = message((10, 0))
    found = (data.feature_data.radar_sensor if kind == "radar" else data.feature_data.lidar_sensor).add().detection
    found.add(existence_probability=0.8, radial_velocity=4.0)
    found[0].position.distance, found[0].position.azimuth, found[0].position.elevation = 50, -0.2, 0.1
    found[0].position_rmse.distance, found[0].position_rmse.azimuth = 0.25, 0.02
    found.add(classification=2).position.distance = 7  # invalid
    if kind == "radar":
        found[0].snr, found[0].radial_velocity_rmse = 13, 0.5
    part["data"] = data.SerializeToString()
    part.step()
    keys = ("range", "azimuth", "range_rate", "strength", "range_deviation", "azimuth_deviation", "rate_deviation")
    (one,) = told(part, keys)
    flat = 50 * math.cos(0.1)
    x, y = flat * math.cos(0.8), flat * math.sin(0.8) - 0.5
    radar = kind == "radar"
    strength, deviation = (10**1.3, 0.5) if radar else (0, 0.12)
    assert one == pytest.approx([math.hypot(x, y), math.atan2(y, x), -4, strength, 0.25, 0.02, deviation])
    assert part["left_out"] == 0


def test_of_more_than_sixteen_the_nearest_are_told(new_part: NewPart) -> None:
    part = new_part("osi_detections")
    part.init()
    ranges = [1 + 7 * number % 31 for number in range(31)]
    assert read(part, message(*((r, 0) for r in ranges))) == [[r, 0] for r in range(1, 17)]
    assert part["left_out"] == 15


def test_a_scan_is_new_with_another_time_of_measurement_and_ages_until_then(new_part: NewPart) -> None:
    part = new_part("osi_detections")
    part.init()
    found = []
    for k in range(12):
        data = message((10 + k, 0))
        data.timestamp.nanos = k * 10**7
        data.last_measurement_time.nanos = k // 4 * 4 * 10**7
        read(part, data)
        found.append((part["scan.number"], round(part["scan.age"], 9), part["scan.returns[1].range"]))
    assert found == [(1 + k // 4, k % 4 / 100, 10 + k // 4 * 4) for k in range(12)]


def test_nothing_is_told_before_the_first_message_and_nothing_is_lost_without_one(new_part: NewPart) -> None:
    part = new_part("osi_detections")
    part.init()
    assert read(part, b"") == []
    assert (part["scan.number"], part["messages"], part["malformed"]) == (0, 0, 0)
    assert read(part, message((9, 0))) == [[9, 0]]
    assert read(part, b"") == [[9, 0]]
    assert (part["scan.number"], part["messages"]) == (1, 1)
    assert part["scan.age"] == pytest.approx(0.01)
    assert read(part, SensorData(timestamp={"seconds": 3})) == []  # it sees nobody any more
    assert part["scan.number"] == 2


NAN, HUGE = float("nan"), 1e308


@pytest.mark.parametrize(
    ("field", "value"),
    [
        *(("position", {"x": NAN}), ("position", {"x": HUGE, "y": HUGE}), ("position", {"x": 0.0, "y": 0.0})),
        *(("velocity", {"x": NAN}), ("velocity", {"x": float("inf")})),
    ],
)
def test_numbers_that_are_none_leave_out_one_object(new_part: NewPart, field: str, value: dict[str, float]) -> None:
    part = new_part("osi_detections")
    part.init()
    data = message((10, 0), (20, 0))
    spoilt = getattr(data.moving_object[0].base, field)
    for name, number in value.items():
        setattr(spoilt, name, number)
    assert read(part, data) == [[20, 0]]
    assert (part["left_out"], part["messages"], part["malformed"]) == (1, 1, 0)


def test_no_place_and_no_probability_leave_out_one_object(new_part: NewPart) -> None:
    part = new_part("osi_detections")
    part.init()
    data = message((10, 0), (20, 0))
    data.moving_object.add()
    data.moving_object[0].header.existence_probability = NAN
    assert read(part, data) == [[20, 0]]
    assert part["left_out"] == 2


GOOD = b"\x6a\x0d\x12\x0b\x12\x09\x09" + bytes(6) + b"\x24\x40"  # one object, 10 m ahead


@pytest.mark.parametrize(
    "data",
    [
        GOOD[:-1],
        GOOD + b"\x6a",  # a field that ends behind its head
        GOOD + b"\x6a\xff\x01",  # one that is longer than what is left
        GOOD + b"\x6a\xff\xff\xff\xff\xff\xff\xff\xff\xff\x01",  # of 2^64 - 1 bytes
        GOOD + b"\x10" + b"\xff" * 10,  # a varint that does not end
        GOOD + b"\x10" + b"\xff" * 9 + b"\x02",  # and one of 65 bits
        GOOD + b"\x00\x00",  # a field of number 0
        GOOD + b"\xf8\xff\xff\xff\x1f\x00",  # and one beyond the largest
        GOOD + b"\x0b\x0c",  # a group
        GOOD + b"\x0e",  # types that do not exist
        GOOD + b"\x0f",
        b"\x6a\x03\x12\x04\x12" + GOOD,  # what is within ends behind what it is in
    ],
)
def test_bytes_that_are_no_message_change_nothing_and_are_counted(new_part: NewPart, data: bytes) -> None:
    part = new_part("osi_detections")
    part.init()
    assert read(part, message((33, 0))) == [[33, 0]]
    assert read(part, data) == [[33, 0]]
    assert (part["malformed"], part["messages"], part["scan.number"]) == (1, 1, 1)
    assert read(part, GOOD) == [[10, 0]]


@pytest.mark.parametrize(
    "data",
    [
        b"\x6d\x01\x02\x03\x04" + GOOD,  # known numbers of other types
        b"\x69" + bytes(8) + GOOD,
        b"\x68\x07" + GOOD,
        GOOD + b"\xfa\xff\xff\xff\x0f\x02\xff\xff",  # the largest number
        b"\xea\x80\x00\x0d" + GOOD[2:],  # a head in more bytes than it takes
        b"\x6a\x1a\x12\x0b\x12\x09\x09" + bytes(8) + GOOD[2:],  # said twice: the last holds
    ],
)  # fmt: skip
def test_what_is_unknown_or_said_otherwise_is_read_as_others_read_it(new_part: NewPart, data: bytes) -> None:
    part = new_part("osi_detections")
    part.init()
    expected = SensorData.FromString(data)
    assert [o.base.position.x for o in expected.moving_object] == [10]
    assert read(part, data) == [[10, 0]]


def corpus() -> list[bytes]:
    data = message((10, 1), (20, -3))
    for one in data.moving_object:
        one.base.dimension.length, one.base.dimension.width, one.base.velocity.y = 4, 2, 3
        one.base_rmse.position.x = 0.1
        one.candidate.add(probability=1, type=2).vehicle_classification.type = 4
        one.header.existence_probability = 1
    data.stationary_object.add().base.position.x = 40
    data.timestamp.seconds, data.last_measurement_time.nanos = 3, 7
    radar = data.feature_data.radar_sensor.add().detection.add(snr=20, radial_velocity=1, classification=1)
    radar.position.distance = 12
    data.feature_data.lidar_sensor.add().detection.add(radial_velocity=1).position.distance = 12
    data.sensor_view.add().global_ground_truth.moving_object.add().base.position.x = 1
    return [data.SerializeToString(), GOOD]


def spoilt(chance: random.Random, data: bytes) -> bytes:
    found = bytearray(data)
    for _ in range(chance.randint(1, 4)):
        at = chance.randrange(len(found) + 1)
        match chance.randrange(4):
            case 0:
                found[at:] = b""
            case 1:
                found[at:at] = chance.choice([b"\xff", b"\x80\x80", b"\x0b", b"\x6a", bytes([chance.randrange(256)])])
            case 2:
                del found[at : at + chance.randint(1, 9)]
            case _ if at < len(found):
                found[at] = chance.randrange(256)
    return bytes(found)


def test_what_osi_python_reads_is_read_whatever_else_is_in_it(new_part: NewPart) -> None:
    parts = [new_part("osi_detections", takes=kind, least_existence=0) for kind in ("objects", "radar", "lidar")]
    for part in parts:
        part.init()
    chance, read_by_both = random.Random(5), 0  # noqa: S311  # no secret
    for _ in range(2000):
        data = spoilt(chance, chance.choice(corpus()))
        try:
            theirs = SensorData.FromString(data)
        except DecodeError:
            theirs = None
        for part in parts:
            before = part["messages"], part["malformed"]
            read(part, data)
            ours = part["messages"] > before[0]
            assert not data or ours or part["malformed"] > before[1]
            if theirs is not None and data:
                # Groups, which it skips, are an error to us.
                assert ours or any(byte & 7 in (3, 4) for byte in data)
                read_by_both += ours
        for values in (told(part, ("range", "azimuth", "range_rate", "range_deviation", "width")) for part in parts):
            assert np.isfinite(np.array(values)).all()
    assert read_by_both > 400


DRIVER = """
#include "osi_detections.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
int main(void) {
    osi_detections *self = calloc(1, sizeof *self);
    unsigned size;
    self->par.azimuth_deviation = self->par.range_deviation = self->par.rate_deviation = 0.1;
    osi_detections_init(self);
    while (fread(&size, sizeof size, 1, stdin) == 1) {
        /* The bytes end where the room does, so that a step beyond is seen. */
        uint8_t *end = self->in.data.data + OSI_DATA_ROOM - size;
        self->in.data.size = size;
        if (fread(end, 1, size, stdin) != size) return 2;
        uint8_t *own = malloc(size ? size : 1);
        memcpy(own, end, size);
        memcpy(self->in.data.data, own, size);
        free(own);
        for (self->par.takes = 0; self->par.takes < 3; ++self->par.takes) osi_detections_step(self);
    }
    printf("%d %d\\n", self->out.messages, self->out.malformed);
    free(self);
    return 0;
}
"""


@pytest.mark.thorough
def test_no_bytes_make_the_reader_do_what_is_undefined(tmp_path: Path) -> None:
    osi = ROOT / "components/osi"
    (tmp_path / "drive.c").write_text(DRIVER, encoding="utf-8")
    sources = [osi / "osi_detections/osi_detections.c", osi / "protobuf/protobuf.c", tmp_path / "drive.c"]
    options = ["-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-O1", "-g", f"-I{osi / 'osi_detections'}"]
    command = [*find_compiler().command, *options, *map(str, sources), "-o", str(tmp_path / "drive"), "-lm"]
    if subprocess.run(command, capture_output=True, check=False).returncode != 0:
        pytest.skip("this compiler has no sanitizers")
    chance = random.Random(8)  # noqa: S311  # no secret
    messages = [spoilt(chance, data) for data in corpus() for _ in range(4000)]
    messages += [data[:n] for data in corpus() for n in range(len(data))]
    told_to = b"".join(len(data).to_bytes(ctypes.sizeof(ctypes.c_uint), "little") + data for data in messages)
    ran = subprocess.run([str(tmp_path / "drive")], input=told_to, capture_output=True, check=False, env=os.environ)
    assert ran.stderr == b""
    good, bad = map(int, ran.stdout.split())
    assert good > 1000
    assert bad > 1000
