"""What the kernel's failure record means, in words."""

from __future__ import annotations

import math
from enum import IntEnum

from dse.cosim.calls import FATAL, STATUS, Call, function_name
from dse.cosim.failure import RunFailed, moment, place
from dse.cosim.tables import Tables
from dse.cosim.wiring import Group, Wiring


class Kind(IntEnum):
    """Why the kernel stopped, numbered as in kernel.h."""

    NOTHING = 0
    BAD_STATUS = 1
    NO_INSTANCE = 2
    NOT_SETTLED = 3
    NOT_FINITE = 4
    TOO_LARGE = 5
    UNFIT_START = 6
    UNFIT_INPUT = 7
    STEP_CUT_SHORT = 8


def diagnose(tables: Tables, step: float) -> RunFailed:
    """The failure that the kernel left in *tables*; *step* is the run's communication step in seconds."""
    failure, wiring = tables.system.failure, tables.wiring
    index, kind = failure.progress.element, Kind(failure.kind)
    time = failure.progress.step * step if failure.progress.step >= 0 else None
    call = failure.progress.call
    what = ""
    if kind is Kind.NOT_SETTLED:
        moving = tables.still_changing()
        what = unsettled(wiring, moving)
        index, call = _owner(wiring, wiring.values.index(culprits(wiring, moving)[0]))
    elif kind is Kind.NOT_FINITE:
        index, call = _owner(wiring, failure.position)
        what = not_finite(wiring.values[failure.position], failure.value, time)
    elif kind is Kind.TOO_LARGE:
        what = too_large(wiring.values[failure.position], time)
    element = wiring.system.elements[index]
    name = function_name(call, element.model.version)
    where = place(element.name, name, time)
    if kind is Kind.BAD_STATUS:
        what = bad_status(where, failure.status)
    elif kind is Kind.NO_INSTANCE:
        what = no_instance(where)
    elif kind in (Kind.UNFIT_START, Kind.UNFIT_INPUT):
        groups = tables.staged_groups if kind is Kind.UNFIT_INPUT else tables.starts.groups
        variables = [variable for part in groups for group in part for variable in group.variables]
        variable = variables[failure.position]
        what = unfit(f"{element.name}.{variable.name}", variable.fmi_type, failure.value, time)
    elif kind is Kind.STEP_CUT_SHORT:
        what = cut_short(where, ended=bool(failure.status))
    fatal = kind is Kind.BAD_STATUS and failure.status == FATAL
    return RunFailed(element.name, name, time, tables.log(index), what, fatal)


def bad_status(where: str, status: int) -> str:
    """An FMI function returned worse than a warning."""
    return f"{where} returned {STATUS[status] if 0 <= status < len(STATUS) else f'the unknown status {status}'}"


def no_instance(where: str) -> str:
    """An FMU could not be instantiated."""
    return f"{where} returned no instance"


def unsettled(wiring: Wiring, moving: tuple[str, ...]) -> str:
    """The initialization found no fixed point; *moving* are the outputs that still change."""
    wires = [
        f"{wire.source}.{wire.source_variable} -> {wire.target}.{wire.target_variable}"
        for wire in wiring.system.wires
        if f"{wire.source}.{wire.source_variable}" in moving
    ]
    return f"initialization did not settle in {wiring.sweeps} sweeps: still changing: {', '.join(wires or moving)}"


def culprits(wiring: Wiring, moving: tuple[str, ...]) -> tuple[str, ...]:
    """Those of the outputs *moving* that are wired, or all if none is."""
    wired = {wiring.values[position] for position in wiring.wired}
    return tuple(name for name in moving if name in wired) or moving


def not_finite(name: str, value: float, time: float | None) -> str:
    """A wired output is not a number, or infinite."""
    shown = "nan" if math.isnan(value) else str(value)
    return f"{name} became {shown} {moment(time or 0.0)}"


def too_large(name: str, time: float | None) -> str:
    """An integer output cannot be carried as a double."""
    return f"{name} exceeds 2^53 in magnitude{_at(time)}: larger integers cannot be carried exactly"


def unfit(name: str, fmi_type: str, value: float, time: float | None) -> str:
    """A value cannot be given to a variable of that type."""
    return f"{name} cannot take the value {value:.17g}{_at(time)}: it is of type {fmi_type}"


def cut_short(where: str, *, ended: bool) -> str:
    """fmi3DoStep reported OK but did not make the whole step."""
    return f"{where} {'asked to end the simulation' if ended else 'returned before the end of the step'}"


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
