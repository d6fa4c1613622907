"""What an element is able to do: what its FMU says of itself, as far as its library has the functions for it."""

from __future__ import annotations

import ctypes
from enum import IntFlag

from dse.cosim.binding.calls import Call, function_name
from dse.cosim.binding.library import find
from dse.domain.fmu import FmiInterface, FmuModel


class Ability(IntFlag):
    """Numbered as in kernel.h."""

    NONE = 0
    CAN_VARY_STEP = 1
    CAN_SAVE = 2
    TAKES_DERIVATIVES = 4
    HAS_EVENTS = 8
    CAN_RETURN_EARLY = 16
    ASKS_BETWEEN = 32
    CAN_DIRECTIONAL = 64
    TICKS = 128
    """Its clocks are simulated; set where these are compiled."""


_NEEDED = {
    Ability.CAN_SAVE: (Call.GET_STATE, Call.SET_STATE, Call.FREE_STATE),
    Ability.TAKES_DERIVATIVES: (Call.SET_INPUT_DERIVATIVES,),
    Ability.HAS_EVENTS: (Call.ENTER_EVENT_MODE, Call.UPDATE_DISCRETE_STATES, Call.ENTER_STEP_MODE),
    Ability.CAN_DIRECTIONAL: (Call.GET_DIRECTIONAL_DERIVATIVE,),
}


def abilities_of(model: FmuModel, library: ctypes.CDLL) -> Ability:
    """What instances of *model* can do."""
    able = model.capabilities
    is_exchange = model.interface is FmiInterface.MODEL_EXCHANGE
    steps = not is_exchange and model.version == 3  # FMI 3
    claimed = {
        Ability.CAN_VARY_STEP: able.can_handle_variable_step,
        Ability.CAN_SAVE: able.can_save_state,
        Ability.TAKES_DERIVATIVES: able.can_interpolate_inputs and not is_exchange and not steps,
        Ability.HAS_EVENTS: able.has_event_mode and steps,
        Ability.CAN_RETURN_EARLY: able.can_return_early and steps,
        Ability.ASKS_BETWEEN: able.provides_intermediate_update and steps,
        Ability.CAN_DIRECTIONAL: able.provides_directional_derivatives,
    }
    found = Ability.NONE
    for ability, says_so in claimed.items():
        if says_so and all(
            find(model, library, function_name(call, model.version)) for call in _NEEDED.get(ability, ())
        ):
            found |= ability
    return found


def takes_slopes(model: FmuModel, able: Ability) -> bool:
    """Whether an element can do anything with slopes of its inputs."""
    if model.interface is FmiInterface.MODEL_EXCHANGE or Ability.TAKES_DERIVATIVES in able:
        return True
    return Ability.ASKS_BETWEEN in able and any(
        variable.causality == "input" and variable.is_intermediate for variable in model.variables.values()
    )
