"""The functions a metric can use: their arguments, their units and the instructions they become."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

import numpy as np

from dse.metrics import functions
from dse.metrics.machine import TIME, Register
from dse.units import Dimension, multiply, parse_unit

Emit = Callable[..., Register]
"""``emit(function, *registers)`` adds an instruction, or finds the one that computes the same already."""


class Wants(StrEnum):
    """What an argument has to be."""

    WAVEFORM = "a waveform"
    CONSTANT = "a constant"
    CONDITION = "a condition over a waveform"


@dataclass(frozen=True, slots=True)
class Argument:
    """An argument of a function. Its unit is *unit*, or with None that of the first argument."""

    name: str
    wants: Wants
    unit: str | None = None
    default: float | None = None
    any_unit: bool = False


@dataclass(frozen=True, slots=True)
class Function:
    """*result* gives the dimension of the value from that of the first argument; *varies* if it is a waveform."""

    arguments: tuple[Argument, ...]
    result: Callable[[Dimension], Dimension]
    emit: Callable[..., Register]
    varies: bool = False


def _seconds(_: Dimension) -> Dimension:
    return parse_unit("s").dimension


def _same(dimension: Dimension) -> Dimension:
    return dimension


def _ratio(_: Dimension) -> Dimension:
    return ()


def _times_seconds(dimension: Dimension) -> Dimension:
    return multiply(dimension, _seconds(dimension))


_X = Argument("x", Wants.WAVEFORM, any_unit=True)
_TARGET = Argument("target", Wants.CONSTANT)
_BAND = Argument("band", Wants.CONSTANT, "", 0.02)
_WINDOW = Argument("window", Wants.CONSTANT, "s", 1.0)


def _of_waveform(function: Callable[..., Any]) -> Callable[..., Register]:
    return lambda emit, *registers: emit(function, *registers)


def _over_time(function: Callable[..., Any]) -> Callable[..., Register]:
    return lambda emit, *registers: emit(function, TIME, *registers)


def _over_rows(function: Callable[..., Any]) -> Callable[..., Register]:
    return lambda emit, x: emit(function, x, emit(functions.row_widths, TIME))


def _overshoot(emit: Emit, x: Register, target: Register) -> Register:
    return emit(functions.relative_excess, emit(functions.maximum, x), target)


def _undershoot(emit: Emit, x: Register, target: Register) -> Register:
    return emit(functions.relative_shortfall, emit(functions.minimum, x), target)


FUNCTIONS: Mapping[str, Function] = {
    "overshoot": Function((_X, _TARGET), _ratio, _overshoot),
    "undershoot": Function((_X, _TARGET), _ratio, _undershoot),
    "rise_time": Function((_X, _TARGET), _seconds, _over_time(functions.rise_time)),
    "reach_time": Function((_X, _TARGET, _BAND), _seconds, _over_time(functions.reach_time)),
    "settling_time": Function((_X, _TARGET, _BAND), _seconds, _over_time(functions.settling_time)),
    "steady_state_error": Function((_X, _TARGET, _WINDOW), _same, _over_time(functions.steady_state_error)),
    "minimum": Function((_X,), _same, _of_waveform(functions.minimum)),
    "maximum": Function((_X,), _same, _of_waveform(functions.maximum)),
    "initial": Function((_X,), _same, _of_waveform(functions.initial)),
    "final": Function((_X,), _same, _of_waveform(functions.final)),
    "mean": Function((_X,), _same, _over_rows(functions.average)),
    "rms": Function((_X,), _same, _over_rows(functions.root_average_square)),
    "integral": Function((_X,), _times_seconds, _over_rows(functions.weighted_sum)),
    "duration": Function((Argument("condition", Wants.CONDITION),), _seconds, _over_rows(functions.time_held)),
    "time_to_collision": Function(
        (Argument("gap", Wants.WAVEFORM, "m"), Argument("closing_speed", Wants.WAVEFORM, "m/s")),
        _seconds,
        _of_waveform(functions.time_to_collision),
        varies=True,
    ),
}
"""Functions of waveforms; `ROWWISE` ones work on single numbers and row by row alike."""

ROWWISE: Mapping[str, Callable[..., Any]] = {
    "abs": np.abs,
    "sqrt": np.sqrt,
    "floor": np.floor,
    "min": np.minimum,
    "max": np.maximum,
}

RELATIVE = frozenset({"overshoot", "undershoot", "reach_time", "settling_time"})
"""Functions whose result or band is a share of the target: undefined for a target of zero."""
