"""One FMU as a system of its own, simulated by the kernel."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from dse.cosim.probing.excitation import watched
from dse.cosim.simulator import Simulator
from dse.domain.fmu import FmuModel
from dse.domain.system import Element, SystemStructure


def alone(element: Element) -> Simulator:
    """*element* by itself, on fresh instances only; all its outputs that are numbers are recorded."""
    element = replace(element, name="fmu", inputs=(), outputs=tuple(v for v in element.outputs if v.kind is not None))
    record = [f"fmu.{label}" for variable in element.outputs for label in variable.labels]
    simulator = Simulator(SystemStructure("probe", (element,), ()), record)
    simulator.reset_is_trusted = False
    return simulator


def element_of(model: FmuModel, start: Mapping[str, float]) -> Element:
    """*model* with these start values of inputs and parameters, all its outputs wanted."""
    return Element("fmu", model, (), watched(model), start)
