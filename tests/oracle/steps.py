"""One communication step of one instance in plain Python, whatever it takes; stepping.h is the same in C."""

from __future__ import annotations

import math
import time as clock
from ctypes import c_double, c_int

from dse.cosim.binding.abilities import Ability
from dse.cosim.binding.calls import DISCARD, MOST_EVENT_ITERATIONS, PENDING, WARNING, Call, function_name
from dse.cosim.failure.fmu_messages import of_call, place
from dse.cosim.failure.run_failed import StopReason
from oracle.instance import Instance

_STEP_STATUS, _LAST_SUCCESSFUL_TIME, _TERMINATED = 0, 2, 3
_NAP = 2e-5
_NEARLY = 1e-9


def make_step(instance: Instance, time: float, step: float, *, may_roll_back: bool = False) -> None:
    """From *time* over *step* (seconds); RunFailed if the FMU does not get there."""
    if instance.model.version == 3:  # FMI 3
        _step_fmi3(instance, time, step, may_roll_back=may_roll_back)
        return
    end, start = time + step, time
    name = function_name(Call.DO_STEP, instance.model.version)
    status = instance.step_status(time, step, may_roll_back=may_roll_back)
    while True:
        if status == PENDING:
            status = _wait(instance)
        if status != DISCARD:
            instance.judge(name, start, status)
            return
        ends, reached = _wants_to_end(instance), _reached(instance, time)
        is_on = time < reached <= end + _NEARLY * (end - time)
        if ends:
            raise instance.cut_short(reached if is_on else time, ended=True)
        if not is_on:
            instance.judge(name, start, status)
        time = reached
        if time >= end:
            return
        status = instance.step_status(time, end - time, may_roll_back=may_roll_back)


def _wait(instance: Instance) -> int:
    """The status of a step that is made asynchronously, when it is over."""
    while True:
        if instance.finished is not None:
            status, instance.finished = instance.finished, None
            return status
        found = c_int(PENDING)
        answer = instance.status(Call.GET_STATUS, _STEP_STATUS, found)
        if answer is not None and answer > WARNING and answer != PENDING:
            return answer
        if found.value != PENDING:
            return found.value
        clock.sleep(_NAP)


def _wants_to_end(instance: Instance) -> bool:
    ends = c_int(0)
    if instance.model.version != 2:  # FMI 2
        return False
    status = instance.status(Call.GET_BOOLEAN_STATUS, _TERMINATED, ends)
    return status is not None and 0 <= status <= WARNING and bool(ends.value)


def _reached(instance: Instance, time: float) -> float:
    reached = c_double(time)
    status = instance.status(Call.GET_REAL_STATUS, _LAST_SUCCESSFUL_TIME, reached)
    return reached.value if status is not None and 0 <= status <= WARNING else -math.inf


def _step_fmi3(instance: Instance, time: float, step: float, *, may_roll_back: bool) -> None:
    end, start = time + step, time
    splits = Ability.HAS_EVENTS in instance.able and Ability.CAN_VARY_STEP in instance.able
    standstill = 0
    while True:
        stops = splits and time < instance.next_event < end
        target = instance.next_event if stops else end
        length = step if time == start and not stops else target - time
        reached, is_event = instance.fmi3_step(start, time, length, target, may_roll_back=may_roll_back)
        if not reached > time:
            standstill += 1
            if not is_event:
                raise instance.cut_short(start, ended=False)
            if standstill > MOST_EVENT_ITERATIONS:
                name = function_name(Call.DO_STEP, instance.model.version)
                what = of_call(StopReason.ENDLESS_EVENTS, place(instance.name, name, start))
                raise instance.failure(name, start, what)
        time = reached
        if is_event:
            instance.enter_event_mode(start)
            instance.leave_event_mode(start, time)
        if time >= end:
            return
