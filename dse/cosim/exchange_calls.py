"""FMI functions of model exchange as the kernel numbers them (enumeration in exchange_memory.h)."""

from __future__ import annotations

from collections.abc import Mapping
from enum import IntEnum


class ExchangeCall(IntEnum):
    """The FMI function of model exchange that is being called."""

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


INSTANTIATE: Mapping[int, str] = {2: "fmi2Instantiate", 3: "fmi3InstantiateModelExchange"}
"""The function that makes an instance, by FMI version."""

FUNCTIONS: Mapping[ExchangeCall, tuple[str, str]] = {
    ExchangeCall.ENTER_EVENT_MODE: ("fmi2EnterEventMode", "fmi3EnterEventMode"),
    ExchangeCall.UPDATE_DISCRETE_STATES: ("fmi2NewDiscreteStates", "fmi3UpdateDiscreteStates"),
    ExchangeCall.ENTER_CONTINUOUS_TIME: ("fmi2EnterContinuousTimeMode", "fmi3EnterContinuousTimeMode"),
    ExchangeCall.SET_TIME: ("fmi2SetTime", "fmi3SetTime"),
    ExchangeCall.SET_CONTINUOUS_STATES: ("fmi2SetContinuousStates", "fmi3SetContinuousStates"),
    ExchangeCall.GET_CONTINUOUS_STATES: ("fmi2GetContinuousStates", "fmi3GetContinuousStates"),
    ExchangeCall.GET_DERIVATIVES: ("fmi2GetDerivatives", "fmi3GetContinuousStateDerivatives"),
    ExchangeCall.GET_EVENT_INDICATORS: ("fmi2GetEventIndicators", "fmi3GetEventIndicators"),
    ExchangeCall.COMPLETED_INTEGRATOR_STEP: ("fmi2CompletedIntegratorStep", "fmi3CompletedIntegratorStep"),
    ExchangeCall.GET_NOMINALS: ("fmi2GetNominalsOfContinuousStates", "fmi3GetNominalsOfContinuousStates"),
    ExchangeCall.GET_STATE_COUNT: ("", "fmi3GetNumberOfContinuousStates"),
    ExchangeCall.GET_INDICATOR_COUNT: ("", "fmi3GetNumberOfEventIndicators"),
}


def exchange_function(call: int, version: int) -> str:
    """Name of the FMI 2 or 3 function behind a call number, "" where there is none."""
    return FUNCTIONS[ExchangeCall(call)][version - 2] if call in set(ExchangeCall) and version in (2, 3) else ""
