"""One FMU instance, called function by function through ctypes."""

from __future__ import annotations

import ctypes
import math
from collections.abc import Sequence
from ctypes import POINTER, byref, c_bool, c_byte, c_char_p, c_double, c_int, c_int32, c_size_t, c_uint32, c_void_p
from typing import Any

from dse.cosim.binding.abilities import Ability
from dse.cosim.binding.calls import (
    EXACT_INTEGER,
    LONGEST_TEXT,
    MOST_EVENT_ITERATIONS,
    AccessorType,
    Call,
    function_name,
    text_type_of,
    type_of,
)
from dse.cosim.binding.library import find
from dse.cosim.failure.fmu_messages import of_call, of_value, place
from dse.cosim.failure.run_failed import RunFailed, StopReason
from dse.domain.fmu import Variable
from oracle.handle import Handle


class Instance(Handle):
    """What can be done with an instance; every method raises RunFailed if the FMU reports an error."""

    def reset(self) -> None:
        """Back to what it was when it was new."""
        self._call(Call.RESET, None)

    # ---- initialization ----

    def set_up(self, stop: float) -> None:
        """fmi2SetupExperiment; the other versions have no such call."""
        self.next_event = math.inf
        if self.model.version == 2:  # FMI 2
            types = (c_int, c_double, c_double, c_int, c_double)
            told = self.model.experiment.tolerance
            self._call(Call.SETUP_EXPERIMENT, None, types, told is not None, told or 0.0, 0.0, 1, stop)

    def enter_configuration(self) -> None:
        """To set structural parameters."""
        self._call(Call.ENTER_CONFIGURATION, None)

    def exit_configuration(self) -> None:
        """After structural parameters have been set."""
        self._call(Call.EXIT_CONFIGURATION, None)

    def enter_initialization(self, stop: float) -> None:
        """EnterInitializationMode at time 0; fmiInitializeSlave in FMI 1."""
        if self.model.version == 1:
            self._call(Call.ENTER_INITIALIZATION, None, (c_double, c_byte, c_double), 0.0, 1, stop)
        elif self.model.version == 2:  # FMI 2
            self._call(Call.ENTER_INITIALIZATION, None)
        else:
            types = (c_bool, c_double, c_double, c_bool, c_double)
            told = self.model.experiment.tolerance
            self._call(Call.ENTER_INITIALIZATION, None, types, told is not None, told or 0.0, 0.0, True, stop)

    def exit_initialization(self) -> None:
        """ExitInitializationMode of co-simulation, and the events at time 0; FMI 1 has no such call."""
        if self.model.version == 1:
            return
        self._call(Call.EXIT_INITIALIZATION, None)
        if self.able & Ability.HAS_EVENTS:
            self.leave_event_mode(None)

    def terminate(self, time: float) -> None:
        """Terminate at the end of a run."""
        self._call(Call.TERMINATE, time)

    # ---- events ----

    def enter_event_mode(self, time: float | None) -> None:
        """From step mode."""
        self._call(Call.ENTER_EVENT_MODE, time)

    def leave_event_mode(self, time: float | None, ended_at: float | None = None) -> None:
        """Iterate until nothing changes any more, then go back to step mode; an end is told as of *ended_at*."""
        name = function_name(Call.UPDATE_DISCRETE_STATES, self.model.version)
        for _ in range(MOST_EVENT_ITERATIONS):
            again, ended, nominals, states, known = (c_bool() for _ in range(5))
            event = c_double()
            types = (*[POINTER(c_bool)] * 5, POINTER(c_double))
            flags = [byref(flag) for flag in (again, ended, nominals, states, known)]
            self._call(Call.UPDATE_DISCRETE_STATES, time, types, *flags, byref(event))
            if ended.value:
                time = time if ended_at is None else ended_at
                raise self.failure(name, time, of_call(StopReason.STEP_CUT_SHORT, place(self.name, name, time), True))
            self.next_event = event.value if known.value else math.inf
            if not again.value:
                self._call(Call.ENTER_STEP_MODE, time)
                return
        raise self.failure(name, time, of_call(StopReason.ENDLESS_EVENTS, place(self.name, name, time)))

    # ---- steps ----

    def step_status(self, time: float, step: float, *, may_roll_back: bool) -> int:
        """What DoStep of FMI 1 or 2 returns; an error is not raised."""
        name = function_name(Call.DO_STEP, self.model.version)
        self.finished = None  # what it called back with in steps that were over when they returned
        if self.model.version == 1:
            step_on = self._function(name, (c_void_p, c_double, c_double, c_byte), c_int32)
            return int(step_on(self._handle, time, step, 1))
        step_on = self._function(name, (c_void_p, c_double, c_double, c_int), c_int32)
        return int(step_on(self._handle, time, step, 0 if may_roll_back else 1))

    def fmi3_step(
        self, start: float, time: float, step: float, target: float, *, may_roll_back: bool
    ) -> tuple[float, bool]:
        """One fmi3DoStep from *time* over *step* to *target*: where it ended and whether there is an event there.

        *start* is the time for messages.
        """
        event, ended, early, reached = c_bool(), c_bool(), c_bool(), c_double(target)
        types = (c_double, c_double, c_bool, *[POINTER(c_bool)] * 3, POINTER(c_double))
        flags = (byref(event), byref(ended), byref(early), byref(reached))
        self._call(Call.DO_STEP, start, types, time, step, not may_roll_back, *flags)
        if ended.value:
            raise self.cut_short(min(reached.value, target), ended=True)
        is_early = early.value and not (event.value and reached.value >= target - 1e-9 * step)
        if is_early and not self.able & Ability.CAN_RETURN_EARLY:
            raise self.cut_short(start, ended=False)
        is_event = event.value and bool(self.able & Ability.HAS_EVENTS)
        return (reached.value if is_early and reached.value < target else target), is_event

    def cut_short(self, time: float, *, ended: bool) -> RunFailed:
        """The failure of a step that was not made to its end."""
        name = function_name(Call.DO_STEP, self.model.version)
        return self.failure(name, time, of_call(StopReason.STEP_CUT_SHORT, place(self.name, name, time), ended))

    def status(self, call: Call, what: int, room: Any) -> int | None:
        """What GetStatus and its like of FMI 1 and 2 return for *what*, the answer in *room*; None without them."""
        name = function_name(call, self.model.version)
        if find(self.model, self._library, name) is None:
            return None
        return int(self._function(name, (c_void_p, c_int, c_void_p), c_int32)(self._handle, what, byref(room)))

    def set_derivatives(self, variables: Sequence[Variable], values: Sequence[float], time: float) -> None:
        """Slopes of real inputs, per second, as they are inside (FMI 1 and 2)."""
        n = len(variables)
        references = (c_uint32 * n)(*(variable.reference for variable in variables))
        types = (POINTER(c_uint32), c_size_t, POINTER(c_int32), POINTER(c_double))
        orders = (c_int32 * n)(*[1] * n)
        self._call(Call.SET_INPUT_DERIVATIVES, time, types, references, n, orders, (c_double * n)(*values))

    # ---- states ----

    def save(self, state: c_void_p, time: float | None) -> None:
        """Keep the state it is in behind *state*, which holds None or a state kept before."""
        self._call(Call.GET_STATE, time, (c_void_p,), byref(state))

    def restore(self, state: c_void_p, time: float | None) -> None:
        """Back to a *state* that was kept."""
        self._call(Call.SET_STATE, time, (c_void_p,), state)

    def forget(self, state: c_void_p) -> None:
        """Free a *state* that was kept."""
        self._call(Call.FREE_STATE, None, (c_void_p,), byref(state))

    def serialized(self, state: c_void_p) -> bytes:
        """A kept *state* as bytes (FMI 2 and 3)."""
        size = c_size_t()
        names = [self._state_function(verb) for verb in ("Serialized{}Size", "Serialize{}")]
        self.call(names[0], None, (c_void_p, c_void_p), state, byref(size))
        room = (c_byte * size.value)()
        self.call(names[1], None, (c_void_p, c_void_p, c_size_t), state, byref(room), size.value)
        return bytes(room)

    def deserialize(self, content: bytes, state: c_void_p) -> None:
        """Make *state* the one that *content* holds."""
        room = (c_byte * len(content)).from_buffer_copy(content)
        name = self._state_function("DeSerialize{}" if self.model.version == 2 else "Deserialize{}")  # FMI 2
        self.call(name, None, (c_void_p, c_size_t, c_void_p), byref(room), len(content), byref(state))

    def _state_function(self, verb: str) -> str:
        version = self.model.version
        return f"fmi{version}{verb.format('FMUstate' if version == 2 else 'FMUState')}"  # FMI 2

    # ---- values ----

    def accessor(self, verb: str, variable: Variable) -> str:
        """Name of the function that gets or sets *variable*."""
        version = "" if self.model.version == 1 else str(self.model.version)
        return f"fmi{version}{verb}{variable.fmi_type}"

    def get(self, variable: Variable, time: float | None) -> float:
        """Value of a scalar *variable*; *time* is for messages."""
        return self.numbers(variable, time)[0]

    def set(self, variable: Variable, value: float, time: float | None) -> None:
        """Give a scalar *variable* the *value*; *time* is for messages."""
        self.give_numbers(variable, [value], time)

    def numbers(self, variable: Variable, time: float | None) -> list[float]:
        """Values of *variable* inside of the FMU, row by row; *time* is for messages."""
        kind = self._type(variable)
        room = (kind.c_type * variable.size)()
        self._access(Call.GET + kind, variable, room, time)
        for label, value in zip(variable.labels, room, strict=True):
            if kind in (AccessorType.INT64, AccessorType.UINT64) and abs(value) > EXACT_INTEGER:
                what = of_value(StopReason.TOO_LARGE, f"{self.name}.{label}", time)
                raise self.failure(self.accessor("Get", variable), time, what)
        return [float(bool(value)) if kind.is_boolean else float(value) for value in room]

    def give_numbers(self, variable: Variable, values: Sequence[float], time: float | None) -> None:
        """Give *variable* the *values*, as they are inside; *time* is for messages."""
        self._access(Call.SET + self._type(variable), variable, self.narrowed(variable, values, time), time)

    def narrowed(self, variable: Variable, values: Sequence[float], time: float | None) -> Any:
        """*values* as the accessor of *variable* takes them."""
        kind = self._type(variable)
        for label, value in zip(variable.labels, values, strict=True):
            if not _fits(value, kind):
                raise self.unfit(variable, label, value, time)
        return (kind.c_type * len(values))(*(value if kind.is_floating else int(value) for value in values))

    def unfit(self, variable: Variable, label: str, value: float, time: float | None) -> RunFailed:
        """The failure of a *value* that *variable* cannot take."""
        what = of_value(StopReason.UNFIT_INPUT, f"{self.name}.{label}", time, value, variable.fmi_type)
        return self.failure(self.accessor("Set", variable), time, what)

    def texts(self, variable: Variable, time: float | None) -> list[bytes]:
        """Strings (encoded in UTF-8) or binaries of *variable*."""
        kind, n = text_type_of(variable, self.model.version), variable.size
        pointers, sizes = (c_void_p * n)(), (c_size_t * n)()
        name = self.accessor("Get", variable)
        if kind is AccessorType.BINARY:
            types = (POINTER(c_uint32), c_size_t, c_void_p, c_void_p, c_size_t)
            self.call(name, time, types, (c_uint32 * 1)(variable.reference), 1, byref(sizes), byref(pointers), n)
        elif kind is AccessorType.OSMP:
            told = (c_int32 * 3)()
            name = "fmi2GetInteger"
            self.call(name, time, _OSMP, (c_uint32 * 3)(*variable.references), 3, told)
            lower, upper, size = (number % 2**32 for number in told)
            pointers[0], sizes[0] = upper << 32 | lower, size
        else:
            self._access(Call.GET + AccessorType.STRING, variable, pointers, time)
        found = []
        for label, pointer, size in zip(variable.labels, pointers, sizes, strict=True):
            if pointer is None and (kind is AccessorType.STRING or size):
                raise self.failure(name, time, of_value(StopReason.NO_TEXT, f"{self.name}.{label}", time))
            text = b"" if pointer is None else _bytes_at(pointer, None if kind is AccessorType.STRING else size)
            if text is None:
                raise self.failure(name, time, of_value(StopReason.LONG_TEXT, f"{self.name}.{label}", time))
            found.append(text)
        return found

    def give_texts(self, variable: Variable, texts: Sequence[bytes], time: float | None) -> None:
        """Give *variable* strings (encoded in UTF-8) or binaries."""
        n = len(texts)
        values = (c_char_p * n)(*texts)
        if text_type_of(variable, self.model.version) is AccessorType.BINARY:
            types = (POINTER(c_uint32), c_size_t, c_void_p, c_void_p, c_size_t)
            sizes = (c_size_t * n)(*map(len, texts))
            reference = (c_uint32 * 1)(variable.reference)
            self.call(self.accessor("Set", variable), time, types, reference, 1, byref(sizes), byref(values), n)
        elif variable.integers:
            # Whatever was given stays where it is, so that nobody can find it gone.
            (text,) = texts
            self._given = [*getattr(self, "_given", []), ctypes.create_string_buffer(text, len(text) + 1)]
            at = ctypes.addressof(self._given[-1]) if text else 0
            told = (c_int32 * 3)(*(ctypes.c_int32(part).value for part in (at, at >> 32, len(text))))
            self.call("fmi2SetInteger", time, _OSMP, (c_uint32 * 3)(*variable.references), 3, told)
        else:
            self._access(Call.SET + AccessorType.STRING, variable, values, time)

    def _access(self, call: int, variable: Variable, room: Any, time: float | None) -> None:
        references = (c_uint32 * 1)(variable.reference)
        types: tuple[Any, ...] = (POINTER(c_uint32), c_size_t, c_void_p)
        if self.model.version < 3:  # FMI 1 and 2 are not told how many values
            self._call(call, time, types, references, 1, byref(room))
        else:
            self._call(call, time, (*types, c_size_t), references, 1, byref(room), len(room))

    def _type(self, variable: Variable) -> AccessorType:
        kind = type_of(variable, self.model.version)
        assert kind is not None, "the wiring lets only numbers through"  # an invariant, not a check of input
        return kind


_OSMP = (POINTER(c_uint32), c_size_t, c_void_p)


def _bytes_at(pointer: int, size: int | None) -> bytes | None:
    """The *size* bytes there, or those up to a zero; None if they are too many."""
    if size is not None and size > LONGEST_TEXT:
        return None
    text = ctypes.string_at(pointer) if size is None else ctypes.string_at(pointer, size)
    return None if len(text) > LONGEST_TEXT else text


def _fits(value: float, kind: AccessorType) -> bool:
    if kind.is_floating:
        return math.isfinite(kind.c_type(value).value) or not math.isfinite(value)
    if not float(value).is_integer():
        return False
    if kind.is_boolean:
        return value in (0.0, 1.0)
    bits = 8 * kind.size
    low, high = (0, 2**bits - 1) if kind.name.startswith("U") else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)
    return bool(max(low, -EXACT_INTEGER) <= value <= min(high, EXACT_INTEGER))
