"""A master for clocks on FMPy's bindings: it shares nothing with the kernel but the rules of docs/simulation.md.

Slow and simple: clocks are followed until no other ticks, then each message is fetched when somebody wants it.
"""

from __future__ import annotations

import ctypes
import math
import shutil
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from types import TracebackType
from xml.etree import ElementTree as ET

import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi3 import FMU3Slave
from numpy.typing import NDArray

Port = tuple[str, str]


class Part:
    """An instance, and what it says of itself."""

    def __init__(self, name: str, path: Path, *, early: bool) -> None:
        self.name, self.folder = name, extract(str(path))
        described = read_model_description(str(path), validate=False)
        self.variables = {v.name: v for v in described.modelVariables}
        self.evaluates = described.coSimulation.providesEvaluateDiscreteStates
        names = {v.valueReference: v.name for v in described.modelVariables}
        self.clocked = {v.name: [names[c.valueReference] for c in v.clocks or ()] for v in described.modelVariables}
        # FMPy reads no intervals.
        root = ET.parse(Path(self.folder) / "modelDescription.xml").getroot()  # noqa: S314  # ours
        self.said = {clock.get("name", ""): clock.attrib for clock in root.iter("Clock")}
        self.needs = {u.variable.name: [d.name for d in u.dependencies or ()] for u in described.outputs}
        identifier = described.coSimulation.modelIdentifier
        self.fmu = FMU3Slave(
            guid=described.instantiationToken, unzipDirectory=self.folder, modelIdentifier=identifier, instanceName=name
        )
        self.fmu.instantiate(eventModeUsed=True, earlyReturnAllowed=early)
        self.next: dict[str, float] = {}
        self.ticks: dict[str, tuple[int, float, float, float]] = {}
        self.in_events = self.is_due = True
        self.active: set[str] = set()

    def reference(self, name: str) -> list[int]:
        return [self.variables[name].valueReference]

    def number(self, name: str) -> float:
        return float(self.fmu.getFloat64(self.reference(name))[0])

    def timed(self) -> Iterable[str]:
        for v in self.variables.values():
            if v.type == "Clock" and v.causality == "input" and v.intervalVariability != "triggered":
                yield v.name

    def interval(self, name: str) -> tuple[int, float, float]:
        """The qualifier, the interval and in how many parts of a second it is given."""
        reference, qualifier = (ctypes.c_uint32 * 1)(*self.reference(name)), (ctypes.c_int * 1)()
        if self.said[name].get("supportsFraction") == "true":
            counter, resolution = (ctypes.c_uint64 * 1)(), (ctypes.c_uint64 * 1)()
            self.fmu.fmi3GetIntervalFraction(self.fmu.component, reference, 1, counter, resolution, qualifier)
            return qualifier[0], float(counter[0]), float(resolution[0])
        found = (ctypes.c_double * 1)()
        self.fmu.fmi3GetIntervalDecimal(self.fmu.component, reference, 1, found, qualifier)
        return qualifier[0], found[0], 1.0

    def shift(self, name: str) -> float:
        reference = (ctypes.c_uint32 * 1)(*self.reference(name))
        if self.said[name].get("supportsFraction") == "true":
            counter, resolution = (ctypes.c_uint64 * 1)(), (ctypes.c_uint64 * 1)()
            self.fmu.fmi3GetShiftFraction(self.fmu.component, reference, 1, counter, resolution)
            return float(counter[0])
        found = (ctypes.c_double * 1)()
        self.fmu.fmi3GetShiftDecimal(self.fmu.component, reference, 1, found)
        return found[0]

    def begin(self) -> None:
        """When the clocks tick first."""
        for name in self.timed():
            v = self.variables[name]
            kind = v.intervalVariability
            if kind in ("changing", "countdown"):
                qualifier, interval, parts = self.interval(name)
                self.next[name] = interval / parts if qualifier else math.inf
                continue
            said = {key: float(said) for key, said in self.said[name].items() if said[:1].isdigit()}
            if "intervalCounter" in said:
                self.ticks[name] = 0, said.get("shiftCounter", 0.0), said["intervalCounter"], said["resolution"]
            elif "intervalDecimal" in said:
                self.ticks[name] = 0, said.get("shiftDecimal", 0.0), said["intervalDecimal"], 1.0
            else:
                _, interval, parts = self.interval(name)
                self.ticks[name] = 0, self.shift(name), interval, parts
            self._set_next(name)

    def _set_next(self, name: str) -> None:
        n, first, interval, parts = self.ticks[name]
        self.next[name] = (first + n * interval) / parts

    def tick(self, name: str) -> None:
        """It ticks by itself."""
        if name in self.ticks:
            n, *rest = self.ticks[name]
            self.ticks[name] = (n + 1, *rest)
            self._set_next(name)
        else:
            self.next[name] = math.inf

    def ask(self, time: float) -> None:
        """After an update: what is new of the clocks."""
        for name in self.timed():
            v = self.variables[name]
            kind, asks = v.intervalVariability, "intervalDecimal" not in self.said[name]
            if kind == "countdown" or (kind == "changing" and name in self.active) or (kind == "tunable" and asks):
                qualifier, interval, parts = self.interval(name)
                if qualifier == 2 and kind == "tunable":
                    self.ticks[name] = 0, time + interval / parts, interval / parts, 1.0
                    self._set_next(name)
                elif qualifier == 2:
                    self.next[name] = time + interval / parts


class ClockMaster:
    """Instances of *fmus*, wired as ``a.y -> b.u``; *early* names the one that may end a step early."""

    def __init__(self, fmus: Mapping[str, Path], wires: Iterable[str], start: Mapping[str, float], early: str) -> None:
        self.parts = {name: Part(name, path, early=name == early) for name, path in fmus.items()}
        self.order = sorted(self.parts.values(), key=lambda part: part.name != early)
        pairs = [tuple(_port(end) for end in wire.split(" -> ")) for wire in wires]
        self.source: dict[Port, Port] = {b: a for a, b in pairs if not self._is_clock(a)}
        self.rings: dict[Port, list[Port]] = {}
        for a, b in pairs:
            if self._is_clock(a):
                self.rings.setdefault(b, []).append(a)
        told = set(self.rings)
        for (name, variable), (other, output) in self.source.items():
            for clock in self.parts[name].clocked[variable]:
                v = self.parts[name].variables[clock]
                if (name, clock) not in told and v.intervalVariability == "triggered":
                    self.rings.setdefault((name, clock), []).extend(
                        (other, c) for c in self.parts[other].clocked[output]
                    )
        self.groups = self._grouped()
        self.values: dict[Port, float] = {}
        for label, value in start.items():
            name, variable = _port(label)
            self.parts[name].fmu.setFloat64(self.parts[name].reference(variable), [value])

    def __enter__(self) -> ClockMaster:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for part in self.parts.values():
            part.fmu.freeInstance()
            shutil.rmtree(part.folder, ignore_errors=True)

    def _grouped(self) -> list[list[Part]]:
        """Parts that ticks, or what belongs to clocks, go between; each group in the order in which it steps."""
        number = {name: n for n, name in enumerate(self.parts)}
        clocked = [(a, b) for b, a in self.source.items() if self._clocks(a) and self._clocks(b)]
        for a, b in [*clocked, *((a, b) for b, sources in self.rings.items() for a in sources)]:
            one, other = number[a[0]], number[b[0]]
            number = {name: one if n == other else n for name, n in number.items()}
        return [[part for part in self.order if number[part.name] == n] for n in dict.fromkeys(number.values())]

    def _clocks(self, port: Port) -> list[str]:
        return self.parts[port[0]].clocked[port[1]]

    def _is_clock(self, port: Port) -> bool:
        return bool(self.parts[port[0]].variables[port[1]].type == "Clock")

    def _is_number(self, port: Port) -> bool:
        return bool(self.parts[port[0]].variables[port[1]].type == "Float64")

    def run(self, record: Sequence[str], stop: float, step: float) -> NDArray[np.float64]:
        ports = [_port(label) for label in record]
        wanted = [*ports, *(a for a in self.source.values() if self._is_number(a))]
        self.free = [p for p in wanted if not self.parts[p[0]].clocked[p[1]]]
        self.kept = [p for p in wanted if self.parts[p[0]].clocked[p[1]]]
        self.spare = 1e-9 * step
        for part in self.parts.values():
            part.fmu.enterInitializationMode(stopTime=stop)
        for _ in range(2 * len(self.parts)):
            self.values |= {(name, v): self.parts[name].number(v) for name, v in wanted}
            for (name, v), a in self.source.items():
                if self._is_number(a):
                    self.parts[name].fmu.setFloat64(self.parts[name].reference(v), [self.values[a]])
        for part in self.parts.values():
            part.begin()
            part.fmu.exitInitializationMode()
        rows = []
        for k in range(round(stop / step) + 1):
            self._show()
            due = [group for group in self.groups if self._is_due(group, k * step)]
            for group in due:
                self._give(group)
                self._instants(group, k * step)
                self._show(group)
            rows.append([self.values[port] for port in ports])
            if k < round(stop / step):
                self._give()
                for group in self.groups:
                    self._go(group, k * step, (k + 1) * step, step)
        return np.array(rows)

    def _show(self, group: Sequence[Part] = ()) -> None:
        shown = group or self.order
        self.values |= {(name, v): self.parts[name].number(v) for name, v in self.free if self.parts[name] in shown}

    def _give(self, group: Sequence[Part] = ()) -> None:
        """Inputs that belong to no clock; discrete ones, too: these FMUs take them in any mode."""
        for (name, v), a in self.source.items():
            is_asked = not group or self.parts[name] in group
            if is_asked and self._is_number(a) and not self.parts[name].clocked[v]:
                self.parts[name].fmu.setFloat64(self.parts[name].reference(v), [self.values[a]])

    def _is_due(self, group: Sequence[Part], time: float) -> bool:
        until = time + self.spare
        return any(p.is_due or any(t <= until for t in p.next.values()) for p in group)

    def _go(self, group: Sequence[Part], time: float, end: float, length: float) -> None:
        at = time
        while at < end:
            coming = min((t for part in group for t in part.next.values()), default=math.inf)
            target = coming if coming < end - self.spare else end
            for part in group:
                step = target - at
                if target == end:
                    step = length if at == time else end - at
                event, _, early, reached = part.fmu.doStep(at, step)
                part.is_due |= event
                target = reached if early and reached < target - 1e-9 * step else target
            at = target
            if at < end:
                self._instants(group, at)

    def _instants(self, group: Sequence[Part], time: float) -> None:
        for _ in range(100):
            for part in group:
                part.active = set()
                for name in [n for n, t in part.next.items() if t <= time + self.spare]:
                    part.tick(name)
                    part.active.add(name)
                    part.is_due = True
            if not any(part.is_due for part in group):
                break
            self._one_instant(group, time)
        for part in group:
            if part.in_events:
                part.fmu.enterStepMode()
                part.in_events = False

    def _enter(self, part: Part) -> None:
        if not part.in_events:
            part.fmu.enterEventMode()
            part.in_events = True
        part.is_due = True

    def _one_instant(self, group: Sequence[Part], time: float) -> None:
        for part in group:
            if part.is_due:
                self._enter(part)
                for name in part.active:
                    part.fmu.setClock(part.reference(name), [True])
        ticking = None
        while ticking != (ticking := {(p.name, c) for p in group for c in p.active}):
            for part in group:
                for name, v in part.variables.items():
                    if v.type != "Clock" or name in part.active:
                        continue
                    if v.causality == "output" and part.is_due and part.fmu.getClock(part.reference(name))[0]:
                        part.active.add(name)
                    elif any(a[1] in self.parts[a[0]].active for a in self.rings.get((part.name, name), ())):
                        self._enter(part)
                        part.active.add(name)
                        part.fmu.setClock(part.reference(name), [True])
        self.fetched: dict[Port, bytes | float] = {}
        self.given: set[Port] = set()
        names = {part.name for part in group}
        for port in self.source:
            if port[0] in names:
                self._deliver(port)
        for port in self.kept:
            if port[0] in names and self._ticks(port):
                self._fetch(port)
        for part in group:
            if part.is_due:
                part.is_due = bool(part.fmu.updateDiscreteStates()[0])
                part.ask(time)

    def _ticks(self, port: Port) -> bool:
        part = self.parts[port[0]]
        return bool(part.active & set(part.clocked[port[1]]))

    def _deliver(self, port: Port) -> None:
        source, part = self.source[port], self.parts[port[0]]
        if port in self.given or not self._ticks(port):
            return
        self.given.add(port)
        is_number = self._is_number(port)
        if self._ticks(source):
            self._fetch(source)
        elif not is_number:
            return
        if is_number:
            part.fmu.setFloat64(part.reference(port[1]), [self.values[source]])
        else:
            part.fmu.setBinary(part.reference(port[1]), [self.fetched[source]])

    def _fetch(self, port: Port) -> None:
        if port in self.fetched:
            return
        part = self.parts[port[0]]
        needed = part.variables if part.evaluates else part.needs[port[1]]
        for name in needed:
            if (part.name, name) in self.source:
                self._deliver((part.name, name))
        if self._is_number(port):
            self.fetched[port] = self.values[port] = part.number(port[1])
        else:
            self.fetched[port] = part.fmu.getBinary(part.reference(port[1]))[0]


def _port(label: str) -> Port:
    element, name = label.split(".", 1)
    return element, name
