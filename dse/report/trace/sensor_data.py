"""SensorData messages of ASAM OSI 3.8: what a sensor returns or a tracker outputs, one for each moment of a run.

Returns of a sensor that measures range rates are radar detections; those of other sensors are detected objects. Both
are in the frame of the sensor's mounting. Tracks are detected objects in vehicle coordinates, whose origin is the rear
axle. Velocities of detected objects are relative to the host; OSI counts radial velocities towards the sensor.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from dse.report.scene.data import CLASSES
from dse.report.trace.ground_truth import HOST, ground_truths, head, put_time, put_type, put_vector

if TYPE_CHECKING:
    from dse.report.content.data import Floats
    from dse.report.scene.data import Sensor
    from dse.report.trace.data import Trace, Tracker

_FIRST_SENSOR, _FIRST_TRACKER = 10_000, 20_000


def sensor_data(trace: Trace) -> Iterator[tuple[str, Iterator[Any]]]:
    """For each sensor and tracker of *trace* its name and a ``SensorData`` for each moment."""
    for number, sensor in enumerate(trace.scene.sensors):
        yield sensor.name, _of_sensor(trace, sensor, _FIRST_SENSOR + number)
    for number, tracker in enumerate(trace.trackers):
        yield tracker.part, _of_tracker(trace, tracker, _FIRST_TRACKER + number)


def sensor_views(trace: Trace) -> Iterator[tuple[str, Iterator[Any]]]:
    """For each sensor of *trace* its name and a ``SensorView`` for each moment: its mounting and the ground truth."""
    for number, sensor in enumerate(trace.scene.sensors):
        yield sensor.name, _views(trace, sensor, _FIRST_SENSOR + number)


def _views(trace: Trace, sensor: Sensor, identifier: int) -> Iterator[Any]:
    from osi3.osi_sensorview_pb2 import SensorView

    for truth, moment in zip(ground_truths(trace), trace.scene.time, strict=True):
        message = SensorView()
        head(message, float(moment))
        message.sensor_id.value = identifier
        _put_mounting(message.mounting_position, trace, sensor)
        message.global_ground_truth.CopyFrom(truth)
        message.host_vehicle_id.value = HOST
        yield message


def _of_sensor(trace: Trace, sensor: Sensor, identifier: int) -> Iterator[Any]:
    from osi3.osi_sensordata_pb2 import SensorData

    for at, moment in enumerate(trace.scene.time):
        message = SensorData()
        head(message, float(moment))
        message.sensor_id.value = identifier
        _put_mounting(message.mounting_position, trace, sensor)
        scan = {name: float(values[at]) for name, values in sensor.scan.items()}
        measured = float(moment) - scan.get("age", 0.0)
        put_time(message.last_measurement_time, max(measured, 0.0))
        rows = [{name: float(values[at]) for name, values in each.items()} for each in sensor.returns]
        rows = [row for row in rows if row["valid"] > 0]
        if any("rate_deviation" in each for each in sensor.returns) and _measures_rates(sensor):
            _put_radar(message, rows, scan, measured, identifier)
        else:
            for row in rows:
                _put_return(message.moving_object.add(), row, identifier)
        yield message


def _put_mounting(mounting: Any, trace: Trace, sensor: Sensor) -> None:
    put_vector(mounting.position, sensor.mount + trace.rear_axle, sensor.left, 0.0)
    mounting.orientation.yaw = sensor.turn


def _measures_rates(sensor: Sensor) -> bool:
    return any(bool(np.any(each["rate_deviation"] > 0)) for each in sensor.returns)


def _put_radar(
    message: Any, rows: Sequence[Mapping[str, float]], scan: Mapping[str, float], measured: float, of: int
) -> None:
    from osi3.osi_featuredata_pb2 import SensorDetectionHeader

    radar = message.feature_data.radar_sensor.add()
    header = radar.header
    put_time(header.measurement_time, max(measured, 0.0))
    header.cycle_counter = int(scan.get("number", 0))
    header.number_of_valid_detections = len(rows)
    header.sensor_id.value = of
    header.data_qualifier = SensorDetectionHeader.DATA_QUALIFIER_AVAILABLE
    header.mounting_position.CopyFrom(message.mounting_position)
    for row in rows:
        item = radar.detection.add()
        item.position.distance, item.position.azimuth, item.position.elevation = row["range"], row["azimuth"], 0.0
        item.position_rmse.distance = row["range_deviation"]
        item.position_rmse.azimuth = row["azimuth_deviation"]
        item.radial_velocity, item.radial_velocity_rmse = -row["range_rate"], row["rate_deviation"]
        if row["strength"] > 0:
            item.snr = 10 * float(np.log10(row["strength"]))


def _put_return(item: Any, row: Mapping[str, float], identifier: int) -> None:
    item.header.sensor_id.add().value = identifier
    reach, angle = row["range"], row["azimuth"]
    put_vector(item.base.position, reach * float(np.cos(angle)), reach * float(np.sin(angle)), 0.0)
    if row.get("width", 0.0) > 0:
        item.base.dimension.width = row["width"]
    _put_class(item, int(row.get("class", 0)))


def _put_class(item: Any, number: int) -> None:
    if (kind := CLASSES[number]) != "none":
        candidate = item.candidate.add(probability=1.0)
        put_type(candidate, kind)


def _of_tracker(trace: Trace, tracker: Tracker, identifier: int) -> Iterator[Any]:
    from osi3.osi_sensordata_pb2 import SensorData

    host = trace.scene.host.columns
    some: Floats = np.zeros_like(host["speed"])
    lateral = host.get("lateral_speed", some)
    for at, moment in enumerate(trace.scene.time):
        message = SensorData()
        head(message, float(moment))
        message.sensor_id.value = identifier
        put_vector(message.mounting_position.position, 0.0, 0.0, 0.0)
        for place in tracker.columns:
            row = {name: float(values[at]) for name, values in place.items()}
            if row["id"] <= 0:
                continue
            item = message.moving_object.add()
            item.header.tracking_id.value = int(row["id"])
            item.header.existence_probability, item.header.age = row["existence"], row["age"]
            item.header.sensor_id.add().value = identifier
            put_vector(item.base.position, row["x"] + trace.rear_axle, row["y"], 0.0)
            put_vector(item.base.velocity, row["vx"] - float(host["speed"][at]), row["vy"] - float(lateral[at]), 0.0)
            if row["width"] > 0:
                item.base.dimension.width = row["width"]
            _put_class(item, int(row["class"]))
        yield message
