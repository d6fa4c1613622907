"""Trace files: ``.osi``, messages of one type one after the other, and ``.mcap``, channels with their schemas."""

from __future__ import annotations

import importlib.util
import io
import json
import struct
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dse.errors import fail
from dse.report.trace.foxglove import picture, returns, road, road_users, transforms
from dse.report.trace.ground_truth import ground_truths
from dse.report.trace.rows import row_of, schema_of, trees_of
from dse.report.trace.sensor_data import sensor_data, sensor_views
from dse.scratch import written_whole

if TYPE_CHECKING:
    from dse.report.scene.data import Scene
    from dse.report.trace.data import Trace

MESSAGES = ("ground_truth", "sensor_view", "sensor_data")
"""What a file of one type can contain."""

_OSI_VERSION = "3.8.0"
_PACKAGES = ("osi3", "mcap", "mcap_protobuf", "foxglove_schemas_protobuf")
_QUALITY = 85  # of JPEG
Frames = Iterator[tuple[float, bytes]]


def require_packages() -> None:
    """Raise DseError if the packages that write traces are not installed."""
    missing = [name for name in _PACKAGES if importlib.util.find_spec(name) is None]
    if missing:
        raise fail(
            f"traces need packages that are not installed: {', '.join(missing)}",
            hint="pip install 'dse-workbench[traces]'",
        )


def write_osi(trace: Trace, target: Path, message: str = "ground_truth", of: str = "") -> int:
    """Write the messages of one type, of the sensor or tracker *of*, each after its length (4 bytes, little-endian).

    Returns how many. Raises DseError if there is no such sensor, or more than one and none is named.
    """
    if message == "ground_truth":
        messages = ground_truths(trace)
    else:
        found = dict(sensor_views(trace) if message == "sensor_view" else sensor_data(trace))
        messages = found[chosen_part(tuple(found), message, of)]
    count = 0
    with written_whole(target) as path, path.open("wb") as file:
        for each in messages:
            data = each.SerializeToString(deterministic=True)
            file.write(struct.pack("<I", len(data)) + data)
            count += 1
    return count


def chosen_part(found: Sequence[str], message: str, of: str) -> str:
    """*of*, else the only one of the parts *found* that have a *message*. Raises DseError as `write_osi` does."""
    names = ", ".join(found)
    if not found:
        raise fail(f"the run has no sensor, so no {message} messages", hint="take --message ground_truth")
    if not of and len(found) > 1:
        raise fail(f"a file contains the {message} messages of one part", hint=f"name one with --part: {names}")
    if of and of not in found:
        raise fail(f"'{of}' has no {message} messages", hint=f"those that have: {names}")
    return of or found[0]


def write_mcap(trace: Trace, target: Path, frames: Frames | None = None) -> dict[str, int]:
    """Write all of *trace*, and the *frames* (s, JPEG) if there are any; returns the number of messages by topic."""
    from mcap.writer import Writer

    with written_whole(target) as path, path.open("wb") as file:
        writer: Any = Writer(file)
        writer.start(profile="", library="dse")
        channels = _Channels(writer)
        writer.add_metadata("net.asam.osi.trace", _metadata(trace.scene))
        channels.put("/scene/road", 0, road(trace))
        streams = {
            "/tf": transforms(trace),
            "/scene/road_users": road_users(trace),
            **{f"/scene/{sensor.name}": returns(trace, sensor) for sensor in trace.scene.sensors},
            "/osi/ground_truth": ground_truths(trace),
            **{f"/osi/sensor_data/{name}": messages for name, messages in sensor_data(trace)},
        }
        trees = trees_of(trace.signals)
        schemas = {part: {**schema_of(tree, trace.types), "title": part} for part, tree in trees.items()}
        pictures = list(frames or ())
        for at, moment in enumerate(trace.scene.time):
            nanoseconds = round(float(moment) * 1e9)
            for topic, messages in streams.items():
                channels.put(topic, nanoseconds, next(messages))
            for part, tree in trees.items():
                channels.put_row(f"/signals/{part}", nanoseconds, row_of(tree, trace.signals, at), schemas[part])
            while pictures and pictures[0][0] <= float(moment) + 1e-9:
                taken, data = pictures.pop(0)
                channels.put("/camera", nanoseconds, picture(data, "jpeg", taken))
        writer.finish()
    return channels.counts


class _Channels:
    """The channels of a file: a schema for each type of message, a channel for each topic."""

    def __init__(self, writer: Any) -> None:
        self._writer = writer
        self._schemas: dict[str, int] = {}
        self._channels: dict[str, int] = {}
        self.counts: dict[str, int] = {}

    def put(self, topic: str, nanoseconds: int, message: Any) -> None:
        """Add a protobuf *message*."""
        if topic not in self._channels:
            from mcap_protobuf.schema import register_schema

            kind = type(message)
            name = kind.DESCRIPTOR.full_name
            if name not in self._schemas:
                self._schemas[name] = register_schema(self._writer, kind)
            about = _osi_channel(name) if name.startswith("osi3.") else {}
            self._channels[topic] = self._writer.register_channel(topic, "protobuf", self._schemas[name], about)
        self._add(topic, nanoseconds, message.SerializeToString(deterministic=True))

    def put_row(self, topic: str, nanoseconds: int, row: object, schema: Mapping[str, object]) -> None:
        """Add *row* as JSON."""
        if topic not in self._channels:
            found = self._writer.register_schema(topic.strip("/"), "jsonschema", json.dumps(schema).encode())
            self._channels[topic] = self._writer.register_channel(topic, "json", found)
        self._add(topic, nanoseconds, json.dumps(row, separators=(",", ":")).encode())

    def _add(self, topic: str, nanoseconds: int, data: bytes) -> None:
        self._writer.add_message(self._channels[topic], nanoseconds, data, nanoseconds)
        self.counts[topic] = self.counts.get(topic, 0) + 1


def _metadata(scene: Scene) -> dict[str, str]:
    """What OSI's trace format requires; no time of creation, so that the same run gives the same bytes."""
    from google.protobuf import __version__

    return {
        "version": _OSI_VERSION,
        "min_osi_version": _OSI_VERSION,
        "max_osi_version": _OSI_VERSION,
        "min_protobuf_version": __version__,
        "max_protobuf_version": __version__,
        "description": f"{scene.title}, {scene.subtitle}",
    }


def _osi_channel(name: str) -> dict[str, str]:
    from google.protobuf import __version__

    stem = "net.asam.osi.trace.channel"
    return {
        f"{stem}.osi_version": _OSI_VERSION,
        f"{stem}.protobuf_version": __version__,
        f"{stem}.description": name,
    }


def frames_of(scene: Scene, rate: float, view: str, size: tuple[int, int], tell: Callable[[str], None]) -> Frames:
    """Pictures of *scene* without its numbers as JPEG, *rate* a second, with the time in s of each.

    Raises DseError without Chromium.
    """
    from PIL import Image  # matplotlib brings it

    from dse.report.scene.camera import camera_on
    from dse.report.scene.html import scene_page

    # What a camera sees: the signals are in other channels, and so are the sensors.
    seen = replace(scene, title="", subtitle="", instruments=(), sensors=())
    with camera_on(scene_page(seen), size) as camera:
        count = int(camera.seconds * rate + 1e-9) + 1
        for number in range(count):
            tell(f"picture {number + 1} of {count}")
            file = io.BytesIO()
            picture_of = Image.open(io.BytesIO(camera.picture(number / rate, view)))
            picture_of.convert("RGB").save(file, "JPEG", quality=_QUALITY)
            yield number / rate, file.getvalue()
