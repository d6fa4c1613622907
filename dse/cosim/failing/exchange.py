"""What the kernel's failures of model exchange mean, in words."""

from __future__ import annotations

from enum import IntEnum

from dse.cosim.binding.integration import REALS, tolerance_of
from dse.cosim.failing.failure import moment
from dse.domain.fmu import FmuModel
from dse.domain.system import Element


class ExchangeKind(IntEnum):
    """Why an integration stopped, numbered as in exchange_memory.h."""

    CHATTERS = 32
    TOO_INACCURATE = 33
    TOO_MANY_STEPS = 34
    EVENTS_UNSETTLED = 35
    SLOPE_NOT_FINITE = 36
    INDICATOR_NOT_FINITE = 37
    STATE_NOT_FINITE = 38
    COUNT_DIFFERS = 39
    SINGULAR = 40
    EVENT_NEVER = 41


MOST_STEPS = 1_000_000
MOST_PASSES = 100
CLOSE_EVENTS = 32


def describe(element: Element, kind: int, position: int, status: int, time: float) -> str:
    """What happened to *element*: *position* and *status* as the kernel left them, *time* where its solver stood."""
    if kind == ExchangeKind.COUNT_DIFFERS:
        return _other_count(element, status, of_indicators=bool(position))
    return f"{element.name}{_what(element.model, ExchangeKind(kind), position)} {moment(time)}"


def _what(model: FmuModel, kind: ExchangeKind, position: int) -> str:
    match kind:
        case ExchangeKind.CHATTERS:
            which = f" of event indicator {position + 1}" if position >= 0 else ""
            return f" chatters: {CLOSE_EVENTS} events{which} with next to no time between them"
        case ExchangeKind.TOO_INACCURATE:
            return f": no step of the solver is small enough for the tolerance of {tolerance_of(model):g}"
        case ExchangeKind.TOO_MANY_STEPS:
            return f": more than {MOST_STEPS} steps of the solver in one communication step"
        case ExchangeKind.EVENTS_UNSETTLED:
            return f": the event iteration finds no end in {MOST_PASSES} passes"
        case ExchangeKind.SLOPE_NOT_FINITE:
            return f": the derivative of {state_label(model, position)} is not a finite number"
        case ExchangeKind.STATE_NOT_FINITE:
            return f": the state {state_label(model, position)} is not a finite number"
        case ExchangeKind.INDICATOR_NOT_FINITE:
            return f": event indicator {position + 1} is not a finite number"
        case ExchangeKind.EVENT_NEVER:
            return ": the time that it tells for its next event is not a number"
        case _:
            return ": the stiff solver's matrix is singular"


def state_label(model: FmuModel, position: int) -> str:
    """The label of the state value at *position*, counted from 0."""
    reals = [v for v in model.variables.values() if v.fmi_type in REALS and not v.alias_of]
    by_reference = {v.reference: v for v in reals}
    states = model.exchange.states if model.exchange else ()
    labels = [label for reference in states if reference in by_reference for label in by_reference[reference].labels]
    return labels[position] if position < len(labels) else f"number {position + 1}"


def _other_count(element: Element, count: int, *, of_indicators: bool) -> str:
    what = "event indicators" if of_indicators else "continuous states"
    return f"{element.name}: the FMU has {count} {what}, which its description does not say"
