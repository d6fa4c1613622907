"""What the kernel's failure record means."""

from __future__ import annotations

import math
from collections.abc import Sequence

from dse.cosim.binding import layout
from dse.cosim.binding.calls import FATAL, Call, function_name
from dse.cosim.failure import fmu_messages
from dse.cosim.failure.master import OF_CLOCKS, OF_LOOPS, OF_OUTPUTS, of_clock, of_loop, of_output
from dse.cosim.failure.run_failed import RunFailed
from dse.cosim.failure.stop_reason import StopReason
from dse.cosim.tables.tables import Tables
from dse.cosim.wiring.dependency import AlgebraicLoop
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
