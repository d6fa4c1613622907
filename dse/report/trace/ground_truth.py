"""GroundTruth messages of ASAM OSI 3.8: one for each moment of a run.

OSI places the middle of boxes; a scene has the host's centre of gravity, and the ground below the middle of others.
The host has the identifier 0, other road users their own. Lanes and their boundaries are in the first message only, as
they do not change. Left out because a run does not contain it: axles and lamps of others, types of lane markings.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from dse.report.scene.data import CLASSES, COLOURS

if TYPE_CHECKING:
    from dse.report.content.data import Floats
    from dse.report.trace.data import Trace

HOST = 0
"""Identifier of the host."""

FIRST_LANE, FIRST_LIGHT = 1_000_000, 2_000_000
"""Identifiers of lanes (with two boundaries each: lane, left, right) and of traffic lights begin here."""

_MM_PER_HOUR = 3.6e6
_RAIN = (0.1, 0.5, 1.9, 8.1, 34, 149)  # mm/h
_SIGHT = (50, 200, 1000, 2000, 4000, 10000, 40000)  # m
_LIGHT = (0.01, 1, 3, 10, 20, 400, 1000, 10000)  # lx
_VEHICLES = {"car": "TYPE_CAR", "truck": "TYPE_HEAVY_TRUCK", "motorcycle": "TYPE_MOTORCYCLE", "bicycle": "TYPE_BICYCLE"}
_LAMPS = {"red": ("RED",), "red_yellow": ("RED", "YELLOW"), "yellow": ("YELLOW",), "green": ("GREEN",), "off": ()}
_LAMP_SPACING = 0.3  # m between the lamps of a traffic light; assumed


def ground_truths(trace: Trace) -> Iterator[Any]:
    """A ``GroundTruth`` for each moment of *trace*."""
    from osi3.osi_groundtruth_pb2 import GroundTruth

    for at, moment in enumerate(trace.scene.time):
        message = GroundTruth()
        head(message, float(moment))
        message.host_vehicle_id.value = HOST
        if at == 0:
            _put_lanes(message, trace)
        _put_host(message.moving_object.add(), trace, at)
        for other in trace.scene.others:
            _put_other(message, other, at)
        _put_lights(message, trace, at)
        _put_weather(message.environmental_conditions, trace.scene.weather, at)
        yield message


def head(message: Any, moment: float) -> None:
    """Set the version and the time of *message*: *moment* s after the start of the run."""
    from osi3.osi_version_pb2 import InterfaceVersion, current_interface_version

    message.version.CopyFrom(InterfaceVersion.DESCRIPTOR.file.GetOptions().Extensions[current_interface_version])
    put_time(message.timestamp, moment)


def put_time(stamp: Any, moment: float) -> None:
    """Set *stamp* to *moment* in s, to the nanosecond."""
    stamp.seconds, stamp.nanos = divmod(round(moment * 1e9), 1_000_000_000)


def put_vector(vector: Any, *values: float) -> None:
    """Set x, y and perhaps z."""
    for name, value in zip("xyz", values, strict=False):
        setattr(vector, name, value)


def _put_host(item: Any, trace: Trace, at: int) -> None:
    from osi3.osi_object_pb2 import MovingObject

    host = trace.scene.host
    row = {name: float(values[at]) for name, values in host.columns.items()}
    ahead, up = host.front - host.length / 2, host.height / 2
    heading, rate = row["heading"], row.get("yaw_rate", 0.0)
    speed, lateral = row["speed"], row.get("lateral_speed", 0.0)
    item.id.value, item.type = HOST, MovingObject.TYPE_VEHICLE
    base = item.base
    base.dimension.length, base.dimension.width, base.dimension.height = host.length, host.width, host.height
    x, y = _turned(heading, ahead, 0.0)
    put_vector(base.position, row["x"] + x, row["y"] + y, row["z"] + up)
    base.orientation.roll, base.orientation.pitch = row["roll"], row["pitch"]
    base.orientation.yaw = _within_turn(heading)
    put_vector(base.velocity, *_turned(heading, speed, lateral + rate * ahead), 0.0)
    if "acceleration" in row:
        felt = row["acceleration"] - rate * rate * ahead, row.get("lateral_acceleration", 0.0)
        put_vector(base.acceleration, *_turned(heading, *felt), 0.0)
    base.orientation_rate.yaw = rate
    attributes = item.vehicle_attributes
    attributes.number_wheels = 4
    put_vector(attributes.bbcenter_to_rear, -trace.rear_axle - ahead, 0.0, -up)
    item.vehicle_classification.type = MovingObject.VehicleClassification.TYPE_CAR


def _put_other(message: Any, other: Mapping[str, Floats], at: int) -> None:
    from osi3.osi_object_pb2 import StationaryObject

    row = {name: float(values[at]) for name, values in other.items()}
    kind, clearance = CLASSES[int(row["class"])], row.get("clearance", 0.0)
    if kind == "none":
        return
    item = message.stationary_object.add() if kind == "obstacle" else message.moving_object.add()
    item.id.value = int(row["id"])
    base = item.base
    base.dimension.length, base.dimension.width = row["length"], row["width"]
    base.dimension.height = row["height"] - clearance
    put_vector(base.position, row["x"], row["y"], row["z"] + (row["height"] + clearance) / 2)
    base.orientation.yaw = _within_turn(row["heading"])
    if kind == "obstacle":
        classified = StationaryObject.Classification
        item.classification.type = classified.TYPE_OTHER
        item.classification.material = classified.MATERIAL_OTHER
        item.classification.density = classified.DENSITY_OTHER
        return
    put_vector(base.velocity, *_turned(row["heading"], row["speed"], row.get("lateral_speed", 0.0)), 0.0)
    if "acceleration" in row:
        put_vector(base.acceleration, *_turned(row["heading"], row["acceleration"], 0.0), 0.0)
    put_type(item, kind)
    if kind == "pedestrian":
        item.pedestrian_attributes.SetInParent()
    else:
        item.vehicle_attributes.SetInParent()


def put_type(item: Any, kind: str) -> None:
    """Set the type of a moving object to the class *kind* of the scene."""
    from osi3.osi_object_pb2 import MovingObject

    if kind in _VEHICLES:
        item.type = MovingObject.TYPE_VEHICLE
        item.vehicle_classification.type = MovingObject.VehicleClassification.Type.Value(_VEHICLES[kind])
    else:
        item.type = MovingObject.TYPE_PEDESTRIAN if kind == "pedestrian" else MovingObject.TYPE_OTHER


def _put_lanes(message: Any, trace: Trace) -> None:
    from osi3.osi_lane_pb2 import Lane, LaneBoundary

    for number, strip in enumerate(trace.scene.ground.strips):
        first = FIRST_LANE + 3 * number
        kind = Lane.Classification.TYPE_INTERSECTION if strip.is_inside else Lane.Classification.TYPE_DRIVING
        lane = message.lane.add()
        lane.id.value = first
        lane.classification.type = kind if strip.is_driven else Lane.Classification.TYPE_NONDRIVING
        sides = [np.column_stack(side) for side in ((strip.left, strip.left_height), (strip.right, strip.right_height))]
        lane.classification.centerline_is_driving_direction = strip.is_driven
        for point in (sides[0] + sides[1]) / 2:
            put_vector(lane.classification.centerline.add(), *map(float, point))
        sides_of = (lane.classification.left_lane_boundary_id, lane.classification.right_lane_boundary_id)
        for place, (ids, side) in enumerate(zip(sides_of, sides, strict=True), 1):
            boundary = message.lane_boundary.add()
            boundary.id.value = ids.add().value = first + place
            boundary.classification.type = LaneBoundary.Classification.TYPE_UNKNOWN
            for point in side:
                put_vector(boundary.boundary_line.add().position, *map(float, point))


def _put_lights(message: Any, trace: Trace, at: int) -> None:
    """One item for each lamp, as OSI demands; a light whose colour is not output is left out."""
    from osi3.osi_trafficlight_pb2 import TrafficLight

    lamps = TrafficLight.Classification
    for number, light in enumerate(trace.scene.ground.lights):
        told = trace.scene.lights.get(light.id)
        if told is None or COLOURS[int(told[at])] == "none":
            continue
        lit = _LAMPS[COLOURS[int(told[at])]]
        for place, colour in enumerate(("RED", "YELLOW", "GREEN")):
            item = message.traffic_light.add()
            item.id.value = FIRST_LIGHT + 3 * number + place
            put_vector(item.base.position, float(light.place[0]), float(light.place[1]))
            item.base.position.z = float(light.place[2]) + (1 - place) * _LAMP_SPACING
            item.base.orientation.yaw = _within_turn(light.heading + np.pi)
            item.classification.color = lamps.Color.Value(f"COLOR_{colour}")
            item.classification.icon = lamps.ICON_NONE
            item.classification.mode = lamps.MODE_CONSTANT if colour in lit else lamps.MODE_OFF


def _put_weather(conditions: Any, weather: Mapping[str, Floats], at: int) -> None:
    """By the steps of OSI: mm/h of water, visibility at which 5 % of the light remain, and lx.

    Light is assumed to fall from 100,000 lx in daylight to 0.001 lx at night, by equal powers of ten.
    """
    fog, rain, snow, darkness = (float(weather[name][at]) for name in ("fog", "rain", "snow", "darkness"))
    sight = -np.log(0.05) / fog if fog > 0 else np.inf
    conditions.ambient_illumination = 2 + _step(10 ** (5 - 8 * darkness), _LIGHT)
    conditions.precipitation = 2 + _step((rain + snow) * _MM_PER_HOUR, _RAIN)
    conditions.fog = 9 - _step(sight, _SIGHT)


def _step(value: float, steps: tuple[float, ...]) -> int:
    return int(np.searchsorted(steps, value, side="right"))


def _turned(angle: float, ahead: float, left: float) -> tuple[float, float]:
    c, s = float(np.cos(angle)), float(np.sin(angle))
    return c * ahead - s * left, s * ahead + c * left


def _within_turn(angle: float) -> float:
    return float(np.remainder(angle + np.pi, 2 * np.pi) - np.pi)
