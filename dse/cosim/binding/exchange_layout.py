"""A model exchange element as exchange_memory.h and memory.h of the solvers have it, field by field."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping
from typing import Any, ClassVar

from dse.cosim.binding.calls import Call

STAGES, SAMPLES, DENSE = 8, 10, 4
"""Vectors of a step, of its looks at the indicators, of its dense output."""

_Fields = list[tuple[str, Any]]


def pointers(*names: str) -> _Fields:
    """Fields with these names that hold addresses."""
    return [(name, ctypes.c_void_p) for name in names]


def numbers(*names: str) -> _Fields:
    """Fields with these names that are of the type int64_t."""
    return [(name, ctypes.c_int64) for name in names]


def reals(*names: str) -> _Fields:
    """Fields with these names that are doubles."""
    return [(name, ctypes.c_double) for name in names]


class Past(ctypes.Structure):
    """What a solver has learnt and counted (struct dse_past)."""

    _fields_: ClassVar[_Fields] = [
        *reals("next_width", "error_before", "last_event"),
        *numbers("events_close", "will_be_stiff", "signs_of_other", "signs_of_this"),
        *numbers("steps", "rejected", "evaluations", "jacobians", "events"),
    ]


class Reason(ctypes.Structure):
    """Why the FMU could not be evaluated at a point (dse_reason)."""

    _fields_: ClassVar[_Fields] = numbers("kind", "status", "position", "call")


class Solver(ctypes.Structure):
    """The room the solvers work in (struct dse_solver)."""

    _fields_: ClassVar[_Fields] = [
        *reals("tolerance", "start", "width", "end", "span"),
        ("past", Past),
        *pointers("to", "slope", "at_end", "from", "trial", "found"),
        ("stage", ctypes.c_void_p * STAGES),
        ("dense", ctypes.c_void_p * DENSE),
        *pointers("time_slope", "jacobian", "factors", "pivot"),
        ("sample", ctypes.c_void_p * SAMPLES),
        ("sample_at", ctypes.c_double * SAMPLES),
        ("sample_row", ctypes.c_int64 * SAMPLES),
        *pointers("low", "high", "seen"),
        *numbers("samples", "is_stiff", "has_step", "has_event", "has_suspicion", "has_jacobian"),
        *numbers("is_at_end", "is_at_border"),
        ("trouble", Reason),
    ]


class Standing(ctypes.Structure):
    """Where the integration stands."""

    _fields_: ClassVar[_Fields] = [*reals("time", "next_event"), *numbers("in_event_mode")]


FUNCTIONS: Mapping[str, Call] = {
    "enter_event_mode": Call.ENTER_EVENT_MODE,
    "update_discrete_states": Call.UPDATE_DISCRETE_STATES,
    "enter_continuous_time": Call.ENTER_CONTINUOUS_TIME,
    "set_time": Call.SET_TIME,
    "set_states": Call.SET_CONTINUOUS_STATES,
    "get_states": Call.GET_CONTINUOUS_STATES,
    "get_derivatives": Call.GET_DERIVATIVES,
    "get_indicators": Call.GET_EVENT_INDICATORS,
    "completed_step": Call.COMPLETED_INTEGRATOR_STEP,
    "get_nominals": Call.GET_NOMINALS,
    "count_states": Call.GET_STATE_COUNT,
    "count_indicators": Call.GET_INDICATOR_COUNT,
}
"""The fields that hold addresses of FMI functions."""


class Exchange(ctypes.Structure):
    """What the kernel knows of a model exchange FMU."""

    _fields_: ClassVar[_Fields] = [
        *pointers("instantiate", *FUNCTIONS, "state_references", "derivative_references"),
        *numbers("n_references", "n_states", "n_indicators", "needs_completed_step", "has_inputs", "can_be_stiff"),
        ("now", Standing),
        ("kept", Standing),
        ("kept_past", Past),
        *pointers("nominals", "kept_values"),
        *numbers("n_kept"),
        ("solver", Solver),
    ]
