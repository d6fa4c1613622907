"""An FMU instance and its functions, called through ctypes."""

from __future__ import annotations

import ctypes
import math
from collections.abc import Callable, Sequence
from ctypes import POINTER, byref, c_bool, c_byte, c_char_p, c_double, c_int, c_int32, c_size_t, c_uint32, c_void_p
from types import TracebackType
from typing import Any, Self

from dse.cosim.binding.abilities import Ability, abilities_of
from dse.cosim.binding.calls import (
    FATAL,
    WARNING,
    Call,
    function_name,
)
from dse.cosim.binding.layout import kernel
from dse.cosim.binding.library import address
from dse.cosim.binding.resources import InstanceFolder
from dse.cosim.failure.fmu_messages import of_call, place
from dse.cosim.failure.run_failed import RunFailed, StopReason
from dse.domain.fmu import FmiInterface, FmuModel
from oracle.callbacks import (
    BETWEEN,
    FINISHED,
    Fmi1Callbacks,
    Fmi2Callbacks,
    at,
    logger,
    memory,
)

_FMI2_TYPES = {FmiInterface.MODEL_EXCHANGE: 0, FmiInterface.CO_SIMULATION: 1}
_MIME_TYPE = b"application/x-fmu-sharedlibrary"


class Handle:
    """An instance called *name* of the FMU *model* and how it is called, freed at the end of a ``with`` block.

    *between* is called with the time when an FMU of FMI 3 asks for inputs within a step; *intermediate* are the
    references of those it can be given. Every method raises RunFailed if the FMU reports an error.
    """

    def __init__(
        self,
        name: str,
        model: FmuModel,
        library: ctypes.CDLL,
        *,
        between: Callable[[float], None] | None = None,
        intermediate: Sequence[int] = (),
    ) -> None:
        self.name = name
        self.model = model
        self.log: tuple[str, ...] = ()
        self.fatal = False
        self.able = abilities_of(model, library)
        self.next_event = math.inf
        self.finished: int | None = None
        self._library = library
        self._between = between
        self._keep: Any = None
        self.folder = InstanceFolder(model)
        self._handle = self._instantiate(intermediate)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    @property
    def handle(self) -> int:
        """What FMI functions are called with."""
        return self._handle

    def close(self) -> None:
        """Free the instance, once; nothing happens after a fatal error, when FMI forbids every call."""
        if not self.fatal and self._handle:
            free = self._function(function_name(Call.FREE_INSTANCE, self.model.version), (c_void_p,), None)
            free(self._handle)
        self._handle = 0
        self.folder.remove()

    def call(self, name: str, time: float | None, types: tuple[Any, ...] = (), *arguments: Any) -> None:
        """Call the function *name* with the instance and *arguments*; a status worse than a warning is a failure."""
        self.judge(name, time, self._function(name, (c_void_p, *types), c_int32)(self._handle, *arguments))

    def judge(self, name: str, time: float | None, status: int) -> None:
        """Raise RunFailed if *status*, which the function *name* returned, is worse than a warning."""
        if not 0 <= status <= WARNING:
            self.fatal = status == FATAL
            raise self.failure(name, time, of_call(StopReason.BAD_STATUS, place(self.name, name, time), status))

    def failure(self, call: str, time: float | None, what: str) -> RunFailed:
        """The failure to raise."""
        return RunFailed(self.name, what, call, time, self.log, self.fatal)

    def _instantiate(self, intermediate: Sequence[int]) -> int:
        version = self.model.version
        function = function_name(Call.INSTANTIATE, version)
        if version == 1:
            handle = self._make_fmi1(function)
        elif version == 2:  # FMI 2
            handle = self._make_fmi2(function)
        elif self.model.interface is FmiInterface.MODEL_EXCHANGE:
            function = "fmi3InstantiateModelExchange"
            handle = self._make_fmi3_exchange(function)
        else:
            handle = self._make_fmi3(function, intermediate)
        if not handle:
            needs_tool = self.model.capabilities.needs_tool
            what = of_call(StopReason.NO_INSTANCE, place(self.name, function, None), needs_tool=needs_tool)
            raise self.failure(function, None, what)
        return int(handle)

    def _make_fmi1(self, function: str) -> Any:
        callbacks = Fmi1Callbacks(*self._callbacks())
        types = (c_char_p, c_char_p, c_char_p, c_char_p, c_double, c_byte, c_byte, Fmi1Callbacks, c_byte)
        name, token, where = self._words()
        make = self._function(function, types, c_void_p)
        return make(name, token, where, _MIME_TYPE, 0.0, 0, 0, callbacks, 0)

    def _make_fmi2(self, function: str) -> Any:
        line, *others = self._callbacks()
        callbacks = Fmi2Callbacks(at(kernel().dse_tell_line), *others, line)
        self._keep = (*self._keep, callbacks)
        types = (c_char_p, c_int, c_char_p, c_char_p, POINTER(Fmi2Callbacks), c_int, c_int)
        name, token, where = self._words()
        make = self._function(function, types, c_void_p)
        return make(name, _FMI2_TYPES[self.model.interface], token, where, byref(callbacks), 0, 0)

    def _make_fmi3(self, function: str, intermediate: Sequence[int]) -> Any:
        log = logger(self._keep_line, 3)
        asks = bool(self.able & Ability.ASKS_BETWEEN)
        between = BETWEEN(self._ask) if asks else None
        references = (c_uint32 * len(intermediate))(*intermediate)
        self._keep = (log, between, references)
        types = (*[c_char_p] * 3, *[c_bool] * 4, c_void_p, c_size_t, c_void_p, c_void_p, c_void_p)
        events, early = (bool(self.able & ability) for ability in (Ability.HAS_EVENTS, Ability.CAN_RETURN_EARLY))
        make = self._function(function, types, c_void_p)
        wanted = (byref(references), len(intermediate)) if asks and intermediate else (None, 0)
        return make(*self._words(), False, False, events, early, *wanted, None, at(log), at(between) if asks else None)

    def _make_fmi3_exchange(self, function: str) -> Any:
        log = logger(self._keep_line, 3)
        self._keep = log
        make = self._function(function, (*[c_char_p] * 3, c_bool, c_bool, c_void_p, c_void_p), c_void_p)
        return make(*self._words(), False, False, None, at(log))

    def _words(self) -> tuple[bytes, bytes, bytes]:
        return self.name.encode(), self.model.token.encode(), self.folder.location.encode()

    def _callbacks(self) -> tuple[int | None, ...]:
        log = logger(self._keep_line, self.model.version)
        finished = FINISHED(self._finish)
        self._keep = (log, finished)
        return at(log), *memory(), at(finished)

    def _finish(self, _environment: int | None, status: int) -> None:
        if self.model.version > 1:  # FMI 1 does not tell whose step it is: its FMUs are asked
            self.finished = status

    def _ask(self, _environment: int | None, time: float, wanted: bool, *rest: Any) -> None:
        rest[3][0] = False  # no early return
        if wanted and self._between is not None:
            self._between(time)

    def _call(self, call: int, time: float | None, types: tuple[Any, ...] = (), *arguments: Any) -> None:
        self.call(function_name(call, self.model.version), time, types, *arguments)

    def _function(self, name: str, types: tuple[Any, ...], result: Any) -> Any:
        return ctypes.CFUNCTYPE(result, *types)(address(self.model, self._library, name))

    def _keep_line(self, message: bytes | None) -> None:
        if text := (message or b"").decode("utf-8", "replace").strip():
            self.log = (*self.log, text)
