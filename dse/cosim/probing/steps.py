"""Steps and events of one instance, whatever they take; stepping.h and events.h are the same in C."""

from __future__ import annotations

import time as clock
from ctypes import byref, c_bool, c_byte, c_double, c_int
from math import inf
from typing import Any

from dse.cosim.binding.abilities import Ability
from dse.cosim.binding.calls import DISCARD, MOST_EVENT_ITERATIONS, PENDING, Call, function_name, is_good
from dse.cosim.binding.library import find
from dse.cosim.failure.run_failed import StopReason
from dse.cosim.probing.instance import FmuInstance

_STEP_STATUS, _LAST_SUCCESSFUL_TIME, _TERMINATED = 0, 2, 3
_NAP = 2e-5
_NEARLY = 1e-9  # of a step: FMUs add up their times


def make_step(instance: FmuInstance, time: float, step: float, *, may_roll_back: bool) -> None:
    """From *time* over *step* (seconds); RunFailed if the FMU does not get there."""
    if instance.part.exchange:
        instance.system.may_roll_back = may_roll_back
        instance.ask_kernel("exchange_step", time, c_double(time), c_double(step))
    elif instance.model.version == 3:
        _step_fmi3(instance, time, step, may_roll_back=may_roll_back)
    else:
        _step_fmi2(instance, time, step, may_roll_back=may_roll_back)


def leave_event_mode(instance: FmuInstance, time: float | None) -> None:
    """Iterate until nothing changes any more, then go on in step mode."""
    name = function_name(Call.UPDATE_DISCRETE_STATES, 3)
    for _ in range(MOST_EVENT_ITERATIONS):
        again, ended, nominals, states, known = (c_bool() for _ in range(5))
        event = c_double()
        instance.call(name, time, *(byref(result) for result in (again, ended, nominals, states, known, event)))
        if ended.value:
            raise instance.failure(StopReason.STEP_CUT_SHORT, name, time, 1)
        instance.part.next_event = event.value if known.value else inf
        if not again.value:
            instance.call(Call.ENTER_STEP_MODE, time)
            return
    raise instance.failure(StopReason.ENDLESS_EVENTS, name, time)


def _step_fmi2(instance: FmuInstance, begin: float, step: float, *, may_roll_back: bool) -> None:
    version = instance.model.version
    name = function_name(Call.DO_STEP, version)
    # FMI 1 is told that the step is new, FMI 2 whether it is for good.
    last = c_byte(1) if version == 1 else c_int(not may_roll_back)
    time, length, end = begin, step, begin + step
    while True:
        instance.part.finished = -1
        status = instance.ask(name, c_double(time), c_double(length), last)
        if status == PENDING:
            status = _wait(instance)
        if status != DISCARD:
            instance.judge(name, begin, status)
            return
        ends, reached = c_int(0), c_double(time)
        # FMI 1 has no such status.
        if version == 2 and is_good(_status(instance, Call.GET_BOOLEAN_STATUS, _TERMINATED, ends)) and ends.value:
            raise instance.failure(StopReason.STEP_CUT_SHORT, name, begin, 1)
        told = _status(instance, Call.GET_REAL_STATUS, _LAST_SUCCESSFUL_TIME, reached)
        if not (is_good(told) and time < reached.value <= end + _NEARLY * (end - time)):
            instance.judge(name, begin, status)
        time = reached.value
        if time >= end:
            return
        length = end - time


def _wait(instance: FmuInstance) -> int:
    """The status of a step that is made asynchronously, when it is over."""
    while instance.part.finished < 0:
        found = c_int(PENDING)
        answer = _status(instance, Call.GET_STATUS, _STEP_STATUS, found)
        if answer not in (-1, PENDING) and not is_good(answer):
            return answer
        if found.value != PENDING:
            return found.value
        clock.sleep(_NAP)
    return int(instance.part.finished)


def _status(instance: FmuInstance, call: Call, what: int, answer: Any) -> int:
    """What GetStatus and its like return for *what*; -1 without them."""
    name = function_name(call, instance.model.version)
    known = find(instance.model, instance.library, name) is not None
    return instance.ask(name, c_int(what), byref(answer)) if known else -1


def _step_fmi3(instance: FmuInstance, begin: float, step: float, *, may_roll_back: bool) -> None:
    name = function_name(Call.DO_STEP, 3)
    has_events = Ability.HAS_EVENTS in instance.able
    splits = has_events and Ability.CAN_VARY_STEP in instance.able
    time, end, standstill = begin, begin + step, 0
    while True:
        stops = splits and time < instance.part.next_event < end
        target = instance.part.next_event if stops else end
        length = step if time == begin and not stops else target - time
        event, ended, early, reached = c_bool(), c_bool(), c_bool(), c_double(target)
        results = (byref(result) for result in (event, ended, early, reached))
        instance.call(name, begin, c_double(time), c_double(length), c_bool(not may_roll_back), *results)
        if ended.value or (early.value and Ability.CAN_RETURN_EARLY not in instance.able):
            raise instance.failure(StopReason.STEP_CUT_SHORT, name, begin, ended.value)
        is_event = event.value and has_events
        arrived = min(reached.value, target) if early.value else target
        if not arrived > time:
            standstill += 1
            if not is_event or standstill > MOST_EVENT_ITERATIONS:
                reason = StopReason.ENDLESS_EVENTS if is_event else StopReason.STEP_CUT_SHORT
                raise instance.failure(reason, name, begin)
        time = arrived
        if is_event:
            instance.call(Call.ENTER_EVENT_MODE, begin)
            leave_event_mode(instance, begin)
        if time >= end:
            return
