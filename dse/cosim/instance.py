"""One FMU instance, called function by function through ctypes."""

from __future__ import annotations

import ctypes
from ctypes import POINTER, byref, c_bool, c_char_p, c_double, c_int, c_int32, c_size_t, c_uint32, c_void_p
from typing import Any, ClassVar

from dse.cosim import diagnosis
from dse.cosim.calls import C_TYPES, EXACT_INTEGER, FATAL, FLOATING, WARNING, Call, Type, function_name, type_of
from dse.cosim.failure import RunFailed, place
from dse.cosim.library import address, resources
from dse.domain.fmu import FmuModel, Variable

_FMI2_CO_SIMULATION = 1
_FMI2_LOG = ctypes.CFUNCTYPE(None, c_void_p, c_char_p, c_int, c_char_p, c_char_p)  # the values after it: unread
_FMI3_LOG = ctypes.CFUNCTYPE(None, c_void_p, c_int, c_char_p, c_char_p)

_TRUTH = frozenset({Type.BOOLEAN, Type.FMI2_BOOLEAN})


class _Fmi2Callbacks(ctypes.Structure):
    _fields_: ClassVar[list[tuple[str, Any]]] = [
        (name, c_void_p) for name in ("log", "allocate", "release", "step_finished", "environment")
    ]


class Instance:
    """An instance called *name* of the FMU *model*, freed at the end of a ``with`` block.

    Every method raises RunFailed if the FMU reports an error.
    """

    def __init__(self, name: str, model: FmuModel, library: ctypes.CDLL) -> None:
        self.name = name
        self.model = model
        self.log: tuple[str, ...] = ()
        self.fatal = False
        self._library = library
        self._keep: Any = None
        self._handle = self._instantiate()

    def __enter__(self) -> Instance:
        return self

    def __exit__(self, *_: object) -> None:
        if not self.fatal:  # after a fatal error FMI forbids every call
            free = self._function(function_name(Call.FREE_INSTANCE, self.model.version), (c_void_p,), None)
            free(self._handle)

    def set_up(self, stop: float) -> None:
        """fmi2SetupExperiment; FMI 3 has no such call."""
        if self.model.version == 2:
            types = (c_int, c_double, c_double, c_int, c_double)
            self._call(Call.SETUP_EXPERIMENT, None, types, 0, 0.0, 0.0, 1, stop)

    def enter_initialization(self, stop: float) -> None:
        """EnterInitializationMode at time 0."""
        if self.model.version == 2:
            self._call(Call.ENTER_INITIALIZATION, None)
        else:
            types = (c_bool, c_double, c_double, c_bool, c_double)
            self._call(Call.ENTER_INITIALIZATION, None, types, False, 0.0, 0.0, True, stop)

    def exit_initialization(self) -> None:
        """ExitInitializationMode."""
        self._call(Call.EXIT_INITIALIZATION, None)

    def do_step(self, time: float, step: float) -> None:
        """DoStep from *time* over *step* (seconds)."""
        if self.model.version == 2:
            self._call(Call.DO_STEP, time, (c_double, c_double, c_int), time, step, 1)
            return
        event, ended, early, reached = c_bool(), c_bool(), c_bool(), c_double()
        types = (c_double, c_double, c_bool, *[POINTER(c_bool)] * 3, POINTER(c_double))
        flags = (byref(event), byref(ended), byref(early), byref(reached))
        self._call(Call.DO_STEP, time, types, time, step, True, *flags)
        if ended.value or early.value:
            where = place(self.name, "fmi3DoStep", time)
            raise self._failure("fmi3DoStep", time, diagnosis.cut_short(where, ended=ended.value))

    def terminate(self, time: float) -> None:
        """Terminate at the end of a run."""
        self._call(Call.TERMINATE, time)

    def accessor(self, verb: str, variable: Variable) -> str:
        """Name of the function that gets or sets *variable*."""
        return f"fmi{self.model.version}{verb}{variable.fmi_type}"

    def get(self, variable: Variable, time: float | None) -> float:
        """Value of *variable*; *time* is for messages."""
        kind = self._type(variable)
        room = C_TYPES[kind]()
        self._access(Call.GET, variable, room, time)
        if kind in (Type.INT64, Type.UINT64) and abs(room.value) > EXACT_INTEGER:
            what = diagnosis.too_large(f"{self.name}.{variable.name}", time)
            raise self._failure(self.accessor("Get", variable), time, what)
        return float(bool(room.value)) if kind in _TRUTH else float(room.value)

    def set(self, variable: Variable, value: float, time: float | None) -> None:
        """Give *variable* the *value*; *time* is for messages."""
        kind = self._type(variable)
        if kind not in FLOATING and not _fits(value, kind):
            what = diagnosis.unfit(f"{self.name}.{variable.name}", variable.fmi_type, value, time)
            raise self._failure(self.accessor("Set", variable), time, what)
        self._access(Call.SET, variable, C_TYPES[kind](value if kind in FLOATING else int(value)), time)

    def _instantiate(self) -> int:
        name, token, where = self.name.encode(), self.model.token.encode(), resources(self.model).encode()
        function = function_name(Call.INSTANTIATE, self.model.version)
        if self.model.version == 2:
            log = _FMI2_LOG(lambda _environment, _name, _status, _category, message: self._keep_line(message))
            allocate, release = (
                ctypes.cast(f, c_void_p) for f in (ctypes.pythonapi.PyMem_RawCalloc, ctypes.pythonapi.PyMem_RawFree)
            )
            callbacks = _Fmi2Callbacks(ctypes.cast(log, c_void_p), allocate, release, None, None)
            self._keep = (log, callbacks)
            types: tuple[Any, ...] = (c_char_p, c_int, c_char_p, c_char_p, POINTER(_Fmi2Callbacks), c_int, c_int)
            make = self._function(function, types, c_void_p)
            handle = make(name, _FMI2_CO_SIMULATION, token, where, byref(callbacks), 0, 0)
        else:
            log3 = _FMI3_LOG(lambda _environment, _status, _category, message: self._keep_line(message))
            self._keep = log3
            types = (*[c_char_p] * 3, *[c_bool] * 4, c_void_p, c_size_t, c_void_p, _FMI3_LOG, c_void_p)
            make = self._function(function, types, c_void_p)
            handle = make(name, token, where, False, False, False, False, None, 0, None, log3, None)
        if not handle:
            raise self._failure(function, None, diagnosis.no_instance(place(self.name, function, None)))
        return int(handle)

    def _access(self, verb: Call, variable: Variable, room: Any, time: float | None) -> None:
        call = verb + self._type(variable)
        references = (c_uint32 * 1)(variable.reference)
        types: tuple[Any, ...] = (POINTER(c_uint32), c_size_t, c_void_p)
        if self.model.version == 2:
            self._call(call, time, types, references, 1, byref(room))
        else:
            self._call(call, time, (*types, c_size_t), references, 1, byref(room), 1)

    def _call(self, call: int, time: float | None, types: tuple[Any, ...] = (), *arguments: Any) -> None:
        name = function_name(call, self.model.version)
        status = self._function(name, (c_void_p, *types), c_int32)(self._handle, *arguments)
        if not 0 <= status <= WARNING:
            self.fatal = status == FATAL
            raise self._failure(name, time, diagnosis.bad_status(place(self.name, name, time), status))

    def _function(self, name: str, types: tuple[Any, ...], result: Any) -> Any:
        return ctypes.CFUNCTYPE(result, *types)(address(self.model, self._library, name))

    def _type(self, variable: Variable) -> Type:
        kind = type_of(variable, self.model.version)
        assert kind is not None, "the wiring lets only numbers through"  # noqa: S101  # an invariant, not a check of input
        return kind

    def _keep_line(self, message: bytes | None) -> None:
        if text := (message or b"").decode("utf-8", "replace").strip():
            self.log = (*self.log, text)

    def _failure(self, call: str, time: float | None, what: str) -> RunFailed:
        return RunFailed(self.name, call, time, self.log, what, self.fatal)


def _fits(value: float, kind: Type) -> bool:
    if not float(value).is_integer():
        return False
    if kind in _TRUTH:
        return value in (0.0, 1.0)
    bits = 8 * ctypes.sizeof(C_TYPES[kind])
    low, high = (0, 2**bits - 1) if kind.name.startswith("U") else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)
    return bool(max(low, -EXACT_INTEGER) <= value <= min(high, EXACT_INTEGER))
