"""A model exchange element as exchange_memory.h has it, field by field."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping
from typing import Any, ClassVar

from dse.cosim.binding.calls import Call

STAGES, SAMPLES, DENSE = 8, 10, 4
"""Vectors of a step, of its looks at the indicators, of its dense output."""

_Fields = list[tuple[str, Any]]


class Standing(ctypes.Structure):
    """Where the integration stands."""

    _fields_: ClassVar[_Fields] = [
        *[(name, ctypes.c_double) for name in ("time", "next_event", "next_width", "error_before", "last_event")],
        *[
            (name, ctypes.c_int64)
            for name in (
                "events_close",
                "in_event_mode",
                "is_stiff",
                "signs_of_other",
                "signs_of_this",
                "steps",
                "rejected",
                "evaluations",
                "jacobians",
                "events",
            )
        ],
    ]


class Refusal(ctypes.Structure):
    """Why the FMU could not be evaluated at a point."""

    _fields_: ClassVar[_Fields] = [(name, ctypes.c_int64) for name in ("kind", "status", "position", "call")]


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
        *[(name, ctypes.c_void_p) for name in ("instantiate", *FUNCTIONS, "state_references", "derivative_references")],
        *[(name, ctypes.c_int64) for name in ("n_references", "n_states", "n_indicators")],
        *[(name, ctypes.c_int64) for name in ("needs_completed_step", "has_inputs", "can_be_stiff")],
        ("tolerance", ctypes.c_double),
        ("now", Standing),
        ("kept", Standing),
        *[(name, ctypes.c_void_p) for name in ("states", "slope", "indicators", "nominals", "kept_values")],
        ("n_kept", ctypes.c_int64),
        *[(name, ctypes.c_double) for name in ("start", "width", "end", "span")],
        *[(name, ctypes.c_void_p) for name in ("from", "to", "trial", "found", "time_slope")],
        ("stage", ctypes.c_void_p * STAGES),
        ("dense", ctypes.c_void_p * DENSE),
        *[(name, ctypes.c_void_p) for name in ("jacobian", "factors", "pivot")],
        ("sample", ctypes.c_void_p * SAMPLES),
        ("sample_at", ctypes.c_double * SAMPLES),
        *[(name, ctypes.c_void_p) for name in ("low_indicators", "high_indicators", "seen_indicators")],
        *[
            (name, ctypes.c_int64)
            for name in (
                "samples",
                "has_suspicion",
                "has_event",
                "has_jacobian",
                "is_at_end",
                "is_at_border",
                "was_stiff",
            )
        ],
        ("refusal", Refusal),
    ]
