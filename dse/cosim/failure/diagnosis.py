"""What the kernel's failure record means."""

from __future__ import annotations

import math
from collections.abc import Sequence
from math import isfinite, isnan

from dse.cosim.binding import layout
from dse.cosim.binding.calls import FATAL, MOST_EVENT_ITERATIONS, Call, function_name
from dse.cosim.failure import fmu_messages
from dse.cosim.failure.fmu_messages import moment
from dse.cosim.failure.run_failed import RunFailed, StopReason
from dse.cosim.tables.tables import Tables
from dse.cosim.wiring.dependency import AlgebraicLoop
from dse.cosim.wiring.wiring import Wiring
from dse.domain.system import Element

_OF_EVENTS = frozenset({Call.INSTANTIATE, Call.ENTER_EVENT_MODE, Call.UPDATE_DISCRETE_STATES, Call.ENTER_STEP_MODE})
_BLAMED_ON_EVENTS = frozenset({StopReason.NO_INSTANCE, StopReason.BAD_STATUS, StopReason.ENDLESS_EVENTS})
_OF_STARTS = frozenset({StopReason.UNFIT_START, StopReason.NO_ITEM_START})


def diagnose(tables: Tables, loops: Sequence[AlgebraicLoop], step: float) -> RunFailed:
    """The failure that the kernel left in *tables*.

    *loops* are numbered as the kernel has them, *step* is the run's communication step in seconds.
    """
    failure, wiring = tables.system.failure, tables.wiring
    reason, time = StopReason(failure.kind), _moment_of(failure, step)
    if reason in OF_LOOPS:
        return of_loop(reason, wiring, loops[failure.position], time, failure.value)
    if reason in OF_OUTPUTS:
        return of_output(reason, wiring, failure.position, time or 0.0, failure.value)
    if reason in OF_CLOCKS:
        return of_clock(reason, wiring, failure.progress.place.element, failure.position, time, failure.value)
    index = failure.progress.place.element
    if reason is StopReason.NOT_FINITE:
        index = wiring.owners[failure.position]
        element = wiring.system.elements[index]
        call = function_name(Call.GET + wiring.group_at(failure.position).type, element.model.version)
        what = fmu_messages.of_value(reason, wiring.values[failure.position], time, failure.value)
    elif failure.group >= 0:
        element = wiring.system.elements[index]
        call = function_name(failure.progress.place.call, element.model.version)
        label = (tables.starts.labels if reason in _OF_STARTS else tables.labels)[failure.group][failure.position]
        fmi_type = call[call.find("et") + 2 :]  # ``Real`` of ``fmi2SetReal``
        what = fmu_messages.of_value(reason, label, time, failure.value, fmi_type)
    else:
        return failed_call(failure, wiring.system.elements[index], time, tables.elements.log(index))
    return RunFailed(element.name, what, call, time, tables.elements.log(index))


def failed_call(failure: layout.Failure, element: Element, time: float | None, log: tuple[str, ...]) -> RunFailed:
    """The failure of a call of *element*, or of its integration, as the kernel recorded it."""
    reason, call = StopReason(failure.kind), function_name(failure.progress.place.call, element.model.version)
    if reason.is_of_integration:
        what = fmu_messages.of_integration(reason, element, failure.position, failure.status, failure.value)
    else:
        needs_tool = element.model.capabilities.needs_tool
        what = fmu_messages.of_call(
            reason, fmu_messages.place(element.name, call, time), failure.status, needs_tool=needs_tool
        )
        if reason in _BLAMED_ON_EVENTS and failure.progress.place.call in _OF_EVENTS and _may_do_without(element):
            what += " (with event mode; `event_mode: off` in the source of its component does without)"
    fatal = reason is StopReason.BAD_STATUS and failure.status == FATAL
    return RunFailed(element.name, what, call, time, log, fatal)


def _may_do_without(element: Element) -> bool:
    """Whether it has an event mode that can be switched off, as nothing of it ticks."""
    return element.model.ticks and not any(v.timing for v in element.model.variables.values())


def _moment_of(failure: layout.Failure, step: float) -> float | None:
    """When the kernel stopped, or an FMU asked it to, in seconds; None before t = 0."""
    if failure.kind == StopReason.STEP_CUT_SHORT and failure.status and not math.isnan(failure.value):
        return float(failure.value)
    if not math.isnan(failure.time):
        return float(failure.time)
    # The plain loop keeps no other clock than the number of its step.
    return failure.progress.step * step if failure.progress.step >= 0 else None


# Why the master itself stops a run: loops without a solution, divergence, steps that become too short, clocks.


OF_LOOPS = frozenset({StopReason.NOT_SOLVED, StopReason.NEARLY_SINGULAR, StopReason.NOT_SETTLED})
OF_OUTPUTS = frozenset({StopReason.DIVERGED, StopReason.STEP_TOO_SHORT, StopReason.ENDLESS_STEPS})
OF_CLOCKS = frozenset({StopReason.ENDLESS_TICKS, StopReason.BAD_INTERVAL, StopReason.BETWEEN_POINTS})


def of_loop(
    reason: StopReason, wiring: Wiring, loop: AlgebraicLoop, time: float | None, value: float = 0.0
) -> RunFailed:
    """No values were found for *loop*.

    *value* is the smallest relative residual Newton's method came to; if the loop is nearly singular, by how much of
    their size one more step would change values.
    """
    stage = "initialization" if time is None else f"the communication point {moment(time)}"
    unsolved = f"{stage} found no solution of the algebraic loop {loop.described}:"
    match reason:
        case StopReason.NOT_SOLVED:
            what = f"{unsolved} Newton's method came to a residual of {value:.3g}"
        case StopReason.NEARLY_SINGULAR:
            by = f"would change values by {value:.3g} of their size" if isfinite(value) else "has no direction"
            what = f"{unsolved} it is nearly singular, the last step of Newton's method {by}"
        case _:
            what = f"{stage} did not settle: the algebraic loop {loop.described} keeps changing"
    first = (*loop.reals, *loop.others)[0]
    return RunFailed(wiring.system.elements[first.element].name, what, time=time)


def of_output(reason: StopReason, wiring: Wiring, position: int, time: float, value: float) -> RunFailed:
    """A wired output is *value*, too large to mean anything; or asks for shorter steps than that, or more."""
    name = wiring.values[position]
    match reason:
        case StopReason.DIVERGED:
            what = (
                f"{name} diverged: it was {value:.3g} {moment(time)}, more than 2^53 times the nominal value that its "
                f"FMU declares and its first value; use shorter steps or another algorithm"
            )
        case StopReason.STEP_TOO_SHORT:
            what = f"{name} asks for steps shorter than {value:.3g} s {moment(time)}: the tolerance cannot be kept"
        case _:
            what = f"{name} asks for more than {value:.0f} steps between two communication points, {moment(time)}"
    return RunFailed(wiring.system.elements[wiring.owners[position]].name, what, time=time)


def of_clock(
    reason: StopReason, wiring: Wiring, element: int, position: int, time: float | None, value: float
) -> RunFailed:
    """The clock number *position* (-1: none) does what it may not, or *element* cannot stop where it ticks."""
    name = wiring.system.elements[element].name
    clock = wiring.clocks.label(position, wiring.system) if position >= 0 else ""
    at = "in the initialization" if time is None else moment(time)
    match reason:
        case StopReason.ENDLESS_TICKS if value:
            what = f"{clock}: what ticks with it, and what belongs to that, does not settle {at}"
        case StopReason.ENDLESS_TICKS:
            what = f"{clock} ticks more than {MOST_EVENT_ITERATIONS} times {at}"
        case StopReason.BAD_INTERVAL:
            told = "no interval" if isnan(value) else f"{value:.10g} s"
            what = f"{clock}: its FMU gives {told} for its ticks {at}"
        case _:
            why = f"{clock} ticks" if clock else "there is an event"
            what = (
                f"{name} takes only steps of one length, and {why} {moment(value)}, between two communication points; "
                f"use a step that ends there"
            )
    owner = wiring.system.elements[wiring.clocks.clocks[position].element].name if position >= 0 else name
    return RunFailed(name if reason is StopReason.BETWEEN_POINTS else owner, what, time=time)
