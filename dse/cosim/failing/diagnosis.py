"""What the kernel's failure record means, in words."""

from __future__ import annotations

import math
from enum import IntEnum

from dse.cosim.binding import layout
from dse.cosim.binding.calls import FATAL, LONGEST_TEXT, MOST_EVENT_ITERATIONS, STATUS, Call, function_name
from dse.cosim.failing.exchange import ExchangeKind, describe
from dse.cosim.failing.failure import RunFailed, moment, place
from dse.cosim.tables.tables import Tables
from dse.cosim.wiring.wiring import Group, Wiring


class Kind(IntEnum):
    """Why the kernel stopped, numbered as in kernel.h."""

    NOTHING = 0
    BAD_STATUS = 1
    NO_INSTANCE = 2
    NOT_FINITE = 4
    TOO_LARGE = 5
    UNFIT_START = 6
    UNFIT_INPUT = 7
    STEP_CUT_SHORT = 8
    NO_ITEM = 9
    NO_ITEM_START = 10
    NO_ITEM_INPUT = 11
    NO_TEXT = 12
    LONG_TEXT = 13
    ENDLESS_EVENTS = 14
    FLOATING_CHANGED = 15
    NO_FUNCTION = 31


_OF_STARTS = frozenset({Kind.UNFIT_START, Kind.NO_ITEM_START})


def diagnose(tables: Tables, step: float) -> RunFailed:
    """The failure that the kernel left in *tables*; *step* is the run's communication step in seconds."""
    failure, wiring = tables.system.failure, tables.wiring
    if failure.kind >= ExchangeKind.CHATTERS:
        return _of_exchange(tables, failure, step)
    index, kind = failure.progress.place.element, Kind(failure.kind)
    time = moment_of(tables, step)
    call = failure.progress.place.call
    what = ""
    if kind is Kind.NOT_FINITE:
        index, call = _owner(wiring, failure.position)
        what = not_finite(wiring.values[failure.position], failure.value, time)
    element = wiring.system.elements[index]
    name = function_name(call, element.model.version)
    where = place(element.name, name, time)
    if kind is Kind.BAD_STATUS:
        what = bad_status(where, failure.status)
    elif kind is Kind.NO_INSTANCE:
        what = no_instance(where, needs_tool=element.model.capabilities.needs_tool)
    elif failure.group >= 0:
        labels = tables.starts.labels if kind in _OF_STARTS else tables.labels
        label = labels[failure.group][failure.position]
        what = of_value(kind, label, name.removeprefix(_verb(name)), failure.value, time)
    elif not what:
        what = of_call(kind, where, ended=bool(failure.status))
    fatal = kind is Kind.BAD_STATUS and failure.status == FATAL
    return RunFailed(element.name, name, time, tables.log(index), what, fatal)


def _of_exchange(tables: Tables, failure: layout.Failure, step: float) -> RunFailed:
    index = failure.progress.place.element
    element = tables.wiring.system.elements[index]
    time = moment_of(tables, step)
    what = describe(element, failure.kind, failure.position, failure.status, failure.value)
    name = function_name(failure.progress.place.call, element.model.version)
    return RunFailed(element.name, name, time, tables.log(index), what)


def moment_of(tables: Tables, step: float) -> float | None:
    """When the kernel stopped, in seconds; None before t = 0."""
    failure = tables.system.failure
    if not math.isnan(failure.time):
        return float(failure.time)
    # The plain loop keeps no other clock than the number of its step.
    return failure.progress.step * step if failure.progress.step >= 0 else None


def of_value(kind: Kind, label: str, fmi_type: str, value: float, time: float | None) -> str:
    """What is wrong with one value."""
    if kind is Kind.TOO_LARGE:
        return too_large(label, time)
    if kind is Kind.NO_ITEM:
        return no_item(label, value, time)
    if kind in (Kind.NO_ITEM_START, Kind.NO_ITEM_INPUT):
        return not_an_item(label, value, time)
    if kind is Kind.NO_TEXT:
        return no_text(label, time)
    return long_text(label, time) if kind is Kind.LONG_TEXT else unfit(label, fmi_type, value, time)


def of_call(kind: Kind, where: str, *, ended: bool) -> str:
    """What is wrong with a call."""
    if kind is Kind.ENDLESS_EVENTS:
        return endless_events(where)
    if kind is Kind.FLOATING_CHANGED:
        return floating_changed(where)
    return cut_short(where, ended=ended) if kind is Kind.STEP_CUT_SHORT else no_function(where)


def bad_status(where: str, status: int) -> str:
    """An FMI function returned worse than a warning."""
    return f"{where} returned {STATUS[status] if 0 <= status < len(STATUS) else f'the unknown status {status}'}"


def floating_changed(where: str) -> str:
    """A call has left the processor in another mode, which would change what every other FMU computes."""
    return f"{where} left the processor with another floating-point mode (rounding, flush to zero or traps)"


def no_instance(where: str, *, needs_tool: bool) -> str:
    """An FMU could not be instantiated."""
    return f"{where} returned no instance{', and the FMU says that it needs another program' if needs_tool else ''}"


def not_finite(name: str, value: float, time: float | None) -> str:
    """A wired output is not a number, or infinite."""
    shown = "nan" if math.isnan(value) else str(value)
    return f"{name} became {shown} {moment(time or 0.0)}"


def too_large(name: str, time: float | None) -> str:
    """An integer output cannot be carried as a double."""
    return f"{name} exceeds 2^53 in magnitude{_at(time)}: larger integers cannot be carried exactly"


def unfit(name: str, fmi_type: str, value: float, time: float | None) -> str:
    """A value cannot be given to a variable of that type."""
    if not math.isfinite(value):
        why = "the factor of its wire or its unit makes it too large for a number"
        return f"{name} would become {value}{_at(time)}: {why}"
    return f"{name} cannot take the value {value:.17g}{_at(time)}: it is of type {fmi_type}"


def no_item(name: str, value: float, time: float | None) -> str:
    """An enumeration output has a value that is none of its items."""
    return f"{name} became {value:.17g}{_at(time)}, which is none of the enumeration's items"


def not_an_item(name: str, value: float, time: float | None) -> str:
    """A value cannot be given to an enumeration."""
    return f"{name} cannot take the value {value:.17g}{_at(time)}: it is none of the enumeration's items"


def no_text(name: str, time: float | None) -> str:
    """An FMU gave no string or binary at all."""
    return f"{name} was not given{_at(time)}: the FMU returned a null pointer"


def long_text(name: str, time: float | None) -> str:
    """A string or binary is larger than what is carried."""
    return f"{name} is larger than {LONGEST_TEXT // 2**20} MiB{_at(time)}"


def endless_events(where: str) -> str:
    """Event iteration found no end."""
    return f"{where} asked for more than {MOST_EVENT_ITERATIONS} event iterations at one point in time"


def no_function(where: str) -> str:
    """An FMU is asked for what it cannot do."""
    return f"{where} is not supported by the FMU"


def cut_short(where: str, *, ended: bool) -> str:
    """fmi3DoStep reported OK but did not make the whole step."""
    return f"{where} {'asked to end the simulation' if ended else 'returned before the end of the step'}"


def _verb(name: str) -> str:
    """``fmi2Set`` of ``fmi2SetReal``."""
    return name[: name.find("et") + 2]


def _at(time: float | None) -> str:
    return "" if time is None else f" {moment(time)}"


def _owner(wiring: Wiring, position: int) -> tuple[int, int]:
    for index, groups in enumerate(wiring.outputs):
        for group in groups:
            if position in group.positions:
                return index, _reading(group)
    raise AssertionError(f"no output lies at {position}")


def _reading(group: Group) -> int:
    return Call.GET + group.type
