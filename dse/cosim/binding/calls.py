"""FMI functions and variable types as the kernel numbers them (enumerations in kernel.h)."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping
from enum import IntEnum
from typing import Any

from dse.domain.fmu import Variable

STATUS = ("ok", "warning", "discard", "error", "fatal", "pending")
"""What an FMI function returns, in words."""

WARNING = 1
DISCARD = 2
FATAL = 4
PENDING = 5

LONGEST_TEXT = 16 * 2**20
"""Bytes of a string or binary that are carried."""

MOST_EVENT_ITERATIONS = 1000
"""At one point in time."""


class Call(IntEnum):
    """The FMI function being called; GET and SET have the variable type added."""

    IDLE = 0
    INSTANTIATE = 1
    FREE_INSTANCE = 2
    RESET = 3
    SETUP_EXPERIMENT = 4
    ENTER_INITIALIZATION = 5
    EXIT_INITIALIZATION = 6
    DO_STEP = 7
    TERMINATE = 8
    GET_STATUS = 9
    GET_REAL_STATUS = 10
    GET_BOOLEAN_STATUS = 11
    SET_INPUT_DERIVATIVES = 12
    ENTER_CONFIGURATION = 13
    EXIT_CONFIGURATION = 14
    ENTER_STEP_MODE = 15
    GET_STATE = 16
    SET_STATE = 17
    FREE_STATE = 18
    GET_DIRECTIONAL_DERIVATIVE = 19
    LOAD = 20
    """No FMI call: the library is being loaded."""
    ENTER_EVENT_MODE = 32
    UPDATE_DISCRETE_STATES = 33
    ENTER_CONTINUOUS_TIME = 34
    SET_TIME = 35
    SET_CONTINUOUS_STATES = 36
    GET_CONTINUOUS_STATES = 37
    GET_DERIVATIVES = 38
    GET_EVENT_INDICATORS = 39
    COMPLETED_INTEGRATOR_STEP = 40
    GET_NOMINALS = 41
    GET_STATE_COUNT = 42
    GET_INDICATOR_COUNT = 43
    GET = 64
    SET = 96


class Type(IntEnum):
    """How a variable's accessor passes it; in the table of values everything is a double."""

    FLOAT64 = 0
    FLOAT32 = 1
    INT8 = 2
    UINT8 = 3
    INT16 = 4
    UINT16 = 5
    INT32 = 6
    UINT32 = 7
    INT64 = 8
    UINT64 = 9
    BOOLEAN = 10
    FMI2_BOOLEAN = 11
    STRING = 12
    BINARY = 13
    FMI1_BOOLEAN = 14


EXACT_INTEGER = 2**53
"""Beyond it a double no longer tells integers apart."""

FLOATING = frozenset({Type.FLOAT64, Type.FLOAT32})

C_TYPES: Mapping[Type, Any] = {
    Type.FLOAT64: ctypes.c_double,
    Type.FLOAT32: ctypes.c_float,
    Type.INT8: ctypes.c_int8,
    Type.UINT8: ctypes.c_uint8,
    Type.INT16: ctypes.c_int16,
    Type.UINT16: ctypes.c_uint16,
    Type.INT32: ctypes.c_int32,
    Type.UINT32: ctypes.c_uint32,
    Type.INT64: ctypes.c_int64,
    Type.UINT64: ctypes.c_uint64,
    Type.BOOLEAN: ctypes.c_bool,
    Type.FMI2_BOOLEAN: ctypes.c_int32,
    Type.FMI1_BOOLEAN: ctypes.c_int8,
}

TRUTHS = frozenset({Type.BOOLEAN, Type.FMI2_BOOLEAN, Type.FMI1_BOOLEAN})

_FMI_TYPES: Mapping[int, Mapping[str, Type]] = {
    1: {"Real": Type.FLOAT64, "Integer": Type.INT32, "Boolean": Type.FMI1_BOOLEAN, "String": Type.STRING},
    2: {"Real": Type.FLOAT64, "Integer": Type.INT32, "Boolean": Type.FMI2_BOOLEAN, "String": Type.STRING},
    3: {
        "Float64": Type.FLOAT64,
        "Float32": Type.FLOAT32,
        "Int8": Type.INT8,
        "UInt8": Type.UINT8,
        "Int16": Type.INT16,
        "UInt16": Type.UINT16,
        "Int32": Type.INT32,
        "UInt32": Type.UINT32,
        "Int64": Type.INT64,
        "UInt64": Type.UINT64,
        "Boolean": Type.BOOLEAN,
        "String": Type.STRING,
        "Binary": Type.BINARY,
    },
}
_TEXTS = frozenset({Type.STRING, Type.BINARY})
_ACCESSORS = {
    version: {number: fmi_type for fmi_type, number in types.items()} for version, types in _FMI_TYPES.items()
}

_NAMES: Mapping[Call, tuple[str, str, str]] = {
    Call.INSTANTIATE: ("InstantiateSlave", "Instantiate", "InstantiateCoSimulation"),
    Call.FREE_INSTANCE: ("FreeSlaveInstance", "FreeInstance", "FreeInstance"),
    Call.RESET: ("ResetSlave", "Reset", "Reset"),
    Call.SETUP_EXPERIMENT: ("", "SetupExperiment", ""),
    Call.ENTER_INITIALIZATION: ("InitializeSlave", "EnterInitializationMode", "EnterInitializationMode"),
    Call.EXIT_INITIALIZATION: ("", "ExitInitializationMode", "ExitInitializationMode"),
    Call.DO_STEP: ("DoStep", "DoStep", "DoStep"),
    Call.TERMINATE: ("TerminateSlave", "Terminate", "Terminate"),
    Call.GET_STATUS: ("GetStatus", "GetStatus", ""),
    Call.GET_REAL_STATUS: ("GetRealStatus", "GetRealStatus", ""),
    Call.GET_BOOLEAN_STATUS: ("GetBooleanStatus", "GetBooleanStatus", ""),
    Call.SET_INPUT_DERIVATIVES: ("SetRealInputDerivatives", "SetRealInputDerivatives", ""),
    Call.ENTER_CONFIGURATION: ("", "", "EnterConfigurationMode"),
    Call.EXIT_CONFIGURATION: ("", "", "ExitConfigurationMode"),
    Call.ENTER_STEP_MODE: ("", "", "EnterStepMode"),
    Call.GET_STATE: ("", "GetFMUstate", "GetFMUState"),
    Call.SET_STATE: ("", "SetFMUstate", "SetFMUState"),
    Call.FREE_STATE: ("", "FreeFMUstate", "FreeFMUState"),
    Call.GET_DIRECTIONAL_DERIVATIVE: ("", "GetDirectionalDerivative", "GetDirectionalDerivative"),
    Call.ENTER_EVENT_MODE: ("", "EnterEventMode", "EnterEventMode"),
    Call.UPDATE_DISCRETE_STATES: ("", "NewDiscreteStates", "UpdateDiscreteStates"),
    Call.ENTER_CONTINUOUS_TIME: ("", "EnterContinuousTimeMode", "EnterContinuousTimeMode"),
    Call.SET_TIME: ("", "SetTime", "SetTime"),
    Call.SET_CONTINUOUS_STATES: ("", "SetContinuousStates", "SetContinuousStates"),
    Call.GET_CONTINUOUS_STATES: ("", "GetContinuousStates", "GetContinuousStates"),
    Call.GET_DERIVATIVES: ("", "GetDerivatives", "GetContinuousStateDerivatives"),
    Call.GET_EVENT_INDICATORS: ("", "GetEventIndicators", "GetEventIndicators"),
    Call.COMPLETED_INTEGRATOR_STEP: ("", "CompletedIntegratorStep", "CompletedIntegratorStep"),
    Call.GET_NOMINALS: ("", "GetNominalsOfContinuousStates", "GetNominalsOfContinuousStates"),
    Call.GET_STATE_COUNT: ("", "", "GetNumberOfContinuousStates"),
    Call.GET_INDICATOR_COUNT: ("", "", "GetNumberOfEventIndicators"),
}

FUNCTIONS = (
    *(call for call in Call if Call.IDLE < call < Call.LOAD),
    Call.ENTER_EVENT_MODE,
    Call.UPDATE_DISCRETE_STATES,
)
"""What the kernel calls of an element besides its accessors, in the order of kernel.h."""


def type_of(variable: Variable, version: int) -> Type | None:
    """The accessor type of a number in an FMU of FMI *version*; None for strings, clocks and whatever else."""
    kind = _FMI_TYPES[version].get(variable.fmi_type)
    return None if kind in _TEXTS else kind


def text_type_of(variable: Variable, version: int) -> Type | None:
    """The accessor type of a string or binary in an FMU of FMI *version*; None for all else."""
    kind = _FMI_TYPES[version].get(variable.fmi_type)
    return kind if kind in _TEXTS else None


def function_name(call: int, version: int) -> str:
    """Name of the FMI function behind a call number, "" where this version has none or the number means nothing.

    Those of FMI 1.0 are without the prefix that each FMU puts before them.
    """
    prefix = "fmi" if version == 1 else f"fmi{version}"
    for access, verb in ((Call.SET, "Set"), (Call.GET, "Get")):
        if call >= access:
            fmi_type = _ACCESSORS[version].get(Type(call - access)) if call - access in set(Type) else None
            return f"{prefix}{verb}{fmi_type}" if fmi_type else ""
    name = _NAMES[Call(call)][version - 1] if call in set(_NAMES) else ""
    return f"{prefix}{name}" if name else ""
