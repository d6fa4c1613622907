"""A run in the messages of Foxglove: roads, road users and sensor returns as a 3D scene, and transforms.

Frames: ``world``, and ``host`` with its origin at the centre of gravity, on the road.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from dse.report.scene.data import CLASSES
from dse.report.trace.ground_truth import put_vector

if TYPE_CHECKING:
    from dse.report.content.data import Floats
    from dse.report.scene.data import Ground, Sensor
    from dse.report.trace.data import Trace

WORLD, HOST = "world", "host"
_COLOURS: dict[str, tuple[float, float, float, float]] = {
    "road": (0.25, 0.26, 0.28, 1.0),
    "verge": (0.35, 0.37, 0.33, 1.0),
    "host": (0.12, 0.47, 0.71, 1.0),
    "car": (0.55, 0.57, 0.60, 1.0),
    "truck": (0.60, 0.45, 0.25, 1.0),
    "motorcycle": (0.45, 0.25, 0.55, 1.0),
    "bicycle": (0.25, 0.55, 0.35, 1.0),
    "pedestrian": (0.85, 0.55, 0.15, 1.0),
    "obstacle": (0.75, 0.20, 0.20, 1.0),
    "return": (0.95, 0.80, 0.10, 0.9),
    "white": (0.95, 0.95, 0.95, 1.0),
    "yellow": (0.95, 0.75, 0.15, 1.0),
}
_RETURN_SIZE, _MOUNTED = 0.6, 0.5  # m; the height of mountings is assumed
_LINE, _DASH, _GAP, _ABOVE = 0.12, 6.0, 12.0, 0.03  # m: of markings without a width; of broken ones; above the road


def transforms(trace: Trace) -> Iterator[Any]:
    """A ``foxglove.FrameTransforms`` for each moment: from ``world`` to ``host`` and to the mountings of sensors."""
    from foxglove_schemas_protobuf.FrameTransforms_pb2 import FrameTransforms

    host = trace.scene.host.columns
    for at, moment in enumerate(trace.scene.time):
        message = FrameTransforms()
        item = _transform(message, float(moment), WORLD, HOST)
        put_vector(item.translation, *(float(host[name][at]) for name in "xyz"))
        _put_rotation(item.rotation, *(float(host[name][at]) for name in ("roll", "pitch", "heading")))
        for sensor in trace.scene.sensors:
            item = _transform(message, float(moment), HOST, sensor.name)
            put_vector(item.translation, sensor.mount, sensor.left, _MOUNTED)
            _put_rotation(item.rotation, 0.0, 0.0, sensor.turn)
        yield message


def road(trace: Trace) -> Any:
    """A ``foxglove.SceneUpdate`` of what does not move: it stays until the trace ends."""
    from foxglove_schemas_protobuf.LinePrimitive_pb2 import LinePrimitive
    from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate

    message = SceneUpdate()
    for number, strip in enumerate(trace.scene.ground.strips):
        entity = message.entities.add(id=f"strip {number}", frame_id=WORLD)
        entity.timestamp.FromNanoseconds(0)
        band = entity.triangles.add()
        _put_colour(band.color, "road" if strip.is_driven else "verge")
        band.pose.orientation.w = 1.0
        sides = ((strip.left, strip.left_height), (strip.right, strip.right_height))
        left, right = (np.column_stack(side) for side in sides)
        for index in range(len(left) - 1):
            corners = left[index], right[index], left[index + 1], right[index + 1]
            for corner in (0, 1, 2, 2, 1, 3):
                put_vector(band.points.add(), *map(float, corners[corner]))
    for number, (points, kind, width, colour) in enumerate(_markings(trace.scene.ground)):
        entity = message.entities.add(id=f"marking {number}", frame_id=WORLD)
        entity.timestamp.FromNanoseconds(0)
        line = entity.lines.add(type=LinePrimitive.LINE_LIST, thickness=width)
        _put_colour(line.color, colour if colour in _COLOURS else "white")
        line.pose.orientation.w = 1.0
        for point in _dashes(points) if "broken" in kind else np.repeat(points, 2, axis=0)[1:-1]:
            put_vector(line.points.add(), float(point[0]), float(point[1]), float(point[2]) + _ABOVE)
    return message


def _markings(ground: Ground) -> Iterator[tuple[Floats, str, float, str]]:
    """Line, kind, width in m and colour of each marking: those of the road's file, else the borders of its lanes."""
    for marking in ground.markings:
        if marking.kind != "none":
            yield marking.line, marking.kind, marking.width, marking.colour
    for strip in () if ground.markings else ground.strips:
        if strip.is_driven and not strip.is_inside:
            for border, height in ((strip.left, strip.left_height), (strip.right, strip.right_height)):
                yield np.column_stack([border, height]), "solid", _LINE, "white"


def _dashes(line: Floats) -> Floats:
    """Both ends of each dash along *line* (n, 3): (m, 3)."""
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line[:, :2], axis=0).T))])
    starts = np.arange(0.0, along[-1], _DASH + _GAP)
    ends = np.column_stack([starts, np.minimum(starts + _DASH, along[-1])]).ravel()
    return np.column_stack([np.interp(ends, along, line[:, axis]) for axis in range(3)])


def road_users(trace: Trace) -> Iterator[Any]:
    """A ``foxglove.SceneUpdate`` of the host and of all road users for each moment; it replaces the one before."""
    host = trace.scene.host
    for at, moment, message in _updates(trace):
        cube = _entity(message, moment, "host", HOST).cubes.add()
        _put_colour(cube.color, "host")
        put_vector(cube.size, host.length, host.width, host.height)
        put_vector(cube.pose.position, host.front - host.length / 2, 0.0, host.height / 2)
        cube.pose.orientation.w = 1.0
        for other in trace.scene.others:
            row = {name: float(values[at]) for name, values in other.items()}
            kind = CLASSES[int(row["class"])]
            if kind == "none":
                continue
            cube = _entity(message, moment, f"{kind} {int(row['id'])}", WORLD).cubes.add()
            _put_colour(cube.color, kind)
            clearance = row.get("clearance", 0.0)
            put_vector(cube.size, row["length"], row["width"], row["height"] - clearance)
            put_vector(cube.pose.position, row["x"], row["y"], row["z"] + (row["height"] + clearance) / 2)
            _put_rotation(cube.pose.orientation, 0.0, 0.0, row["heading"])
        yield message


def returns(trace: Trace, sensor: Sensor) -> Iterator[Any]:
    """A ``foxglove.SceneUpdate`` of what *sensor* returns, in the frame of its mounting, for each moment."""
    for at, moment, message in _updates(trace):
        entity = _entity(message, moment, sensor.name, sensor.name)
        for each in sensor.returns:
            if each["valid"][at] > 0:
                reach, angle = float(each["range"][at]), float(each["azimuth"][at])
                sphere = entity.spheres.add()
                _put_colour(sphere.color, "return")
                put_vector(sphere.size, _RETURN_SIZE, _RETURN_SIZE, _RETURN_SIZE)
                put_vector(sphere.pose.position, reach * np.cos(angle), reach * np.sin(angle), 0.0)
                sphere.pose.orientation.w = 1.0
        yield message


def _updates(trace: Trace) -> Iterator[tuple[int, float, Any]]:
    """For each moment its number, its time in s, and an update that deletes all entities of the one before."""
    from foxglove_schemas_protobuf.SceneEntityDeletion_pb2 import SceneEntityDeletion
    from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate

    for at, moment in enumerate(map(float, trace.scene.time)):
        message = SceneUpdate()
        message.deletions.add(type=SceneEntityDeletion.ALL).timestamp.FromNanoseconds(_nanoseconds(moment))
        yield at, moment, message


def picture(data: bytes, kind: str, moment: float) -> Any:
    """A ``foxglove.CompressedImage`` of an encoded picture."""
    from foxglove_schemas_protobuf.CompressedImage_pb2 import CompressedImage

    message = CompressedImage(data=data, format=kind, frame_id=HOST)
    message.timestamp.FromNanoseconds(_nanoseconds(moment))
    return message


def _nanoseconds(moment: float) -> int:
    return round(float(moment) * 1e9)


def _transform(message: Any, moment: float, parent: str, child: str) -> Any:
    item = message.transforms.add(parent_frame_id=parent, child_frame_id=child)
    item.timestamp.FromNanoseconds(_nanoseconds(moment))
    return item


def _entity(message: Any, moment: float, identifier: str, frame: str) -> Any:
    entity = message.entities.add(id=identifier, frame_id=frame)
    entity.timestamp.FromNanoseconds(_nanoseconds(moment))
    return entity


def _put_colour(colour: Any, name: str) -> None:
    colour.r, colour.g, colour.b, colour.a = _COLOURS[name]


def _put_rotation(rotation: Any, roll: float, pitch: float, yaw: float) -> None:
    """As a quaternion of the turns by *yaw* (z), *pitch* (y) and *roll* (x), one after the other, each in rad."""
    (cr, cp, cy), (sr, sp, sy) = (f(np.array([roll, pitch, yaw]) / 2) for f in (np.cos, np.sin))
    rotation.w = float(cr * cp * cy + sr * sp * sy)
    rotation.x = float(sr * cp * cy - cr * sp * sy)
    rotation.y = float(cr * sp * cy + sr * cp * sy)
    rotation.z = float(cr * cp * sy - sr * sp * cy)
