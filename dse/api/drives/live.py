"""A drive that is on: opened on a bench, steered, looked at, and in the end a record that can be driven again."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from dse.domain.component import Kind, Port
from dse.domain.drive import TUNE, Drive, bits_of
from dse.errors import fail

if TYPE_CHECKING:
    from dse.domain.bench import TestBench
    from dse.domain.design import Configuration
    from dse.live import DriverInTheLoop, Ended, Patience, Session, Sharing
    from dse.testbench import PreparedBench, WiredBench

MOST_DRIVER = 40
"""Characters of a driver's name."""
_LONGEST = 3600.0


@dataclass(frozen=True, slots=True)
class Tunable:
    """A parameter that can be changed while driving, in *unit*."""

    name: str
    title: str
    unit: str
    min: float
    max: float
    value: float


class LiveDrive:
    """A bench ready to be driven by *driver*; `start` begins, and `session` is there from then on."""

    def __init__(
        self,
        driver_in_loop: DriverInTheLoop,
        prepared: PreparedBench,
        view: View,
        first: Mapping[str, float],
        driver: str,
        bench: TestBench,
    ) -> None:
        self.driver_in_loop, self.view, self.driver, self.bench = driver_in_loop, view, named(driver), bench
        self._prepared, self._first = prepared, dict(first)
        self._session: Session | None = None

    @property
    def step(self) -> float:
        """Seconds."""
        return self._prepared.simulation.step

    @property
    def controls(self) -> tuple[str, ...]:
        """What a driver does, by the ports of the interface ``driver``."""
        return tuple(port.name for port in self.driver_in_loop.controls)

    @cached_property
    def tunables(self) -> tuple[Tunable, ...]:
        """The sliders."""
        found = []
        for name, each in self.driver_in_loop.tunables.items():
            unit, value = each.type.unit, self._first[f"{TUNE}.{name}"]
            spread = abs(value) or 1.0
            low = each.minimum if each.minimum is not None else min(0.0, value - spread)
            high = each.maximum if each.maximum is not None else value + spread
            numbers = (unit.from_si(number) for number in (low, high, value))
            found.append(Tunable(name, each.title or name.rpartition(".")[2], str(unit), *numbers))
        return tuple(found)

    def scene(self) -> dict[str, object]:
        """What a page is told first, as plain data."""
        return {
            "type": "scene",
            "document": self.view.document,
            "columns": list(self.view.columns),
            "step": self.step,
            "length": self._prepared.simulation.stop,
            "tunables": [{name: getattr(each, name) for name in Tunable.__slots__} for each in self.tunables],
            "controls": list(self.controls),
            "start": {port.name: self._first[port.name] for port in self.driver_in_loop.controls},
        }

    def start(self, patience: Patience | None = None) -> None:
        """Begin. The run is made in a process of its own."""
        if self._session is None:
            self._session = self._begun(patience)

    def _begun(self, patience: Patience | None) -> Session:
        from dse.live import Session

        return Session(self._prepared, self.driver_in_loop, self._first, patience)

    @property
    def settings(self) -> Mapping[str, float]:
        """What the bench was given for this drive, by ``part.parameter``."""
        return {}

    @property
    def has_begun(self) -> bool:
        """Whether it was started."""
        return self._session is not None

    @property
    def session(self) -> Session:
        """What makes the run. ValueError before it was started."""
        if self._session is None:
            raise ValueError("the drive has not started")
        return self._session

    @property
    def ended(self) -> Ended | None:
        """How it came to its end; None before."""
        return self._session.ended if self._session else None

    def control(self, values: Mapping[str, object], number: int = 0) -> None:
        """Do *values* by port, SI, items by name or number; *number* is echoed.

        DseError, and nothing is done, if one is none.
        """
        ports = {port.name: port for port in self.driver_in_loop.controls}
        self.session.command({name: _value(ports.get(name), name, value) for name, value in values.items()}, number)

    def tune(self, values: Mapping[str, object], number: int = 0) -> None:
        """Set parameters by name, in their units; *number* is echoed. DseError, and none is set, if one is none."""
        told = {}
        for name, value in values.items():
            known = next((each for each in self.tunables if each.name == name), None)
            if known is None:
                raise fail("there is no such parameter to tune")
            given = _number(value)
            if not known.min <= given <= known.max:
                raise fail(f"'{name}' is between {known.min:g} and {known.max:g} {known.unit}".rstrip())
            told[f"{TUNE}.{name}"] = self.driver_in_loop.tunables[name].type.unit.to_si(given)
        self.session.command(told, number)

    def finish(self) -> None:
        """End here; what was driven counts."""
        if self._session:
            self._session.finish()

    def close(self) -> None:
        """End it at once and wait until its process is gone."""
        if self._session:
            self._session.close()

    def frame(self) -> bytes | None:
        """The newest for a page: time, lateness, overruns, echo, then a value for each column; None at first."""
        seen = self._session.newest if self._session else None
        if seen is None:
            return None
        return frame(
            (seen.time, seen.lateness, seen.overruns, seen.echo), self.view.of(seen.values[: len(self.view.wanted)])
        )

    @property
    def result(self) -> Drive | None:
        """The drive, once it has come to an end that counts."""
        ended = self.ended
        if ended is None or ended.run is None or ended.run.waveforms is None or ended.pace is None:
            return None
        waveforms, part = ended.run.waveforms, self.driver_in_loop.part
        inputs = {name: waveforms.values[f"{part}.{name}"] for name in self.driver_in_loop.inputs}
        configuration = self.driver_in_loop.configuration.id
        bits = bits_of(ended.run)
        name, time = self.bench.name, waveforms.time
        return Drive(name, configuration, self.driver, self.step, time, inputs, ended.pace, self.settings, bits)


def open_drive(bench: TestBench, configuration: str | None = None, *, driver: str = "", fmi: int = 2) -> LiveDrive:
    """Have all ready to drive *bench* with the configuration whose id starts so, or the first.

    Raises DseError if the bench cannot be driven, or something cannot be built.
    """
    chosen = drivable(bench, configuration)
    return LiveDrive(*opened(bench, chosen, View(wire(bench, chosen), bench.simulation.stop), fmi=fmi), driver, bench)


def drivable(bench: TestBench, configuration: str | None) -> Configuration:
    """The configuration whose id starts so, or the first. Raises DseError if *bench* cannot be driven."""
    from dse.live import driver_of
    from dse.testbench import one_configuration

    driver_of(bench)
    if bench.simulation.stop > _LONGEST:
        raise fail(f"'{bench.name}' takes {bench.simulation.stop:g} s; a drive takes at most one hour", bench.where)
    return one_configuration(bench.design, configuration)


def wire(bench: TestBench, chosen: Configuration) -> WiredBench:
    """*chosen* on *bench*. Raises DseError."""
    from dse.testbench import wire_bench

    return wire_bench(bench, chosen)


def opened(
    bench: TestBench,
    chosen: Configuration,
    view: View,
    also: Sequence[str] = (),
    sharing: Sharing | None = None,
    *,
    fmi: int = 2,
) -> tuple[DriverInTheLoop, PreparedBench, View, dict[str, float]]:
    """What a `LiveDrive` is made of; its driver sees what is in *view*, and the signals *also*. Raises DseError."""
    from dse.live import prepare_driver, put_driver_in_the_loop

    wanted = (*view.wanted, *also)
    driver_in_loop = put_driver_in_the_loop(bench, chosen, wanted, sharing=sharing, version=fmi)
    prepared = prepare_driver(driver_in_loop, version=fmi)
    settings = wire(bench, chosen).settings
    first = {f"{TUNE}.{name}": settings[name].value for name in driver_in_loop.tunables}
    return driver_in_loop, prepared, view, first | _hands(bench, driver_in_loop, fmi)


def _hands(bench: TestBench, driver_in_loop: DriverInTheLoop, fmi: int) -> dict[str, float]:
    """What the bench's own driver does at first."""
    from dse.api.studies.single_run import alone
    from dse.domain.study import Selection
    from dse.testbench import bench_study

    names = {f"{driver_in_loop.part}.{port.name}": port.name for port in driver_in_loop.controls}
    simulation, step = bench.simulation, bench.simulation.step
    short = replace(simulation, stop=step, record=tuple(names), record_every=step, check_step=False)
    run, _ = alone(bench_study(replace(bench, simulation=short), Selection.of((driver_in_loop.configuration,))), fmi)
    if run.waveforms is None:
        raise fail(f"bench '{bench.name}' does not run: {run.problem}", bench.where)
    return {port: float(run.waveforms.values[name][0]) for name, port in names.items()}


def named(driver: str) -> str:
    """What may be somebody's name: text on one line."""
    visible = "".join(each if each.isprintable() else " " for each in driver)
    return " ".join(visible.split())[:MOST_DRIVER].strip() or "somebody"


def _number(value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) <= sys.float_info.max:
        raise fail("this is not a number")
    return float(value)


def _value(port: Port | None, name: str, value: object) -> float:
    if port is None:
        raise fail(f"the driver has no '{name[:80]}'")
    match port.type.kind:
        case Kind.BOOLEAN if value in (True, False, 0, 1):
            return float(bool(value))
        case Kind.ENUMERATION if isinstance(value, str) and value in port.type.items:
            return float(port.type.items.index(value))
        case Kind.ENUMERATION if value in range(len(port.type.items)) and not isinstance(value, bool):
            return _number(value)
        case Kind.INTEGER if isinstance(value, int) and abs(value) < 1 << 31:
            return _number(value)
        case Kind.REAL:
            return _number(value)
    raise fail(f"'{name}' does not accept this value")


# What a driver sees while a run is simulated: the columns of the scene, computed from the signals at one time.


_FASTEST = 70.0
_EVERYWHERE = 1e9


class View:
    """The scene of *wired*, which lasts *length* s. Every column of it is a sum of signals with fixed weights.

    *document* is what the page of a replay has, with all places of others and sensors; *columns* are the names of what
    `of` gives. DseError if nothing says where a car is.
    """

    def __init__(self, wired: WiredBench, length: float) -> None:
        from dse.api.studies.scenes import scene_of_signals
        from dse.report import SceneSignals, scene_document

        bench = wired.bench
        told = SceneSignals(
            wired.signals, {name: setting.value for name, setting in wired.settings.items()}, bench.figures
        )
        if not told.is_scene:
            what = "no part gives the position of a car: neither 'motion.x' nor 'position' and 'gap'"
            raise fail(f"bench '{bench.name}' cannot be driven: {what}", bench.where)
        self.wanted = told.wanted
        found = _Columns()
        # Each signal 1 and all others 0, after nothing but 0: so the weights are read off, whatever a scene is made of.
        probe = np.vstack([np.zeros(len(self.wanted)), np.eye(len(self.wanted))])
        columns = dict(zip(self.wanted, probe.T, strict=True))
        straight = np.array([[0.0, 0.0], [_FASTEST * length, 0.0]])
        times = np.arange(len(probe), dtype=np.float64)
        scene = scene_of_signals(wired, told, columns, times, way=straight, reach=_EVERYWHERE)
        self.host = scene.host
        self.document = scene_document(scene, found)
        self.document["columns"] = {}
        self.columns = tuple(found.values)
        table = np.array([np.broadcast_to(values, len(probe)) for values in found.values.values()])
        self._offsets = np.ascontiguousarray(table[:, 0])
        weights = table[:, 1:] - table[:, :1]
        self._rows, self._places = np.nonzero(weights)
        self._weights = weights[self._rows, self._places]

    def of(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """The columns where the signals `wanted` have *values*."""
        columns = self._offsets.copy()
        np.add.at(columns, self._rows, self._weights * values[self._places])
        return columns


class _Columns:
    def __init__(self) -> None:
        self.values: dict[str, NDArray[np.float64]] = {}

    def add(self, name: str, kind: str, values: NDArray[np.floating]) -> None:  # noqa: ARG002  # all go as doubles
        self.values[name] = np.asarray(values, np.float64)


def frame(head: Sequence[float], columns: NDArray[np.float64]) -> bytes:
    """A frame as it goes to a page: *head*, then the columns, as doubles, little-endian."""
    return np.concatenate([head, columns]).astype("<f8").tobytes()
