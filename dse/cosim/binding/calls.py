"""FMI functions and variable types as the kernel numbers them (enumerations in kernel.h)."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping
from enum import IntEnum
from functools import cache
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
    """The FMI function being called, with its name in FMI 1, 2 and 3; GET and SET have the accessor type added."""

    names: tuple[str, ...]

    def __new__(cls, number: int, *names: str) -> Call:  # noqa: D102  # an entry
        made = int.__new__(cls, number)
        made._value_, made.names = number, names or ("", "", "")
        return made

    IDLE = 0
    INSTANTIATE = 1, "InstantiateSlave", "Instantiate", "InstantiateCoSimulation"
    FREE_INSTANCE = 2, "FreeSlaveInstance", "FreeInstance", "FreeInstance"
    RESET = 3, "ResetSlave", "Reset", "Reset"
    SETUP_EXPERIMENT = 4, "", "SetupExperiment", ""
    ENTER_INITIALIZATION = 5, "InitializeSlave", "EnterInitializationMode", "EnterInitializationMode"
    EXIT_INITIALIZATION = 6, "", "ExitInitializationMode", "ExitInitializationMode"
    DO_STEP = 7, "DoStep", "DoStep", "DoStep"
    TERMINATE = 8, "TerminateSlave", "Terminate", "Terminate"
    GET_STATUS = 9, "GetStatus", "GetStatus", ""
    GET_REAL_STATUS = 10, "GetRealStatus", "GetRealStatus", ""
    GET_BOOLEAN_STATUS = 11, "GetBooleanStatus", "GetBooleanStatus", ""
    SET_INPUT_DERIVATIVES = 12, "SetRealInputDerivatives", "SetRealInputDerivatives", ""
    ENTER_CONFIGURATION = 13, "", "", "EnterConfigurationMode"
    EXIT_CONFIGURATION = 14, "", "", "ExitConfigurationMode"
    ENTER_STEP_MODE = 15, "", "", "EnterStepMode"
    GET_STATE = 16, "", "GetFMUstate", "GetFMUState"
    SET_STATE = 17, "", "SetFMUstate", "SetFMUState"
    FREE_STATE = 18, "", "FreeFMUstate", "FreeFMUState"
    GET_DIRECTIONAL_DERIVATIVE = 19, "", "GetDirectionalDerivative", "GetDirectionalDerivative"
    LOAD = 20
    """No FMI call: the library is being loaded."""
    ENTER_EVENT_MODE = 32, "", "EnterEventMode", "EnterEventMode"
    UPDATE_DISCRETE_STATES = 33, "", "NewDiscreteStates", "UpdateDiscreteStates"
    ENTER_CONTINUOUS_TIME = 34, "", "EnterContinuousTimeMode", "EnterContinuousTimeMode"
    SET_TIME = 35, "", "SetTime", "SetTime"
    SET_CONTINUOUS_STATES = 36, "", "SetContinuousStates", "SetContinuousStates"
    GET_CONTINUOUS_STATES = 37, "", "GetContinuousStates", "GetContinuousStates"
    GET_DERIVATIVES = 38, "", "GetDerivatives", "GetContinuousStateDerivatives"
    GET_EVENT_INDICATORS = 39, "", "GetEventIndicators", "GetEventIndicators"
    COMPLETED_INTEGRATOR_STEP = 40, "", "CompletedIntegratorStep", "CompletedIntegratorStep"
    GET_NOMINALS = 41, "", "GetNominalsOfContinuousStates", "GetNominalsOfContinuousStates"
    GET_STATE_COUNT = 42, "", "", "GetNumberOfContinuousStates"
    GET_INDICATOR_COUNT = 43, "", "", "GetNumberOfEventIndicators"
    GET_CLOCK = 44, "", "", "GetClock"
    SET_CLOCK = 45, "", "", "SetClock"
    GET_INTERVAL_DECIMAL = 46, "", "", "GetIntervalDecimal"
    GET_INTERVAL_FRACTION = 47, "", "", "GetIntervalFraction"
    GET_SHIFT_DECIMAL = 48, "", "", "GetShiftDecimal"
    GET_SHIFT_FRACTION = 49, "", "", "GetShiftFraction"
    GET = 64
    SET = 96


class AccessorType(IntEnum):
    """How a variable's accessor passes it, as FMI 3 calls that; in the table of values everything is a double."""

    fmi_type: str
    c_type: Any

    def __new__(cls, number: int, fmi_type: str = "", c_type: Any = None) -> AccessorType:  # noqa: D102  # an entry
        made = int.__new__(cls, number)
        made._value_, made.fmi_type, made.c_type = number, fmi_type, c_type
        return made

    FLOAT64 = 0, "Float64", ctypes.c_double
    FLOAT32 = 1, "Float32", ctypes.c_float
    INT8 = 2, "Int8", ctypes.c_int8
    UINT8 = 3, "UInt8", ctypes.c_uint8
    INT16 = 4, "Int16", ctypes.c_int16
    UINT16 = 5, "UInt16", ctypes.c_uint16
    INT32 = 6, "Int32", ctypes.c_int32
    UINT32 = 7, "UInt32", ctypes.c_uint32
    INT64 = 8, "Int64", ctypes.c_int64
    UINT64 = 9, "UInt64", ctypes.c_uint64
    BOOLEAN = 10, "Boolean", ctypes.c_bool
    FMI2_BOOLEAN = 11, "", ctypes.c_int32
    STRING = 12, "String", ctypes.c_void_p
    BINARY = 13, "Binary", ctypes.c_void_p
    FMI1_BOOLEAN = 14, "", ctypes.c_int8
    OSMP = 15, "", ctypes.c_void_p
    """A binary of FMI 2, passed as three integers."""

    @property
    def size(self) -> int:
        """Bytes of one value."""
        return ctypes.sizeof(self.c_type)

    @property
    def is_floating(self) -> bool:
        """Whether it is a floating-point number."""
        return self in (AccessorType.FLOAT64, AccessorType.FLOAT32)

    @property
    def is_boolean(self) -> bool:
        """Whether it is true or false."""
        return self in (AccessorType.BOOLEAN, AccessorType.FMI2_BOOLEAN, AccessorType.FMI1_BOOLEAN)

    @property
    def is_text(self) -> bool:
        """Whether it is a string or binary."""
        return self is AccessorType.STRING or self.is_binary

    @property
    def is_binary(self) -> bool:
        """Whether it is a binary, however it is passed."""
        return self in (AccessorType.BINARY, AccessorType.OSMP)


EXACT_INTEGER = 2**53
"""Beyond it a double no longer tells integers apart."""

_FMI1_AND_2 = {"Real": AccessorType.FLOAT64, "Integer": AccessorType.INT32, "String": AccessorType.STRING}
_FMI_TYPES: Mapping[int, Mapping[str, AccessorType]] = {
    1: {**_FMI1_AND_2, "Boolean": AccessorType.FMI1_BOOLEAN},
    2: {**_FMI1_AND_2, "Boolean": AccessorType.FMI2_BOOLEAN, "Binary": AccessorType.OSMP},
    3: {known.fmi_type: known for known in AccessorType if known.fmi_type},
}
_ACCESSORS: Mapping[int, Mapping[int, str]] = {
    version: {number: name for name, number in types.items()} for version, types in _FMI_TYPES.items()
}

FUNCTIONS = (
    *(call for call in Call if Call.IDLE < call < Call.LOAD),
    Call.ENTER_EVENT_MODE,
    Call.UPDATE_DISCRETE_STATES,
)
"""What the kernel calls of an element besides its accessors, in the order of kernel.h."""


def is_good(status: int) -> bool:
    """Whether *status* is no worse than a warning."""
    return 0 <= status <= WARNING


def type_of(variable: Variable, version: int) -> AccessorType | None:
    """The accessor type of a number in an FMU of FMI *version*; None for strings, clocks and whatever else."""
    found = _FMI_TYPES[version].get(variable.fmi_type)
    return None if found is None or found.is_text else found


def text_type_of(variable: Variable, version: int) -> AccessorType | None:
    """The accessor type of a string or binary in an FMU of FMI *version*; None for all else."""
    found = _FMI_TYPES[version].get(variable.fmi_type)
    return found if found is not None and found.is_text else None


@cache
def function_name(call: int, version: int) -> str:
    """Name of the FMI function behind a call number, "" where this version has none or the number means nothing.

    Those of FMI 1.0 are without the prefix that each FMU puts before them.
    """
    prefix = "fmi" if version == 1 else f"fmi{version}"
    for access in (Call.SET, Call.GET):
        if call >= access:
            fmi_type = _ACCESSORS[version].get(call - access)
            fmi_type = "Integer" if version == 2 and fmi_type == "Binary" else fmi_type  # OSMP
            return f"{prefix}{access.name.title()}{fmi_type}" if fmi_type else ""
    name = Call(call).names[version - 1] if call in set(Call) else ""
    return f"{prefix}{name}" if name else ""
