"""One instance of an FMU by itself, called function by function: experiments do with it what no simulation does.

The kernel makes it, resets and frees it, and integrates it if it is for model exchange.
"""

from __future__ import annotations

import ctypes
import math
import struct
import time as clock
from collections.abc import Callable, Iterable, Mapping
from ctypes import byref, c_bool, c_byte, c_double, c_int, c_int32, c_size_t, c_uint32, c_void_p
from typing import Any

from dse.cosim.binding import layout
from dse.cosim.binding.abilities import Ability
from dse.cosim.binding.calls import (
    DISCARD,
    EXACT_INTEGER,
    FATAL,
    LONGEST_TEXT,
    MOST_EVENT_ITERATIONS,
    PENDING,
    WARNING,
    AccessorType,
    Call,
    function_name,
    text_type_of,
    type_of,
)
from dse.cosim.binding.library import address, find
from dse.cosim.failing.diagnosis import failed_call
from dse.cosim.failing.failure import RunFailed
from dse.cosim.failing.reason import StopReason
from dse.cosim.failing.words import of_call, of_value, place
from dse.cosim.probing.drive import driven, start_of, watched
from dse.cosim.tables.elements import KernelElements
from dse.cosim.wiring.wiring import groups_by_type, is_discrete_input
from dse.domain.fmu import FmuModel, Variable
from dse.domain.system import Element

_STEP_STATUS, _LAST_SUCCESSFUL_TIME, _TERMINATED = 0, 2, 3
_NAP = 2e-5
_NEARLY = 1e-9  # of a step: FMUs add up their times


class FmuInstance:
    """An instance of *model* called *name*: `initialize` it, write, step and read, `terminate`; `reset` and again.

    Every method raises RunFailed if the FMU reports an error, with the *time* it is told, None before t = 0.
    """

    def __init__(self, name: str, model: FmuModel) -> None:
        self.model = model
        self._element = Element(name, model, driven(model), watched(model), {})
        elements = KernelElements([self._element])
        elements.set_between(0, (group for group in groups_by_type(self._element, driven(model)) if group.moves))
        self._elements, self._part = elements, elements.structures[0]
        self._able = Ability(self._part.abilities)
        self._kernel = layout.kernel()
        self._system = layout.System(elements=ctypes.addressof(elements.structures), n_elements=1)
        self._state = c_void_p.from_buffer(self._part, layout.Element.saved.offset)  # freed with the instance
        self._given: dict[str, bytes] = {}
        """What discrete inputs were given last, by name."""
        self._saved = math.inf, self._given
        self._check(self._kernel.dse_instantiate(byref(self._system)), None)

    @property
    def library(self) -> ctypes.CDLL:
        """The FMU's library."""
        return self._elements.library(0)

    def close(self) -> None:
        """Free the state that is kept and the instance, once; nothing happens after a fatal error."""
        self._kernel.dse_free(byref(self._system))
        self._elements.release()

    def reset(self) -> None:
        """Back to what it was when it was new."""
        self._check(self._kernel.dse_reset(byref(self._system)), None)

    def initialize(self, stop: float, parameters: Mapping[str, float], inputs: Mapping[str, float]) -> None:
        """From new into step mode, with these values by label."""
        version = self.model.version
        self._part.next_event = math.inf
        if version == 2:  # FMI 2
            times = c_double(0.0), c_double(0.0), c_int(1), c_double(stop)
            self._call(Call.SETUP_EXPERIMENT, None, c_int(0), *times)
        self._set(self.model.variables.values(), parameters, None)
        enter = Call.ENTER_INITIALIZATION
        if version == 1:
            self._set(self._element.inputs, inputs, None)
            self._call(enter, None, c_double(0.0), c_byte(1), c_double(stop))
            self.read(None)
            return
        if version == 2:  # FMI 2
            self._call(enter, None)
        else:
            self._call(enter, None, c_bool(False), c_double(0.0), c_double(0.0), c_bool(True), c_double(stop))
        self._set(self._element.inputs, inputs, None)
        self._given = {v.name: bytes(self._room(v, inputs, None)) for v in self._discrete()}
        self.read(None)
        if self._part.exchange:
            self._check(self._kernel.dse_exchange_start(byref(self._system)), None)
            return
        self._call(Call.EXIT_INITIALIZATION, None)
        if Ability.HAS_EVENTS in self._able:
            self._leave_event_mode(None)

    def terminate(self, time: float) -> None:
        """At the end of a run."""
        self._call(Call.TERMINATE, time)

    # ---- values ----

    def read(self, time: float | None) -> tuple[bytes, ...]:
        """The bits of all outputs, value by value."""
        found: list[bytes] = []
        for variable in self._element.outputs:
            if text_type_of(variable, self.model.version) is None:
                found += (struct.pack("<d", value) for value in self._numbers(variable, time))
            else:
                found += self._texts(variable, time)
        return tuple(found)

    def write(self, inputs: Mapping[str, float], time: float) -> None:
        """Set all inputs, by label; discrete ones that change are an event."""
        discrete = self._discrete()
        self._set((v for v in self._element.inputs if v not in discrete), inputs, time)
        rooms = {v.name: bytes(self._room(v, inputs, time)) for v in discrete}
        if changed := [v for v in discrete if self._given[v.name] != rooms[v.name]]:
            self._call(Call.ENTER_EVENT_MODE, time)
            self._set(changed, inputs, time)
            self._given = rooms
            self._leave_event_mode(time)

    def _discrete(self) -> list[Variable]:
        """Inputs that are set in event mode."""
        has_events = Ability.HAS_EVENTS in self._able
        return [v for v in self._element.inputs if has_events and is_discrete_input(v, self.model)]

    def _set(self, variables: Iterable[Variable], values: Mapping[str, float], time: float | None) -> None:
        for variable in variables:
            if any(label in values for label in variable.labels):
                self._access(Call.SET, variable, self._room(variable, values, time), time)

    def _room(self, variable: Variable, values: Mapping[str, float], time: float | None) -> Any:
        """*values* as the accessor takes them; what is not among them is what the FMU starts with."""
        kind = self._type(variable)
        found = [values.get(label, start_of(variable, index)) for index, label in enumerate(variable.labels)]
        for label, value in zip(variable.labels, found, strict=True):
            if not fits(value, kind):
                raise self._bad_value(StopReason.UNFIT_INPUT, Call.SET, variable, label, time, value)
        return (kind.c_type * len(found))(*(value if kind.is_floating else int(value) for value in found))

    def _numbers(self, variable: Variable, time: float | None) -> list[float]:
        kind = self._type(variable)
        room = (kind.c_type * variable.size)()
        self._access(Call.GET, variable, room, time)
        for label, value in zip(variable.labels, room, strict=True):
            if kind in (AccessorType.INT64, AccessorType.UINT64) and abs(value) > EXACT_INTEGER:
                raise self._bad_value(StopReason.TOO_LARGE, Call.GET, variable, label, time)
        return [float(bool(value)) if kind.is_boolean else float(value) for value in room]

    def _texts(self, variable: Variable, time: float | None) -> list[bytes]:
        pointers, sizes = (c_void_p * variable.size)(), (c_size_t * variable.size)()
        is_binary = text_type_of(variable, self.model.version) is AccessorType.BINARY
        self._access(Call.GET, variable, pointers, time, sizes if is_binary else None)
        found = []
        for label, pointer, size in zip(variable.labels, pointers, sizes, strict=True):
            if pointer is None and (size or not is_binary):
                raise self._bad_value(StopReason.NO_TEXT, Call.GET, variable, label, time)
            text = (
                b"" if pointer is None else ctypes.string_at(pointer, min(size, LONGEST_TEXT + 1) if is_binary else -1)
            )
            if len(text) > LONGEST_TEXT:
                raise self._bad_value(StopReason.LONG_TEXT, Call.GET, variable, label, time)
            found.append(text)
        return found

    def _access(self, verb: Call, variable: Variable, room: Any, time: float | None, sizes: Any = None) -> None:
        # FMI 1 and 2 are not told how many values.
        counted = (c_size_t(len(room)),) if self.model.version == 3 else ()
        before = () if sizes is None else (byref(sizes),)
        arguments = (byref(c_uint32(variable.reference)), c_size_t(1), *before, byref(room), *counted)
        self._call(verb + self._type(variable), time, *arguments)

    def _type(self, variable: Variable) -> AccessorType:
        found = type_of(variable, self.model.version)
        if found is None:
            found = text_type_of(variable, self.model.version)
        assert found is not None, "clocks are neither driven nor watched"  # noqa: S101  # an invariant
        return found

    # ---- steps and events ----

    def step(self, time: float, step: float, *, may_roll_back: bool = False) -> None:
        """From *time* over *step* (seconds), whatever it takes."""
        if self._part.exchange:
            self._system.may_roll_back = may_roll_back
            arguments = byref(self._system), c_double(time), c_double(step)
            self._check(self._kernel.dse_exchange_step(*arguments), time)
        elif self.model.version == 3:
            self._step_fmi3(time, step, may_roll_back=may_roll_back)
        else:
            self._step_fmi2(time, step, may_roll_back=may_roll_back)

    def _step_fmi2(self, begin: float, step: float, *, may_roll_back: bool) -> None:
        end, time = begin + step, begin
        name = function_name(Call.DO_STEP, self.model.version)
        # The last argument of FMI 1 says that the step is new, that of FMI 2 that none is taken back.
        last = c_byte(1) if self.model.version == 1 else c_int(not may_roll_back)
        length = step
        while True:
            self._part.finished = -1
            status = self._ask(name, c_double(time), c_double(length), last)
            if status == PENDING:
                status = self._wait()
            if status != DISCARD:
                self._judge(name, begin, status)
                return
            if self._wants_to_end():
                raise self._bad_call(StopReason.STEP_CUT_SHORT, name, begin, 1)
            reached = c_double(time)
            told = self._status(Call.GET_REAL_STATUS, _LAST_SUCCESSFUL_TIME, reached)
            if not (_is_good(told) and time < reached.value <= end + _NEARLY * (end - time)):
                self._judge(name, begin, status)
            time = reached.value
            if time >= end:
                return
            length = end - time

    def _wait(self) -> int:
        """The status of a step that is made asynchronously, when it is over."""
        while self._part.finished < 0:
            found = c_int(PENDING)
            answer = self._status(Call.GET_STATUS, _STEP_STATUS, found)
            if answer is not None and not _is_good(answer) and answer != PENDING:
                return answer
            if found.value != PENDING:
                return found.value
            clock.sleep(_NAP)
        return int(self._part.finished)

    def _wants_to_end(self) -> bool:
        ends = c_int(0)
        return (
            self.model.version == 2
            and _is_good(self._status(Call.GET_BOOLEAN_STATUS, _TERMINATED, ends))
            and bool(ends.value)
        )

    def _status(self, call: Call, what: int, room: Any) -> int | None:
        """What GetStatus and its like return for *what*, the answer in *room*; None without them."""
        name = function_name(call, self.model.version)
        known = find(self.model, self.library, name) is not None
        return self._ask(name, c_int(what), byref(room)) if known else None

    def _step_fmi3(self, begin: float, step: float, *, may_roll_back: bool) -> None:
        end, time = begin + step, begin
        name = function_name(Call.DO_STEP, self.model.version)
        splits = Ability.HAS_EVENTS in self._able and Ability.CAN_VARY_STEP in self._able
        standstill = 0
        while True:
            stops = splits and time < self._part.next_event < end
            target = self._part.next_event if stops else end
            length = step if time == begin and not stops else target - time
            event, ended, early, reached = c_bool(), c_bool(), c_bool(), c_double(target)
            results = (byref(result) for result in (event, ended, early, reached))
            self._call(Call.DO_STEP, begin, c_double(time), c_double(length), c_bool(not may_roll_back), *results)
            if ended.value or (early.value and Ability.CAN_RETURN_EARLY not in self._able):
                raise self._bad_call(StopReason.STEP_CUT_SHORT, name, begin, ended.value)
            is_event = event.value and Ability.HAS_EVENTS in self._able
            arrived = reached.value if early.value and reached.value < target else target
            if not arrived > time:
                standstill += 1
                if not is_event:
                    raise self._bad_call(StopReason.STEP_CUT_SHORT, name, begin)
                if standstill > MOST_EVENT_ITERATIONS:
                    raise self._bad_call(StopReason.ENDLESS_EVENTS, name, begin)
            time = arrived
            if is_event:
                self._call(Call.ENTER_EVENT_MODE, begin)
                self._leave_event_mode(begin)
            if time >= end:
                return

    def _leave_event_mode(self, time: float | None) -> None:
        """Iterate until nothing changes any more, then go on in step mode."""
        name = function_name(Call.UPDATE_DISCRETE_STATES, self.model.version)
        for _ in range(MOST_EVENT_ITERATIONS):
            again, ended, nominals, states, known = (c_bool() for _ in range(5))
            event = c_double()
            results = (byref(result) for result in (again, ended, nominals, states, known, event))
            self._call(Call.UPDATE_DISCRETE_STATES, time, *results)
            if ended.value:
                raise self._bad_call(StopReason.STEP_CUT_SHORT, name, time, 1)
            self._part.next_event = event.value if known.value else math.inf
            if not again.value:
                self._call(Call.ENTER_STEP_MODE, time)
                return
        raise self._bad_call(StopReason.ENDLESS_EVENTS, name, time)

    # ---- states ----

    def save(self) -> None:
        """Keep the state it is in, instead of any it kept before."""
        self._call(Call.GET_STATE, None, byref(self._state))
        self._saved = self._part.next_event, dict(self._given)
        if self._part.exchange:
            self._kernel.dse_exchange_save(byref(self._system))

    def restore(self) -> None:
        """Back to the state it kept."""
        self._call(Call.SET_STATE, None, self._state)
        self._part.next_event, self._given = self._saved
        if self._part.exchange:
            self._kernel.dse_exchange_restore(byref(self._system))

    def through_bytes(self, before_reading: Callable[[], None]) -> None:
        """Turn the state that was kept into bytes and, after calling *before_reading*, back."""
        kind, read = ("FMUstate", "DeSerialize") if self.model.version == 2 else ("FMUState", "Deserialize")  # FMI 2
        prefix, size = f"fmi{self.model.version}", c_size_t()
        self._call(f"{prefix}Serialized{kind}Size", None, self._state, byref(size))
        room = (c_byte * size.value)()
        self._call(f"{prefix}Serialize{kind}", None, self._state, byref(room), size)
        before_reading()
        self._call(Call.FREE_STATE, None, byref(self._state))
        self._state.value = None
        self._call(f"{prefix}{read}{kind}", None, byref(room), size, byref(self._state))

    # ---- calls ----

    def _ask(self, name: str, *arguments: Any) -> int:
        """What the FMI function *name* returns for the instance and *arguments*."""
        function = ctypes.CFUNCTYPE(c_int32)(address(self.model, self.library, name))
        return int(function(c_void_p(self._part.instance), *arguments))

    def _call(self, call: int | str, time: float | None, *arguments: Any) -> None:
        name = call if isinstance(call, str) else function_name(call, self.model.version)
        self._judge(name, time, self._ask(name, *arguments))

    def _judge(self, name: str, time: float | None, status: int) -> None:
        if not _is_good(status):
            raise self._bad_call(StopReason.BAD_STATUS, name, time, status)

    def _check(self, failed: int, time: float | None) -> None:
        """Raise what made a function of the kernel fail."""
        if failed:
            raise self._let_go(failed_call(self._system.failure, self._element, time, self._elements.log(0)))

    def _bad_call(self, reason: StopReason, name: str, time: float | None, status: int = 0) -> RunFailed:
        what = of_call(reason, place(self._element.name, name, time), status)
        fatal = reason is StopReason.BAD_STATUS and status == FATAL
        return self._let_go(RunFailed(self._element.name, what, name, time, self._elements.log(0), fatal))

    def _bad_value(
        self, reason: StopReason, verb: Call, variable: Variable, label: str, time: float | None, value: float = 0.0
    ) -> RunFailed:
        what = of_value(reason, f"{self._element.name}.{label}", time, value, variable.fmi_type)
        name = function_name(verb + self._type(variable), self.model.version)
        return RunFailed(self._element.name, what, name, time, self._elements.log(0))

    def _let_go(self, failure: RunFailed) -> RunFailed:
        """After a fatal error FMI forbids every call."""
        if failure.fatal:
            self._part.instance = None
        return failure


def fits(value: float, kind: AccessorType) -> bool:
    """Whether an accessor of that type can be given *value*, so that the master could read it back."""
    if kind.is_floating:
        return math.isfinite(kind.c_type(value).value) or not math.isfinite(value)
    if not float(value).is_integer():
        return False
    if kind.is_boolean:
        return value in (0.0, 1.0)
    bits = 8 * kind.size
    low, high = (0, 2**bits - 1) if kind.name.startswith("U") else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)
    return bool(max(low, -EXACT_INTEGER) <= value <= min(high, EXACT_INTEGER))


def _is_good(status: int | None) -> bool:
    return status is not None and 0 <= status <= WARNING
