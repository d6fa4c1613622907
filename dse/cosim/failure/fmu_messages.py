"""What went wrong with one FMU, in words."""

from __future__ import annotations

import math

from dse.cosim.binding.calls import LONGEST_TEXT, MOST_EVENT_ITERATIONS, STATUS
from dse.cosim.binding.integration import REALS, tolerance_of
from dse.cosim.failure.run_failed import StopReason
from dse.domain.fmu import FmuModel
from dse.domain.system import Element

MOST_STEPS = 1_000_000
MOST_PASSES = 100
CLOSE_EVENTS = 32


def moment(time: float) -> str:
    """A point in simulated time: ``at t = 3.21 s``."""
    return f"at t = {time:.10g} s"


def place(element: str, call: str, time: float | None) -> str:
    """Where a simulation is: ``world: fmi2DoStep at t = 3.21 s``; *time* is None before t = 0."""
    return f"{element}: {call}{_at(time)}"


def of_call(reason: StopReason, where: str, status: int = 0, *, needs_tool: bool = False) -> str:
    """What is wrong with the call at a `place`, which returned *status*; a step asked to end if that is not 0."""
    match reason:
        case StopReason.BAD_STATUS:
            return f"{where} returned {STATUS[status] if 0 <= status < len(STATUS) else f'the unknown status {status}'}"
        case StopReason.NO_INSTANCE:
            told = ", and the FMU declares that it needs another program" if needs_tool else ""
            return f"{where} returned no instance{told}"
        case StopReason.ENDLESS_EVENTS:
            return f"{where} asked for more than {MOST_EVENT_ITERATIONS} event iterations at one point in time"
        case StopReason.FLOATING_CHANGED:
            return f"{where} left the processor with another floating-point mode (rounding, flush to zero or traps)"
        case StopReason.STEP_CUT_SHORT:
            return f"{where} {'asked to end the simulation' if status else 'returned before the end of the step'}"
        case _:
            return f"{where} is not supported by the FMU"


def of_value(reason: StopReason, label: str, time: float | None, value: float = 0.0, fmi_type: str = "") -> str:
    """What is wrong with the *value* of the variable *label*, or with the text it has."""
    at = _at(time)
    match reason:
        case StopReason.NOT_FINITE:
            return f"{label} became {value} {moment(time or 0.0)}"
        case StopReason.TOO_LARGE:
            return f"{label} exceeds 2^53 in magnitude{at}: larger integers cannot be carried exactly"
        case StopReason.NO_ITEM:
            return f"{label} became {value:.17g}{at}, which is none of the enumeration's items"
        case StopReason.NO_ITEM_START | StopReason.NO_ITEM_INPUT:
            return f"{label} cannot take the value {value:.17g}{at}: it is none of the enumeration's items"
        case StopReason.NO_TEXT:
            return f"{label} was not given{at}: the FMU returned a null pointer"
        case StopReason.LONG_TEXT:
            return f"{label} is larger than {LONGEST_TEXT // 2**20} MiB{at}"
        case _ if not math.isfinite(value):
            why = "the factor of its wire or its unit makes it too large for a number"
            return f"{label} would become {value}{at}: {why}"
        case _:
            return f"{label} cannot take the value {value:.17g}{at}: it is of type {fmi_type}"


def of_integration(reason: StopReason, element: Element, position: int, status: int, time: float) -> str:
    """What happened to *element*: *position* and *status* as the kernel left them, *time* where its solver stood."""
    if reason is StopReason.COUNT_DIFFERS:
        counted = "event indicators" if position else "continuous states"
        return f"{element.name}: the FMU has {status} {counted}, which its description does not declare"
    return f"{element.name}{_integration(reason, element.model, position)} {moment(time)}"


def _integration(reason: StopReason, model: FmuModel, position: int) -> str:
    match reason:
        case StopReason.CHATTERS:
            which = f" of event indicator {position + 1}" if position >= 0 else ""
            return f" chatters: {CLOSE_EVENTS} events{which} with next to no time between them"
        case StopReason.TOO_INACCURATE:
            return f": no step of the solver is small enough for the tolerance of {tolerance_of(model):g}"
        case StopReason.TOO_MANY_STEPS:
            return f": more than {MOST_STEPS} steps of the solver in one communication step"
        case StopReason.EVENTS_UNSETTLED:
            return f": the event iteration finds no end in {MOST_PASSES} passes"
        case StopReason.SLOPE_NOT_FINITE:
            return f": the derivative of {_state_label(model, position)} is not a finite number"
        case StopReason.STATE_NOT_FINITE:
            return f": the state {_state_label(model, position)} is not a finite number"
        case StopReason.INDICATOR_NOT_FINITE:
            return f": event indicator {position + 1} is not a finite number"
        case StopReason.EVENT_NEVER:
            return ": the time of its next event is not a number"
        case _:
            return ": the stiff solver's matrix is singular"


def _at(time: float | None) -> str:
    return "" if time is None else f" {moment(time)}"


def _state_label(model: FmuModel, position: int) -> str:
    """The label of the state value at *position*, counted from 0."""
    reals = [v for v in model.variables.values() if v.fmi_type in REALS and not v.alias_of]
    by_reference = {v.reference: v for v in reals}
    states = model.exchange.states if model.exchange else ()
    labels = [label for reference in states if reference in by_reference for label in by_reference[reference].labels]
    return labels[position] if position < len(labels) else f"number {position + 1}"
