"""One instance of an FMU by itself, called function by function: experiments do with it what no simulation does.

The kernel makes it, resets and frees it, and integrates it if it is for model exchange.
"""

from __future__ import annotations

import ctypes
import math
import struct
from collections.abc import Iterable, Mapping
from ctypes import byref, c_int32, c_size_t, c_uint32, c_void_p
from typing import Any

from dse.cosim.binding import layout
from dse.cosim.binding.abilities import Ability
from dse.cosim.binding.calls import (
    EXACT_INTEGER,
    FATAL,
    LONGEST_TEXT,
    AccessorType,
    Call,
    function_name,
    is_good,
    text_type_of,
    type_of,
)
from dse.cosim.binding.library import address
from dse.cosim.failure.diagnosis import failed_call
from dse.cosim.failure.fmu_messages import of_call, of_value, place
from dse.cosim.failure.run_failed import RunFailed, StopReason
from dse.cosim.probing.excitation import driven, start_of, watched
from dse.cosim.tables.elements import KernelElements
from dse.cosim.wiring.wiring import groups_by_type
from dse.domain.fmu import FmuModel, Variable
from dse.domain.system import Element


class FmuInstance:
    """An instance of *model* called *name*, its inputs those that take numbers; *part* is what the kernel knows of it.

    Every method raises RunFailed if the FMU reports an error, with the *time* it is told, None before t = 0.
    """

    def __init__(self, name: str, model: FmuModel) -> None:
        self.model = model
        self.element = Element(name, model, driven(model), watched(model), {})
        elements = KernelElements([self.element])
        elements.set_between(0, (group for group in groups_by_type(self.element, driven(model)) if group.moves))
        self._elements, self.part = elements, elements.structures[0]
        self.able = Ability(self.part.abilities)
        self.library = elements.library(0)
        self.kernel = layout.kernel()
        self.system = layout.System(elements=ctypes.addressof(elements.structures), n_elements=1)
        self.ask_kernel("instantiate", None)

    def close(self) -> None:
        """Free the state that is kept and the instance; nothing happens after a fatal error."""
        self.kernel.dse_free(byref(self.system))
        self._elements.release()

    # ---- values ----

    def numbers(self, variable: Variable, time: float | None) -> list[float]:
        """The values of *variable*, row by row."""
        kind = self._type(variable)
        room = (kind.c_type * variable.size)()
        self._access(Call.GET, variable, room, time)
        for label, value in zip(variable.labels, room, strict=True):
            if kind in (AccessorType.INT64, AccessorType.UINT64) and abs(value) > EXACT_INTEGER:
                raise self._bad_value(StopReason.TOO_LARGE, Call.GET, variable, label, time)
        return [float(bool(value)) if kind.is_boolean else float(value) for value in room]

    def texts(self, variable: Variable, time: float | None) -> list[bytes]:
        """The strings (encoded in UTF-8) or binaries of *variable*."""
        pointers, sizes = (c_void_p * variable.size)(), (c_size_t * variable.size)()
        is_binary = self._type(variable).is_binary
        if variable.integers:
            told = (c_int32 * len(variable.integers))()
            self._access(Call.GET, variable, told, time)
            lower, upper, size = (number % 2**32 for number in told)
            pointers[0], sizes[0] = upper << 32 | lower, size
        else:
            self._access(Call.GET, variable, pointers, time, sizes if is_binary else None)
        found = []
        for label, pointer, size in zip(variable.labels, pointers, sizes, strict=True):
            if pointer is None and (size or not is_binary):
                raise self._bad_value(StopReason.NO_TEXT, Call.GET, variable, label, time)
            is_long = is_binary and size > LONGEST_TEXT
            text = b"" if pointer is None or is_long else ctypes.string_at(pointer, size if is_binary else -1)
            if is_long or len(text) > LONGEST_TEXT:
                raise self._bad_value(StopReason.LONG_TEXT, Call.GET, variable, label, time)
            found.append(text)
        return found

    def bits(self, variable: Variable, time: float | None) -> list[bytes]:
        """What tells the values of *variable* from others, be they numbers or texts."""
        if text_type_of(variable, self.model.version) is not None:
            return self.texts(variable, time)
        return [struct.pack("<d", value) for value in self.numbers(variable, time)]

    def set_numbers(self, variables: Iterable[Variable], values: Mapping[str, float], time: float | None) -> None:
        """Give those of *variables* that have any of the *values*, by label, all of theirs."""
        for variable in variables:
            if any(label in values for label in variable.labels):
                self._access(Call.SET, variable, self.passed(variable, values, time), time)

    def passed(self, variable: Variable, values: Mapping[str, float], time: float | None) -> Any:
        """*values* as the accessor takes them; what is not among them is what the FMU starts with."""
        kind = self._type(variable)
        found = [values.get(label, start_of(variable, index)) for index, label in enumerate(variable.labels)]
        for label, value in zip(variable.labels, found, strict=True):
            if not fits(value, kind):
                raise self._bad_value(StopReason.UNFIT_INPUT, Call.SET, variable, label, time, value)
        return (kind.c_type * len(found))(*(value if kind.is_floating else int(value) for value in found))

    def _access(self, verb: Call, variable: Variable, room: Any, time: float | None, sizes: Any = None) -> None:
        # FMI 1 and 2 are not told how many values.
        counted = (c_size_t(len(room)),) if self.model.version == 3 else ()
        before = () if sizes is None else (byref(sizes),)
        references = (c_uint32 * len(variable.references))(*variable.references)
        arguments = (byref(references), c_size_t(len(references)), *before, byref(room), *counted)
        self.call(verb + self._type(variable), time, *arguments)

    def _type(self, variable: Variable) -> AccessorType:
        found = type_of(variable, self.model.version)
        if found is None:
            found = text_type_of(variable, self.model.version)
        assert found is not None, "clocks are neither driven nor watched"  # noqa: S101  # an invariant
        return found

    # ---- calls ----

    def ask(self, name: str, *arguments: Any) -> int:
        """What the FMI function *name* returns for the instance and *arguments*, which are ctypes' all."""
        function = ctypes.CFUNCTYPE(c_int32)(address(self.model, self.library, name))
        return int(function(c_void_p(self.part.instance), *arguments))

    def call(self, call: int | str, time: float | None, *arguments: Any) -> None:
        """Call an FMI function with the instance and *arguments*; a status worse than a warning is a failure."""
        name = call if isinstance(call, str) else function_name(call, self.model.version)
        self.judge(name, time, self.ask(name, *arguments))

    def judge(self, name: str, time: float | None, status: int) -> None:
        """Raise RunFailed if *status*, which the function *name* returned, is worse than a warning."""
        if not is_good(status):
            raise self.failure(StopReason.BAD_STATUS, name, time, status)

    def ask_kernel(self, verb: str, time: float | None, *arguments: Any) -> None:
        """Have the kernel do with the instance what can fail."""
        if getattr(self.kernel, f"dse_{verb}")(byref(self.system), *arguments):
            raise self._let_go(failed_call(self.system.failure, self.element, time, self._elements.log(0)))

    def failure(self, reason: StopReason, name: str, time: float | None, status: int = 0) -> RunFailed:
        """The failure of the function *name*, which returned *status*, to be raised."""
        what = of_call(reason, place(self.element.name, name, time), status)
        fatal = reason is StopReason.BAD_STATUS and status == FATAL
        return self._let_go(RunFailed(self.element.name, what, name, time, self._elements.log(0), fatal))

    def _bad_value(
        self, reason: StopReason, verb: Call, variable: Variable, label: str, time: float | None, value: float = 0.0
    ) -> RunFailed:
        what = of_value(reason, f"{self.element.name}.{label}", time, value, variable.fmi_type)
        name = function_name(verb + self._type(variable), self.model.version)
        return RunFailed(self.element.name, what, name, time, self._elements.log(0))

    def _let_go(self, failure: RunFailed) -> RunFailed:
        """After a fatal error FMI forbids every call."""
        if failure.fatal:
            self.part.instance = None
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
