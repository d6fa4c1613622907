"""What a fused loop cannot do, told by name before anything is compiled."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from dse.domain.fmu import FmiInterface, Variable
from dse.domain.method import Method
from dse.domain.system import Element, SystemStructure
from dse.errors import Problem

_AGAIN = "build it again"
_FROM_SOURCE = "components that are finished FMUs can only be simulated through FMI: leave out --fuse"
_PLAIN_ONLY = "simulate it without --fuse"


def fusion_problems(system: SystemStructure, record: Sequence[str], method: Method) -> list[Problem]:
    """Everything of *system*, *record* and *method* that cannot be compiled into one loop."""
    problems = []
    if not method.is_plain_but_for_order:
        what = "a fused loop supports only one fixed step, inputs held, no coupling, no bonds"
        problems.append(Problem(f"{system.name}: {what}", hint=_PLAIN_ONLY))
    for element in system.elements:
        problems += _element_problems(element)
    problems += _wire_problems(system)
    outputs = {f"{e.name}.{v.name}" for e in system.elements for v in e.outputs}
    problems += [Problem(f"there is no output '{name}' to record") for name in record if name not in outputs]
    return problems


def _element_problems(element: Element) -> Iterable[Problem]:
    if element.model.interface is not FmiInterface.CO_SIMULATION or element.model.version not in (2, 3):
        what = f"{element.name}: only FMUs for co-simulation of FMI 2 and 3 can be fused"
        yield Problem(what, hint=_FROM_SOURCE)
    for variable in (*element.inputs, *element.outputs):
        name = f"{element.name}.{variable.name}"
        if variable.shape:
            yield Problem(f"{name}: arrays cannot be fused", hint=_PLAIN_ONLY)
        if variable.kind is None:
            yield Problem(f"{name}: variables of type {variable.fmi_type} cannot be fused", hint=_PLAIN_ONLY)
        if variable.name in element.conversions:
            yield Problem(f"{name}: a variable with a conversion cannot be fused", hint=_PLAIN_ONLY)


def _wire_problems(system: SystemStructure) -> Iterable[Problem]:
    counted: dict[str, int] = {}
    outputs = {f"{e.name}.{v.name}" for e in system.elements for v in e.outputs}
    inputs = [f"{e.name}.{v.name}" for e in system.elements for v in e.inputs]
    for wire in system.wires:
        source, target = f"{wire.source}.{wire.source_variable}", f"{wire.target}.{wire.target_variable}"
        counted[target] = counted.get(target, 0) + 1
        if (wire.factor, wire.offset, wire.items) != (1.0, 0.0, ()):
            yield Problem(f"{source} -> {target}: a connection with a conversion cannot be fused", hint=_PLAIN_ONLY)
        if source not in outputs:
            yield Problem(f"{source}: a wire starts at what is not an output")
    yield from (
        Problem(f"{name}: {counted.get(name, 0)} wires end at this input") for name in inputs if counted.get(name) != 1
    )
    yield from (Problem(f"{name}: a wire ends at what is not an input") for name in counted.keys() - set(inputs))


def unknown_place(element: Element, variable: Variable) -> Problem:
    """The problem of a variable that is no member of the component, as FMI 3's time is none."""
    return Problem(f"{element.name}.{variable.name}: only ports and parameters can be fused", hint=_PLAIN_ONLY)


def not_ours(element: Element, reason: str) -> Problem:
    """The problem of an FMU that cannot be built once more."""
    hint = _AGAIN if "version" in reason else _PLAIN_ONLY if "process" in reason else _FROM_SOURCE
    return Problem(f"{element.name}: the FMU {element.model.archive.name} {reason}, so it cannot be fused", hint=hint)
