"""The master's algorithms in plain Python: values are kept under their names, and nothing is compiled beforehand."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from math import inf, isfinite, isnan, nan
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dse.cosim.failure.diagnosis import of_loop, of_output
from dse.cosim.failure.fmu_messages import of_value
from dse.cosim.failure.run_failed import RunFailed, StopReason
from dse.cosim.tables.method import DISCRETE_SWEEPS, declared_nominal, nominal_of
from dse.cosim.wiring.border import Border, ElementPort
from dse.cosim.wiring.check import OwnStep, extrapolation_of
from dse.cosim.wiring.dependency import AlgebraicLoop, Read, Step, doubtful_reads, order_of
from dse.cosim.wiring.links import links_of
from dse.cosim.wiring.wiring import Wiring
from dse.domain.method import Adaptive, Algorithm, Coupling, Extrapolation, Method
from oracle.conversion import carried
from oracle.newton import NoSolution, newton, same_bits

_EXCHANGES = 20
_EASY = 0.1
_FINEST = 52
_RANGE = 2.0**53
_NOTICED = 1e-6
_MOST_STEPS = 2**20

Value = Any  # a number, a text or bytes


class Master:
    """One run of a wired system by *method*; *parts* are its elements' instances, *own* their own steps."""

    def __init__(self, wiring: Wiring, parts: Sequence[Any], method: Method, own: Sequence[OwnStep]) -> None:
        self.wiring, self.parts, self.method, self.own = wiring, parts, method, own
        self.border = Border(wiring)
        self.names = [element.name for element in wiring.system.elements]
        self.links = links_of(wiring.system)
        self.values: dict[str, Value] = {}
        self.before: dict[str, Value] = {}
        self.shown = [0.0] * len(parts)
        self.spans = [0.0] * len(parts)
        self.used: dict[str, float] = {}
        self.energies = {bond.name: 0.0 for bond in method.bonds}
        self.met: dict[tuple[str, str], float] = {}
        self.magnitudes: dict[str, float] = {}
        self.limits: dict[str, float] = {}
        self.meeting: tuple[Step, ...] = ()
        if method.coupling is not Coupling.NONE:
            self.meeting = order_of(wiring, initially=False)
        self.k = 0
        self.level = 0
        self.last = 0.0
        self.has_ended = False
        self.time: float | None = None

    def run(
        self, record: Sequence[str], start: Mapping[str, float], stop: float, step: float, steps: int
    ) -> NDArray[np.float64]:
        """Waveforms as of ``Simulator.run``."""
        for name, part in zip(self.names, self.parts, strict=True):
            own = {k.removeprefix(f"{name}."): v for k, v in start.items() if k.startswith(f"{name}.")}
            part.set_up(stop, own)
        self._initialize()
        for part in self.parts:
            part.leave_initialization()
        self._set_limits()
        self.time = 0.0
        for e in range(len(self.parts)):
            self._read(e, self.border.outputs[e])
        rows: list[list[float]] = []
        try:
            self._simulate(rows, record, step, steps)
        except RunFailed as failure:
            if not (rows and _asks_to_end(failure)):
                raise
        self._check_limits(steps * step)
        for part in self.parts:
            part.terminate(steps * step)
        return np.array(rows, np.float64).reshape(len(rows), len(record))

    def _simulate(self, rows: list[list[float]], record: Sequence[str], step: float, steps: int) -> None:
        for k in range(steps + 1):
            self.k = k
            self._meet(k * step, self.last)
            rows.append([self._recorded(name) for name in record])
            if k == steps or self.has_ended:
                return
            if self.method.adaptive:
                self._note_magnitudes()
                self._advance_adaptively(k * step, step, self.method.adaptive)
            else:
                self._advance(k * step, step, (k + 1) * step)
                self.last = step

    # ---- initialization ----

    def _initialize(self) -> None:
        self._sweep(order_of(self.wiring, initially=True))
        reads = doubtful_reads(self.wiring)
        passed_on = dict(self.values)
        self._sweep(reads)
        ports = [port for read in reads for port in read.ports]
        if any(self._differs(port, label, passed_on) for port in ports for label in self._labels(port)):
            self._sweep(order_of(self.wiring, initially=True, told=False))

    def _differs(self, port: ElementPort, label: str, passed_on: Mapping[str, Value]) -> bool:
        a, b = self.values[label], passed_on[label]
        if not self.border.is_real(port):
            return bool(a != b)
        if a == b or (isnan(a) and isnan(b)):
            return False
        return not abs(a - b) <= _NOTICED * max(self._nominal(port), abs(a), abs(b))

    # ---- values ----

    def _recorded(self, name: str) -> float:
        return self.energies[name.removeprefix("bonds.")] if name.startswith("bonds.") else self.values[name]

    def _labels(self, port: ElementPort) -> list[str]:
        return [f"{self.names[port.element]}.{label}" for label in self.border.variable(port).labels]

    def _read(self, e: int, ports: Sequence[ElementPort]) -> None:
        found = self.parts[e].read([self.border.variable(port).name for port in ports], self.time)
        self.values |= {f"{self.names[e]}.{label}": value for label, value in found.items()}

    def _write(self, e: int, values: Mapping[str, Value]) -> None:
        given = {}
        for label, value in values.items():
            transform = self.links[label].transform if label in self.links else None
            inner = label.removeprefix(f"{self.names[e]}.")
            given[inner] = carried(transform, value) if transform else value
            if transform and isfinite(value):
                self.parts[e].check_finite({inner: given[inner]}, self.time)
        self.parts[e].write(given, self.time)

    def _source(self, label: str) -> str:
        # What no wire ends at in an array that others end at keeps its value.
        return self.links[label].source if label in self.links else label

    # ---- the order of dependencies ----

    def _sweep(self, steps: Sequence[Step], *, in_loop: bool = False) -> None:
        for step in steps:
            if isinstance(step, AlgebraicLoop):
                self._solve(step)
                self._check_finite([label for port in (*step.reals, *step.others) for label in self._labels(port)])
            elif self.k % self.own[step.element].every:
                continue
            elif isinstance(step, Read):
                self._read(step.element, step.ports)
            else:
                labels = [label for port in step.ports for label in self._labels(port)]
                if not in_loop:
                    self._check_finite(map(self._source, labels))
                self._write(step.element, {label: self.values[self._source(label)] for label in labels})

    def _solve(self, loop: AlgebraicLoop) -> None:
        reals, others = (
            [label for port in ports for label in self._labels(port)] for ports in (loop.reals, loop.others)
        )
        texts = [label for label in others if not isinstance(self.values[label], (int, float))]
        torn = reals + [label for label in others if label not in texts]
        nominals = [self._nominal(port) for port in loop.reals for _ in self._labels(port)]
        stays = [self.k % self.own[port.element].every != 0 for port in loop.reals for _ in self._labels(port)]

        def walk(x: Sequence[float]) -> list[float]:
            self.values |= zip(torn, x, strict=True)
            try:
                self._sweep(loop.sweep, in_loop=True)
            except RunFailed as failure:
                if not _is_discarded(failure):
                    raise
                return [nan] * len(torn)
            return [self.values[label] for label in torn]

        begin = x = [self.values[label] for label in torn]
        settled = False
        for _ in range(len(torn) + len(texts) + 1 + (0 if reals else DISCRETE_SWEEPS)):
            found = walk(x)
            settled = same_bits(x, found)
            if settled and not texts:
                return
            if any(map(isnan, found)):
                break
            x = found
        if settled:
            return
        x, n = begin, len(reals)
        for _ in range(_EXCHANGES if reals else 0):
            try:
                x, found = newton(walk, x, nominals, stays)
            except NoSolution as stuck:
                if stuck.is_singular:
                    reason, value = StopReason.NEARLY_SINGULAR, stuck.left
                else:
                    reason, value = StopReason.NOT_SOLVED, stuck.residual
                raise of_loop(reason, self.wiring, loop, self.time, value) from None
            if same_bits(x[n:], found[n:]):
                return
            x = x[:n] + found[n:]
        raise of_loop(StopReason.NOT_SETTLED, self.wiring, loop, self.time)

    def _nominal(self, port: ElementPort) -> float:
        return nominal_of(self.wiring.system.elements[port.element], self.border.variable(port))

    # ---- steps ----

    def _advance(self, time: float, length: float, end: float) -> None:
        sequential = self.method.algorithm is Algorithm.GAUSS_SEIDEL
        elements = range(len(self.parts))
        leading = [] if sequential else [e for e in elements if self.names[e] in self.method.leading]
        showing = [e for e in elements if (self.k + 1) % self.own[e].every == 0 and e not in leading]
        for e in elements:
            if self.k % self.own[e].every == 0:
                self._drive(e, time, self.own[e].every * length)
            if sequential and e in showing:
                self._show(e, end)
            if e in leading:
                self._show(e, time)
        for e in () if sequential else showing:
            self._show(e, end)

    def _drive(self, e: int, time: float, length: float) -> None:
        own = length / self.own[e].parts
        labels = [(label, moves) for port in self.border.inputs[e] for label, moves in self._moving(port)]
        for label, moves in labels:
            self.used[label] = self._along(label, moves, time, 0.5 * length)[0]
        for part in range(self.own[e].parts):
            begin = self.time = time + part * own
            with_slopes = self.parts[e].takes_slopes
            moved = {label: self._along(label, m, begin, 0.0 if with_slopes else 0.5 * own) for label, m in labels}
            if self.method.algorithm is Algorithm.GAUSS_SEIDEL and not self.method.adaptive:
                self._check_finite(self._source(label) for label, _ in labels)
            self._write(e, {label: value for label, (value, _) in moved.items()})
            slopes = {}
            if with_slopes and extrapolation_of(self.wiring.system.elements[e], self.method) is Extrapolation.LINEAR:
                slopes = {label: self._carried_slope(label, moved[label][1]) for label, moves in labels if moves}
                slopes = {label.removeprefix(f"{self.names[e]}."): slope for label, slope in slopes.items()}
            try:
                self.parts[e].step(begin, own, slopes, may_roll_back=bool(self.method.adaptive))
            except RunFailed as failure:
                # All others get to where it ends, if that is the next row and nothing is written there before it.
                is_next = self.own[e].every == 1 and part + 1 == self.own[e].parts
                if not (is_next and _asks_to_end(failure)) or self.method.adaptive or self.meeting:
                    raise
                if failure.time is None or not failure.time >= begin + own - 1e-9 * own:
                    raise
                self.has_ended = True

    def _moving(self, port: ElementPort) -> list[tuple[str, bool]]:
        """Labels of an input, and whether each moves during a step."""
        element = self.wiring.system.elements[port.element]
        moves = self.border.moves(port)
        if extrapolation_of(element, self.method) is Extrapolation.HOLD:
            moves = (False,) * len(moves)
        labels = self._labels(port)
        return list(zip(labels, moves or (False,) * len(labels), strict=True))

    def _along(self, label: str, moves: bool, time: float, later: float) -> tuple[Value, float]:
        """What the source's line is at *time* and some time *later*, and its slope."""
        source = self._source(label)
        value = self.values[source]
        if not moves:
            return value, 0.0
        e = self.names.index(next(n for n in self._owners(source)))
        slope = (value - self.before[source]) / self.spans[e] if self.spans[e] > 0.0 else 0.0
        return value + slope * (time - self.shown[e] + later if later else time - self.shown[e]), slope

    def _carried_slope(self, label: str, slope: float) -> float:
        transform = self.links[label].transform if label in self.links else None
        return transform.factor * slope if transform else slope

    def _owners(self, label: str) -> list[str]:
        return sorted((name for name in self.names if label.startswith(f"{name}.")), key=len, reverse=True)

    def _show(self, e: int, time: float) -> None:
        prefix = f"{self.names[e]}."
        self.before |= {label: value for label, value in self.values.items() if label.startswith(prefix)}
        self.spans[e] = time - self.shown[e]
        self.shown[e] = self.time = time
        self._read(e, self.border.outputs[e])

    # ---- communication points ----

    def _meet(self, time: float, length: float) -> None:
        self.time = time
        self._check_finite(self.limits)
        if self.meeting:
            self._sweep(self.meeting)
            self._check_finite(self.limits)
        for bond in self.method.bonds:
            effort_used, flow_used = self._ends(bond.effort, bond.flow)
            self.energies[bond.name] += self._work((bond.name, "flow"), bond.flow, effort_used, length)
            self.energies[bond.name] -= self._work((bond.name, "effort"), bond.effort, flow_used, length)

    def _work(self, side: tuple[str, str], output: str, input_: str, length: float) -> float:
        """What the element behind *output* did with an input in its own step, if one ends here."""
        every = self.own[self.names.index(self._owners(output)[0])].every
        if self.k % every:
            return 0.0
        mean: float = 0.5 * (self.met.get(side, 0.0) + self.values[output])
        self.met[side] = self.values[output]
        return every * length * float(self.used.get(input_, 0.0)) * mean

    def _ends(self, effort: str, flow: str) -> tuple[str, str]:
        """The inputs that the effort and the flow end at."""
        ends = []
        for source, other in ((effort, flow), (flow, effort)):
            owner = self._owners(other)[0]
            targets = (label for label, link in self.links.items() if link.source == source)
            ends.append(next(label for label in targets if self._owners(label)[0] == owner))
        return ends[0], ends[1]

    def _watched(self) -> list[tuple[str, float]]:
        wired = {self.wiring.values[position] for position in self.wiring.wired}
        elements = self.wiring.system.elements
        return [
            (label, declared_nominal(elements[port.element], self.border.variable(port)))
            for port in self.border.floating_outputs
            for label in self._labels(port)
            if label in wired
        ]

    def _set_limits(self) -> None:
        for label, nominal in self._watched():
            begin = abs(self.values[label])
            self.limits[label] = _RANGE * (begin if begin > nominal else nominal)

    def _check_finite(self, labels: Iterable[str]) -> None:
        for label in labels:
            value = self.values[label]
            if isinstance(value, (int, float)) and not isfinite(value):
                e = self.names.index(self._owners(label)[0])
                what = of_value(StopReason.NOT_FINITE, label, self.time, value)
                raise RunFailed(self.names[e], what, time=self.time, log=self.parts[e].instance.log)

    def _check_limits(self, time: float) -> None:
        for label, limit in self.limits.items():
            if abs(self.values[label]) > limit:
                position = self.wiring.values.index(label)
                raise of_output(StopReason.DIVERGED, self.wiring, position, time, self.values[label])

    # ---- error control ----

    def _advance_adaptively(self, time: float, step: float, adaptive: Adaptive) -> None:
        i = tried = 0
        while i < 2**self.level:
            length = step / 2**self.level
            half = 0.5 * length
            begin, end, middle = time + i * length, time + (i + 1) * length, time + (2 * i + 1) * half
            kept = self._save()
            try:
                coarse = self._step_twice(kept, begin, length, middle, end)
                error, worst = self._difference(coarse, adaptive)
            except RunFailed as failure:
                # An FMU that discards a step asks for a shorter one.
                if not _is_discarded(failure) or half < adaptive.smallest or self.level >= _FINEST:
                    raise
                error, worst = inf, ""
            tried += 1
            if tried > _MOST_STEPS:
                position = self.wiring.values.index(worst)
                raise of_output(StopReason.ENDLESS_STEPS, self.wiring, position, self.time or 0.0, _MOST_STEPS)
            if not error <= 1.0:
                if half < adaptive.smallest or self.level >= _FINEST:
                    position = self.wiring.values.index(worst)
                    raise of_output(StopReason.STEP_TOO_SHORT, self.wiring, position, self.time or 0.0, half)
                self._restore(kept)
                self.level, i = self.level + 1, 2 * i
                continue
            self.last = half
            self._note_magnitudes()
            i += 1
            if i < 2**self.level:
                self._meet(end, half)
            if self.level and i % 2 == 0 and error <= _EASY:
                self.level, i = self.level - 1, i // 2

    def _step_twice(
        self, kept: tuple[Any, ...], begin: float, length: float, middle: float, end: float
    ) -> dict[str, Value]:
        """In one step, whose values are returned, and again in two halves."""
        half = 0.5 * length
        self._advance(begin, length, end)
        coarse = dict(self.values)
        self._restore(kept)
        self._advance(begin, half, middle)
        self._meet(middle, half)
        self._advance(middle, half, end)
        return coarse

    def _save(self) -> tuple[Any, ...]:
        for part in self.parts:
            part.save()
        tables = [dict(self.values), dict(self.before), dict(self.energies), dict(self.met)]
        return (*tables, list(self.shown), list(self.spans))

    def _restore(self, kept: tuple[Any, ...]) -> None:
        for e, part in enumerate(self.parts):
            part.restore()
            self._read(e, self.border.outputs[e])
        values, before, energies, met, shown, spans = kept
        self.values, self.before, self.energies, self.met = dict(values), dict(before), dict(energies), dict(met)
        self.shown, self.spans = list(shown), list(spans)

    def _compared(self) -> list[str]:
        return [label for port in self.border.real_outputs for label in self._labels(port)]

    def _note_magnitudes(self) -> None:
        for label in self._compared():
            size = abs(self.values[label])
            if size > self.magnitudes.get(label, 0.0):
                self.magnitudes[label] = size

    def _difference(self, coarse: Mapping[str, Value], adaptive: Adaptive) -> tuple[float, str]:
        largest, worst = 0.0, next(iter(self.wiring.values), "")
        for label in self._compared():
            allowed = adaptive.absolute + adaptive.tolerance * self.magnitudes.get(label, 0.0)
            part = abs(self.values[label] - coarse[label]) / allowed
            if not part <= largest:
                largest, worst = (inf if isnan(part) else part), label
        return largest, worst


def _is_discarded(failure: RunFailed) -> bool:
    return failure.what.endswith(" returned discard")


def _asks_to_end(failure: RunFailed) -> bool:
    return failure.what.endswith("asked to end the simulation")
