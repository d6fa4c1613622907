"""Runs of an FMU through FMPy and through dse's own master, as rows of values by name."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np
from language_case import Steps

from dse.cosim.simulator import Simulator
from dse.domain.fmu import FmuModel, Variable
from dse.domain.system import Element, SystemStructure

Rows = list[dict[str, float]]


class Slave:
    """One co-simulation instance of FMPy, addressed by names of variables."""

    def __init__(self, model: FmuModel) -> None:
        from fmpy.fmi2 import FMU2Slave, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE
        from fmpy.fmi3 import FMU3Slave

        self.model, self.messages = model, list[str]()
        made = FMU2Slave if model.version == 2 else FMU3Slave
        self.fmu: Any = made(
            guid=model.token,
            unzipDirectory=str(model.folder),
            modelIdentifier=model.identifier,
            instanceName="tested",
        )
        if model.version == 2:
            logger = fmi2CallbackLoggerTYPE(lambda env, name, status, category, text: self._told(text))
            self._callbacks = fmi2CallbackFunctions(logger=logger)
            self.fmu.instantiate(callbacks=self._callbacks)
        else:
            self._callbacks = lambda env, status, category, text: self._told(text)
            self.fmu.instantiate(logMessage=self._callbacks)

    def start(self, given: Mapping[str, float], tolerance: float | None, time: float = 0.0) -> None:
        """Set what is *given* and initialize at *time*."""
        for name, value in given.items():
            self.set(name, value)
        if self.model.version == 2:
            self.fmu.setupExperiment(tolerance=tolerance, startTime=time)
            self.fmu.enterInitializationMode()
        else:
            self.fmu.enterInitializationMode(tolerance=tolerance, startTime=time)
        self.fmu.exitInitializationMode()

    def set(self, name: str, value: float) -> None:
        variable = self.model.variables[name]
        whole = "Float" not in variable.fmi_type and variable.fmi_type != "Real"
        getattr(self.fmu, f"set{variable.fmi_type}")([variable.reference], [int(value) if whole else float(value)])

    def get(self, name: str) -> float:
        variable = self.model.variables[name]
        return float(getattr(self.fmu, f"get{variable.fmi_type}")([variable.reference])[0])

    def values(self, names: Sequence[str]) -> dict[str, float]:
        return {name: self.get(name) for name in names}

    def _told(self, text: bytes | str) -> None:
        self.messages.append(text.decode() if isinstance(text, bytes) else str(text))


@contextmanager
def instance(model: FmuModel) -> Iterator[Slave]:
    """An instance that is freed in the end."""
    slave = Slave(model)
    try:
        yield slave
    finally:
        slave.fmu.freeInstance()


def numbers(model: FmuModel) -> list[str]:
    """All variables that have a value one can read."""
    return [v.name for v in model.variables.values() if v.kind is not None and v.causality != "independent"]


def run_cs(
    model: FmuModel,
    names: Sequence[str],
    steps: int,
    step: float,
    given: Mapping[str, float],
    inputs: Mapping[str, Steps],
    tolerance: float | None,
) -> Rows:
    """Values of *names* at 0, step, …, before the inputs of that instant are set."""
    with instance(model) as slave:
        slave.start({**given, **{name: signal.after(0.0) for name, signal in inputs.items()}}, tolerance)
        rows = [slave.values(names)]
        for k in range(steps):
            for name, signal in inputs.items():
                slave.set(name, signal.after(k * step))
            slave.fmu.doStep(k * step, step)
            rows.append(slave.values(names))
        slave.fmu.terminate()
        return rows


def run_me(
    model: FmuModel,
    names: Sequence[str],
    steps: int,
    step: float,
    given: Mapping[str, float],
    inputs: Mapping[str, Steps],
    tolerance: float,
) -> list[tuple[float, dict[str, float]]]:
    """Times and values at 0, step, … and at events, from FMPy's CVode."""
    from fmpy import simulate_fmu

    stop = steps * step
    signals = None
    if inputs:
        jumps = sorted({t for signal in inputs.values() for t in signal.times if 0 < t < stop})
        points = [0.0, *(t for jump in jumps for t in (jump, jump)), stop]
        rows = []
        for k, t in enumerate(points):
            late = k % 2 == 0
            rows.append((t, *(s.after(t) if late and t < stop else s.before(t) for s in inputs.values())))
        types = [("time", float), *((name, _numpy_type(model.variables[name])) for name in inputs)]
        signals = np.array(rows, dtype=types)
    result = simulate_fmu(
        str(model.folder),
        fmi_type="ModelExchange",
        stop_time=stop,
        output_interval=step,
        relative_tolerance=tolerance,
        start_values=dict(given),
        input=signals,
        output=list(names),
        record_events=False,
    )
    return [(float(row["time"]), {name: float(row[name]) for name in names}) for row in result]


def run_master(model: FmuModel, names: Sequence[str], steps: int, step: float, given: Mapping[str, float]) -> Rows:
    """Values of *names* at 0, step, … from dse's own master."""
    outputs = tuple(model.variables[name] for name in names)
    system = SystemStructure("tested", (Element("part", model, (), outputs, dict(given)),), ())
    with Simulator(system, [f"part.{name}" for name in names]) as simulator:
        found = simulator.run(stop=steps * step, step=step)
        return [dict(zip(names, map(float, row), strict=True)) for row in found]


def _numpy_type(variable: Variable) -> type:
    if variable.fmi_type in ("Real", "Float64"):
        return float
    return bool if variable.fmi_type == "Boolean" else int
