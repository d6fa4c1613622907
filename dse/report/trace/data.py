"""What a trace file contains: a scene with all signals, and the tracks that its trackers output."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field

from dse.domain.component import Type
from dse.report.content.data import Floats
from dse.report.scene.data import Scene
from dse.report.scene.from_signals import SceneSignals

_TRACK = re.compile(r"^(.+)\.(\w+)\[1\]\.existence$")
_TRACKED = ("id", "class", "x", "y", "vx", "vy", "width", "age", "existence")


@dataclass(frozen=True, slots=True, eq=False)
class Tracker:
    """The *part* that outputs tracks: *columns* over time of each of its places."""

    part: str
    columns: tuple[Mapping[str, Floats], ...]


@dataclass(frozen=True, slots=True, eq=False)
class Trace:
    """A *scene* with the *signals* (SI, by ``part.port``) of its run and their *types*.

    *rear_axle*: distance in m from the centre of gravity back to the rear axle, the origin of OSI's vehicle
    coordinates. It is 0 if the chassis does not state it: coordinates are then relative to the centre of gravity.
    *plots*: signals that are looked at together, by the title of the bench's figure.
    """

    scene: Scene
    signals: Mapping[str, Floats]
    types: Mapping[str, Type]
    rear_axle: float
    plots: Mapping[str, tuple[str, ...]] = field(default_factory=dict)

    @property
    def trackers(self) -> Iterator[Tracker]:
        """The parts that output tracks."""
        for part, stem in _tracks(self.signals):
            count = 1
            while f"{stem}[{count + 1}].id" in self.signals:
                count += 1
            places = range(1, count + 1)
            columns = tuple({port: self.signals[f"{stem}[{n}].{port}"] for port in _TRACKED} for n in places)
            yield Tracker(part, columns)


def parts_with(message: str, told: SceneSignals) -> tuple[str, ...]:
    """The parts with messages of the type *message*, sensor_view or sensor_data, in a run with these signals."""
    trackers = (part for part, _ in _tracks(told.signals)) if message == "sensor_data" else ()
    return (*told.sensor_parts, *trackers)


def _tracks(signals: Iterable[str]) -> Iterator[tuple[str, str]]:
    """Each part that outputs tracks, and the stem of their names."""
    for name in sorted(signals):
        if found := _TRACK.match(name):
            yield found[1], f"{found[1]}.{found[2]}"


def rear_axle_of(settings: Mapping[str, float]) -> float:
    """From the *settings* of a run by ``part.parameter``: wheelbase and share of the weight on the front axle, in m."""
    chassis = [name.removesuffix(".front_load_share") for name in settings if name.endswith(".front_load_share")]
    found = (settings[f"{part}.front_load_share"] * settings.get(f"{part}.wheelbase", 0.0) for part in chassis)
    return next(found, 0.0)
