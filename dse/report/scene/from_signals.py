"""From the signals of a run to its scene."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from dse.domain.bench import Figure
from dse.domain.component import Type
from dse.report.content.data import Floats
from dse.report.scene.data import Host, Instrument, Sensor
from dse.units import Unit

_MOTION = ("x", "y", "heading", "speed")
_ACTOR = ("id", "class", "length", "width", "height", "x", "y", "z", "heading", "speed")
_RETURN = ("valid", "range", "azimuth")
_WEATHER = {"fog": "fog_extinction", "rain": "rain_rate", "snow": "snow_rate", "darkness": "darkness"}
_MOTION_OF_TRACE = ("lateral_speed", "yaw_rate", "acceleration", "lateral_acceleration")
_ACTOR_OF_TRACE = ("clearance", "lateral_speed", "acceleration")
_RETURN_OF_TRACE = (
    "range_rate",
    "strength",
    "class",
    "width",
    "range_deviation",
    "azimuth_deviation",
    "rate_deviation",
)
_FURTHER = {"water": "surface.water_film", "azimuth": "sun.azimuth", "elevation": "sun.elevation"}
_LANE = {"limit": "speed_limit", "offset": "offset", "width": "width"}
_WHEELS = {"brake": "brake.torque", "drive": "powertrain.wheels"}
_LENGTH, _WIDTH, _HEIGHT, _FRONT, _RADIUS = 4.5, 1.8, 1.5, 2.3, 0.31


@dataclass(frozen=True)
class SceneSignals:
    """The parts of a configuration that tell what a scene shows, found by the ports they have.

    *signals* are all outputs by ``part.port``, *settings* what keeps one value in the run. *for_trace*: with all that a
    trace file contains, and that is not drawn.
    """

    signals: Mapping[str, Type]
    settings: Mapping[str, float]
    figures: tuple[Figure, ...]
    for_trace: bool = False

    @property
    def is_scene(self) -> bool:
        """Whether there is a car that says where it is."""
        return bool(self._car or self._lane)

    @property
    def wanted(self) -> tuple[str, ...]:
        """The signals that a run has to keep for its scene: all of them for a trace."""
        if self.for_trace:
            return tuple(sorted(self.signals))
        found = {name for name in self._names() if name in self.signals}
        found |= {end for f in self.figures for end in (f.current, f.target) if end and end in self.signals}
        return tuple(sorted(found | {name for name, type_ in self.signals.items() if type_.items and _is_shown(name)}))

    def host(self, columns: Mapping[str, Floats]) -> Host:
        """The car; one that only drives straight on is at y 0."""
        some = next(iter(columns.values()))
        zero = np.zeros_like(some)
        part = self._car or self._lane
        if self._car:
            motion = {axis: columns[f"{part}.motion.{axis}"] for axis in self._more(_MOTION, _MOTION_OF_TRACE)}
        else:
            motion = {"x": columns[f"{part}.position"], "y": zero, "heading": zero, "speed": columns[f"{part}.speed"]}
        further = {name: columns.get(f"{part}.{name}", zero) for name in ("roll", "pitch")}
        steering = next((columns[name] for name in columns if name.endswith(".steering")), zero)
        further |= {name: np.sum([columns[end] for end in ends], axis=0) for name, ends in self._wheels.items()}
        if f"{part}.wheel_speed.front" in columns:
            further["spin"] = columns[f"{part}.wheel_speed.front"]
        ground = [columns[f"{place}.height"] for place in self._places(f"{self._road}.ground", "height")]
        length = self._size("length", _LENGTH)
        assumed = {"width": _WIDTH, "front": min(_FRONT, length), "height": _HEIGHT}
        sizes = {"length": length, **{name: self._size(name, otherwise) for name, otherwise in assumed.items()}}
        return Host(
            {**motion, "z": np.mean(ground, axis=0) if ground else zero, **further, "steering": steering},
            **sizes,
            wheel=self._setting("wheel_radius", _RADIUS),
            doubts=tuple(self._doubts(sizes)),
        )

    def driver(self, columns: Mapping[str, Floats]) -> dict[str, Floats]:
        """What driver displays show, as far as there are signals for it."""
        return {name: columns[signal] for name, signal in self._displayed.items() if signal in columns}

    def others(self, columns: Mapping[str, Floats]) -> Iterator[dict[str, Floats]]:
        """Each place of a road user that anybody is in."""
        road = self._road
        for stem in self._places(f"{road}.actors", "x"):
            place = {name: columns[f"{stem}.{name}"] for name in self._more(_ACTOR, _ACTOR_OF_TRACE)}
            if np.any(place["class"] > 0):
                yield place
        if self._lane and f"{self._lane}.gap" in columns:
            yield self._lead(columns)

    def sensors(self, columns: Mapping[str, Floats], titles: Mapping[str, str]) -> Iterator[Sensor]:
        """What looks around and tells several objects, or one."""
        for part in self._scanning:
            places = self._places(f"{part}.scan.returns", "range")
            names = self._more(_RETURN, _RETURN_OF_TRACE)
            returns = tuple({name: columns[f"{place}.{name}"] for name in names} for place in places)
            scan = {name: columns[f"{part}.scan.{name}"] for name in self._more((), ("number", "age"))}
            yield self._sensor(part, titles, tuple(each for each in returns if np.any(each["valid"] > 0)), scan)
        for part in self._targeting:
            gap, seen = columns[f"{part}.target.gap"], columns[f"{part}.target.detected"]
            yield self._sensor(part, titles, ({"valid": seen, "range": gap, "azimuth": np.zeros_like(gap)},))

    def lights(self, columns: Mapping[str, Floats], ids: Sequence[str]) -> dict[str, Floats]:
        """What traffic lights show, as places in `COLOURS`: *ids* are those that the road tells, in its order."""
        places = (f"{stem}.colour" for stem in self._places(f"{self._road}.light_heads", "colour"))
        # Who told a light first goes on telling it: all paths see the same one.
        told: dict[str, Floats] = {}
        for id_, place in zip(ids, places, strict=False):
            told.setdefault(id_, columns[place])
        return told

    def weather(self, columns: Mapping[str, Floats]) -> dict[str, Floats]:
        """What is to be seen of it: 0 everywhere where no part tells."""
        zero = np.zeros_like(next(iter(columns.values())))
        stem = self._ending("visibility.fog_extinction")
        known = {name: columns.get(f"{stem}.visibility.{port}", zero) for name, port in _WEATHER.items()}
        further = {name: columns.get(f"{stem}.{port}") for name, port in _FURTHER.items()}
        return known | {name: values for name, values in further.items() if values is not None}

    def instruments(self, columns: Mapping[str, Floats]) -> Iterator[Instrument]:
        """The bench's figures, then what is one of several items, as a mode."""
        for figure in self.figures:
            current, target = (self._line(end, figure, columns) for end in (figure.current, figure.target))
            if current is not None:
                yield Instrument(figure.title or figure.name, str(figure.unit), current, target)
        for name, type_ in self.signals.items():
            if name in columns and type_.items and _is_shown(name):
                yield Instrument(name.replace(".", " "), "", columns[name], items=type_.items)

    @property
    def sensor_parts(self) -> tuple[str, ...]:
        """The parts that `sensors` gives."""
        return (*self._scanning, *self._targeting)

    @property
    def _scanning(self) -> list[str]:
        return sorted({name.split(".scan.")[0] for name in self.signals if ".scan.returns[" in name})

    @property
    def _targeting(self) -> list[str]:
        found = sorted(name.removesuffix(".target.gap") for name in self.signals if name.endswith(".target.gap"))
        return [part for part in found if f"{part}.max_range" in self.settings]

    def _more(self, drawn: tuple[str, ...], of_trace: tuple[str, ...]) -> tuple[str, ...]:
        return drawn + of_trace if self.for_trace else drawn

    def _names(self) -> Iterator[str]:
        part = self._car or self._lane
        yield from (f"{part}.motion.{axis}" for axis in _MOTION)
        yield from (f"{part}.{name}" for name in ("position", "speed", "gap", "lead.speed", "roll", "pitch"))
        yield from (name for name in self.signals if name.endswith(".steering"))
        yield from (f"{place}.height" for place in self._places(f"{self._road}.ground", "height"))
        yield from (f"{place}.{name}" for place in self._places(f"{self._road}.actors", "x") for name in _ACTOR)
        yield from (f"{place}.colour" for place in self._places(f"{self._road}.light_heads", "colour"))
        yield from (name for name in self.signals if re.search(r"\.scan\.returns\[\d+\]\.(valid|range|azimuth)$", name))
        yield from (name for name in self.signals if name.endswith((".target.gap", ".target.detected")))
        weather = self._ending("visibility.fog_extinction")
        yield from (f"{weather}.visibility.{port}" for port in _WEATHER.values())
        yield from (f"{weather}.{port}" for port in _FURTHER.values())
        yield from self._displayed.values()
        yield from (end for ends in self._wheels.values() for end in ends)
        yield f"{part}.wheel_speed.front"

    @property
    def _displayed(self) -> dict[str, str]:
        """Signals of driver displays: the own lane, and the vehicle ahead that the car has detected."""
        lane, target = self._ending("lane.on_road"), self._ending("target.detected")
        found = {name: f"{lane}.lane.{port}" for name, port in _LANE.items()} if lane else {}
        return found | ({name: f"{target}.target.{name}" for name in ("gap", "detected")} if target else {})

    @property
    def _wheels(self) -> dict[str, tuple[str, ...]]:
        """Signals of the torques at both axles, if there are such."""
        found: dict[str, tuple[str, ...]] = {}
        for name, stem in _WHEELS.items():
            ends = (f"{stem}.front", f"{stem}.rear")
            if all(end in self.signals for end in ends):
                found[name] = ends
        return found

    @property
    def _car(self) -> str | None:
        return self._ending("motion.heading")

    @property
    def _lane(self) -> str | None:
        """A world in which the car drives along a straight line."""
        part = self._ending("lead.speed")
        return part if part and {f"{part}.position", f"{part}.gap", f"{part}.speed"} <= self.signals.keys() else None

    @property
    def road(self) -> str:
        """The part that tells where others are and what lights show; "" if there is none."""
        return self._road or ""

    @property
    def _road(self) -> str | None:
        return self._ending("actors[1].heading")

    def _ending(self, port: str) -> str | None:
        return next((name.removesuffix(f".{port}") for name in self.signals if name.endswith(f".{port}")), None)

    def _places(self, stem: str, port: str) -> Iterator[str]:
        """The items of an array of structures that have *port*."""
        number = 1
        while f"{stem}[{number}].{port}" in self.signals:
            yield f"{stem}[{number}]"
            number += 1

    def _setting(self, name: str, otherwise: float) -> float:
        found = (value for full, value in self.settings.items() if full.rsplit(".", 1)[-1] == name)
        return next(found, otherwise)

    def _size(self, name: str, otherwise: float) -> float:
        """As the part states it that has the whole box of the host, else any part."""
        boxes = (full.removesuffix(".host_length") for full in self.settings if full.endswith(".host_length"))
        own = f"{next(boxes, '')}.host_{name}"
        return self.settings[own] if own in self.settings else self._setting(f"host_{name}", otherwise)

    def _doubts(self, used: Mapping[str, float]) -> Iterator[str]:
        for name, size in used.items():
            values = {value for full, value in self.settings.items() if full.endswith(f".host_{name}")}
            if not values:
                yield f"no part of the bench states host_{name}; assumed: {size:g} m"
            elif len(values) > 1:
                differ = ", ".join(f"{value:g} m" for value in sorted(values))
                yield f"parts of the bench differ in host_{name}: {differ}; used: {size:g} m"

    def _sensor(
        self,
        part: str,
        titles: Mapping[str, str],
        returns: Sequence[Mapping[str, Floats]],
        scan: Mapping[str, Floats] | None = None,
    ) -> Sensor:
        names = ("mount", "max_range", "field_of_view", "mount_left", "mount_turn")
        mount, reach, angle, left, turn = (self.settings.get(f"{part}.{name}", 0.0) for name in names)
        mount = mount or self._size("front", _FRONT)
        title = titles.get(part, part)
        label = f"{title} ({part})" if [*titles.values()].count(title) > 1 else title
        return Sensor(part, label, mount, reach, angle, tuple(returns), left, turn, scan or {})

    def _lead(self, columns: Mapping[str, Floats]) -> dict[str, Floats]:
        """The vehicle in front of a car that drives straight on."""
        part = self._lane
        some = columns[f"{part}.gap"]
        length = self._setting("lead_length", _LENGTH)
        place = columns[f"{part}.position"] + self._size("front", _FRONT) + some + length / 2
        numbers = {
            "id": 1.0,
            "class": 1.0,
            "length": length,
            "width": self._setting("lead_width", _WIDTH),
            "height": _HEIGHT,
            "y": self._setting("lead_offset", 0.0),
            "z": 0.0,
            "heading": 0.0,
        }
        constant = {name: np.full_like(some, value) for name, value in numbers.items()}
        return {**constant, "x": place, "speed": columns[f"{part}.lead.speed"]}

    def _line(self, end: str | None, figure: Figure, columns: Mapping[str, Floats]) -> Floats | None:
        if end is None:
            return None
        if end in columns:
            return _shown(columns[end], figure.unit)
        if end in self.settings:
            some = next(iter(columns.values()))
            return np.full_like(some, figure.unit.from_si(self.settings[end]))
        return None


def _shown(values: Floats, unit: Unit) -> Floats:
    return (values - float(unit.offset)) / float(unit.factor)


def _is_shown(name: str) -> bool:
    """Whether a signal with items says what a driver is told, rather than what somebody is."""
    return not re.search(r"\[\d+\]", name) and not name.endswith((".class", ".colour"))
