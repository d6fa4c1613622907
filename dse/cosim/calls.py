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
FATAL = 4


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
    GET = 16
    SET = 32


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
}

_FMI_TYPES: Mapping[int, Mapping[str, Type]] = {
    2: {"Real": Type.FLOAT64, "Integer": Type.INT32, "Boolean": Type.FMI2_BOOLEAN},
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
    },
}
_ACCESSORS = {
    version: {number: fmi_type for fmi_type, number in types.items()} for version, types in _FMI_TYPES.items()
}

_LIFECYCLE: Mapping[Call, tuple[str, str]] = {
    Call.INSTANTIATE: ("fmi2Instantiate", "fmi3InstantiateCoSimulation"),
    Call.FREE_INSTANCE: ("fmi2FreeInstance", "fmi3FreeInstance"),
    Call.RESET: ("fmi2Reset", "fmi3Reset"),
    Call.SETUP_EXPERIMENT: ("fmi2SetupExperiment", ""),
    Call.ENTER_INITIALIZATION: ("fmi2EnterInitializationMode", "fmi3EnterInitializationMode"),
    Call.EXIT_INITIALIZATION: ("fmi2ExitInitializationMode", "fmi3ExitInitializationMode"),
    Call.DO_STEP: ("fmi2DoStep", "fmi3DoStep"),
    Call.TERMINATE: ("fmi2Terminate", "fmi3Terminate"),
}


def type_of(variable: Variable, version: int) -> Type | None:
    """The accessor type of *variable* in an FMU of FMI *version*; None for strings, clocks and whatever else."""
    return _FMI_TYPES[version].get(variable.fmi_type)


def function_name(call: int, version: int) -> str:
    """Name of the FMI function behind a call number, "" where this version has none or the number means nothing."""
    for access, verb in ((Call.SET, "Set"), (Call.GET, "Get")):
        if call >= access:
            fmi_type = _ACCESSORS[version].get(Type(call - access)) if call - access in set(Type) else None
            return f"fmi{version}{verb}{fmi_type}" if fmi_type else ""
    return _LIFECYCLE[Call(call)][version - 2] if call in set(_LIFECYCLE) else ""
