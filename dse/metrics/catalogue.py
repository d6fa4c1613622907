"""The functions a metric can use: their arguments, their units and the instructions they become.

Another package adds one as an entry point of the group ``dse.metrics``, whose name is that of the function::

    def peak_to_peak(x):
        return float(np.max(x) - np.min(x))

    PEAK_TO_PEAK = metric_function(peak_to_peak, [Argument("x", Wants.WAVEFORM, any_unit=True)], same)
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from itertools import pairwise
from typing import Any

import numpy as np

from dse.metrics import functions
from dse.metrics.machine import TIME, Register
from dse.registry import Registry
from dse.units import Dimension, multiply, parse_unit

Emit = Callable[..., Register]
"""``emit(function, *registers)`` adds an instruction, or finds the one that computes the same already."""


class Wants(StrEnum):
    """What an argument has to be, and what the function is given for it.

    * WAVEFORM: a number that varies, ``a.speed``. An array of n ≥ 1 rows, float64.
    * CONSTANT: a number that does not vary during a run, ``5 km/h`` or a parameter. A float.
    * CONDITION: true or false in each row, ``a.speed > 5 km/h``. An array of n truth values.
    """

    WAVEFORM = "a waveform"
    CONSTANT = "a constant"
    CONDITION = "a condition over a waveform"


@dataclass(frozen=True, slots=True)
class Argument:
    """An argument of a function that is what it *wants*.

    Its unit is *unit*, "" for a plain number; without one it is that of the first argument, or with *any_unit* any. As
    a *share* it is between 0 and 1.
    """

    name: str
    wants: Wants
    unit: str | None = None
    default: float | None = None
    any_unit: bool = False
    share: bool = False


@dataclass(frozen=True, slots=True)
class Function:
    """*result* gives the dimension of the value from that of the first argument; *varies* if it is a waveform."""

    arguments: tuple[Argument, ...]
    result: Callable[[Dimension], Dimension]
    emit: Callable[..., Register]
    varies: bool = False


def metric_function(
    function: Callable[..., Any],
    arguments: Sequence[Argument],
    result: str | Callable[[Dimension], Dimension],
    *,
    varies: bool = False,
) -> Function:
    """*function* of a module as a function of metrics.

    It is called with its *arguments* in order, in SI: a waveform is an array of n ≥ 1 rows that must not be written to,
    a condition one of truth values, a constant a number. If its first parameter is called ``time``, the times of the
    rows, in seconds and ascending, come first. It returns a number, NaN where that is undefined, or if it *varies* a
    waveform; what it raises fails the run. *result* is the unit of what it returns, or gives its dimension from that of
    the first argument, as `same`. Workers find the function by its name. Raises ValueError if the parts do not fit.
    """
    parameters = list(inspect.signature(function).parameters)
    timed = parameters[:1] == ["time"] and [argument.name for argument in arguments][:1] != ["time"]
    name = getattr(function, "__qualname__", repr(function))
    if not name.isidentifier():
        raise ValueError(f"{name} is not a function of a module, by whose name workers could find it")
    if len(parameters) != len(arguments) + timed:
        raise ValueError(f"{name} takes {len(parameters) - timed} arguments, {len(arguments)} are declared")
    if not arguments or any(one.default is not None and two.default is None for one, two in pairwise(arguments)):
        raise ValueError(f"{name} needs arguments, those with a default last")
    dimension = (lambda _: parse_unit(result).dimension) if isinstance(result, str) else result
    return Function(tuple(arguments), dimension, (_over_time if timed else _of_waveform)(function), varies)


def same(dimension: Dimension) -> Dimension:
    """The result has the unit of the first argument."""
    return dimension


def _seconds(_: Dimension) -> Dimension:
    return parse_unit("s").dimension


def _ratio(_: Dimension) -> Dimension:
    return ()


def _times_seconds(dimension: Dimension) -> Dimension:
    return multiply(dimension, _seconds(dimension))


_X = Argument("x", Wants.WAVEFORM, any_unit=True)
_TARGET = Argument("target", Wants.CONSTANT)
_BAND = Argument("band", Wants.CONSTANT, "", 0.02)
_CONDITION = Argument("condition", Wants.CONDITION)
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


def _percentile(emit: Emit, x: Register, q: Register) -> Register:
    return emit(functions.percentile, x, emit(functions.row_widths, TIME), q)


FUNCTIONS: Mapping[str, Function] = {
    "overshoot": Function((_X, _TARGET), _ratio, _overshoot),
    "undershoot": Function((_X, _TARGET), _ratio, _undershoot),
    "rise_time": Function((_X, _TARGET), _seconds, _over_time(functions.rise_time)),
    "reach_time": Function((_X, _TARGET, _BAND), _seconds, _over_time(functions.reach_time)),
    "settling_time": Function((_X, _TARGET, _BAND), _seconds, _over_time(functions.settling_time)),
    "steady_state_error": Function((_X, _TARGET, _WINDOW), same, _over_time(functions.steady_state_error)),
    "minimum": Function((_X,), same, _of_waveform(functions.minimum)),
    "maximum": Function((_X,), same, _of_waveform(functions.maximum)),
    "initial": Function((_X,), same, _of_waveform(functions.initial)),
    "final": Function((_X,), same, _of_waveform(functions.final)),
    "at_first": Function((_X, _CONDITION), same, _of_waveform(functions.at_first)),
    "mean": Function((_X,), same, _over_rows(functions.average)),
    "rms": Function((_X,), same, _over_rows(functions.root_average_square)),
    "integral": Function((_X,), _times_seconds, _over_rows(functions.weighted_sum)),
    "percentile": Function((_X, Argument("q", Wants.CONSTANT, "", share=True)), same, _percentile),
    "rolling_mean": Function(
        (_X, Argument("window", Wants.CONSTANT, "s")), same, _over_time(functions.rolling_mean), varies=True
    ),
    "duration": Function((_CONDITION,), _seconds, _over_rows(functions.time_held)),
    "occurrences": Function((_CONDITION,), _ratio, _of_waveform(functions.occurrences)),
    "time_to_collision": Function(
        (Argument("gap", Wants.WAVEFORM, "m"), Argument("closing_speed", Wants.WAVEFORM, "m/s")),
        _seconds,
        _of_waveform(functions.time_to_collision),
        varies=True,
    ),
    "driver_gap": Function(
        (
            Argument("gap", Wants.WAVEFORM, "m"),
            Argument("speed", Wants.WAVEFORM, "m/s"),
            Argument("risk", Wants.CONDITION),
            Argument("delay", Wants.CONSTANT, "s"),
            Argument("deceleration", Wants.CONSTANT, "m/s2"),
            Argument("jerk", Wants.CONSTANT, "m/s3"),
        ),
        same,
        _over_time(functions.driver_gap),
    ),
}
"""Functions of waveforms; `ROWWISE` ones work on single numbers and row by row alike."""

OFFERED: Registry[Function] = Registry("dse.metrics", "metric function", own=FUNCTIONS)
"""The same with those of installed packages, which cannot take a name of ours."""

ROWWISE: Mapping[str, Callable[..., Any]] = {
    "abs": np.abs,
    "sqrt": np.sqrt,
    "floor": np.floor,
    "min": np.minimum,
    "max": np.maximum,
}

RELATIVE_TO_TARGET = frozenset({"overshoot", "undershoot", "reach_time", "settling_time"})
"""Functions whose result or band is a share of the target: undefined for a target of zero."""
