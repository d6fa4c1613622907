"""The master's algorithm in plain Python: slow, simple, and the same bits as the kernel.

It exists to be compared with: nothing here is shared with the kernel's loop, variables are read and written one by
one, and values are kept under their names.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from struct import pack

import numpy as np
from numpy.typing import NDArray

from dse.cosim import diagnosis
from dse.cosim.calls import FLOATING, type_of
from dse.cosim.clock import end_of, steps_in
from dse.cosim.failure import RunFailed
from dse.cosim.instance import Instance
from dse.cosim.library import load, occupy, vacate
from dse.cosim.wiring import Wiring, start_groups, wire_up
from dse.domain.system import Element, SystemStructure

_NO_START: Mapping[str, float] = {}


def run_reference(
    system: SystemStructure,
    record: Sequence[str],
    *,
    stop: float,
    step: float,
    start: Mapping[str, float] = _NO_START,
) -> NDArray[np.float64]:
    """Simulate *system* once on fresh instances; arguments, result and errors as of ``Simulator.run``."""
    wiring = wire_up(system)
    wiring.record(record)
    steps = steps_in(stop, step)
    start_groups(system, start)  # refuses names that cannot be set
    libraries = {element.model.library: load(element.model) for element in system.elements}
    with ExitStack() as stack:
        stack.callback(vacate, occupy(system))
        instances = [
            stack.enter_context(Instance(element.name, element.model, libraries[element.model.library]))
            for element in system.elements
        ]
        return _Master(wiring, instances, start).run(record, end_of(stop, step, steps), step, steps)


class _Master:
    def __init__(self, wiring: Wiring, instances: Sequence[Instance], start: Mapping[str, float]) -> None:
        self.wiring = wiring
        self.pairs = list(zip(wiring.system.elements, instances, strict=True))
        self.start = start
        self.values: dict[str, float] = {}
        self.source = {
            f"{w.target}.{w.target_variable}": f"{w.source}.{w.source_variable}" for w in wiring.system.wires
        }

    def run(self, record: Sequence[str], stop: float, step: float, steps: int) -> NDArray[np.float64]:
        for element, instance in self.pairs:
            instance.set_up(stop)
            self._set_starts(element, instance)
            instance.enter_initialization(stop)
        self._settle()
        for _, instance in self.pairs:
            instance.exit_initialization()
        rows = []
        for k in range(steps + 1):
            time = k * step
            for element, instance in self.pairs:
                self._read(element, instance, time)
            rows.append([self.values[name] for name in record])
            self._check_finite(time)
            if k == steps:
                break
            for element, instance in self.pairs:
                self._write(element, instance, time)
            for _, instance in self.pairs:
                instance.do_step(time, step)
        for _, instance in self.pairs:
            instance.terminate(steps * step)
        return np.array(rows, np.float64).reshape(steps + 1, len(record))

    def _set_starts(self, element: Element, instance: Instance) -> None:
        prefix = f"{element.name}."
        wanted = {prefix + name: value for name, value in element.start.items()} | dict(self.start)
        for variable in element.model.variables.values():
            if prefix + variable.name in wanted:
                instance.set(variable, wanted[prefix + variable.name], None)

    def _settle(self) -> None:
        for element, instance in self.pairs:
            self._read(element, instance, None)
        for _ in range(self.wiring.sweeps):
            before = dict(self.values)
            for element, instance in self.pairs:
                self._write(element, instance, None)
                self._read(element, instance, None)
            moving = tuple(name for name, value in self.values.items() if pack("d", value) != pack("d", before[name]))
            if not moving:
                return
        culprit = diagnosis.culprits(self.wiring, moving)[0]
        element, _ = next(pair for pair in self.pairs if culprit.startswith(f"{pair[0].name}."))
        raise RunFailed(element.name, "", None, (), diagnosis.unsettled(self.wiring, moving))

    def _read(self, element: Element, instance: Instance, time: float | None) -> None:
        for variable in element.outputs:
            if type_of(variable, element.model.version) is not None:
                self.values[f"{element.name}.{variable.name}"] = instance.get(variable, time)

    def _write(self, element: Element, instance: Instance, time: float | None) -> None:
        for variable in element.inputs:
            name = f"{element.name}.{variable.name}"
            instance.set(variable, self.values[self.source[name]], time)

    def _check_finite(self, time: float) -> None:
        wired = set(self.source.values())
        for element, instance in self.pairs:
            for variable in element.outputs:
                name = f"{element.name}.{variable.name}"
                floating = type_of(variable, element.model.version) in FLOATING
                if name in wired and floating and not np.isfinite(self.values[name]):
                    what = diagnosis.not_finite(name, self.values[name], time)
                    raise RunFailed(element.name, instance.accessor("Get", variable), time, instance.log, what)
