"""What the plain-Python oracle gives an FMU to call back."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from ctypes import POINTER, c_bool, c_char_p, c_double, c_int, c_size_t, c_void_p
from typing import Any, ClassVar

FMI1_LOG = ctypes.CFUNCTYPE(None, c_void_p, c_char_p, c_int, c_char_p, c_char_p)  # the values after it: unread
LINE = ctypes.CFUNCTYPE(None, c_char_p)
FMI3_LOG = ctypes.CFUNCTYPE(None, c_void_p, c_int, c_char_p, c_char_p)
FINISHED = ctypes.CFUNCTYPE(None, c_void_p, c_int)
BETWEEN = ctypes.CFUNCTYPE(None, c_void_p, c_double, c_bool, c_bool, c_bool, c_bool, POINTER(c_bool), POINTER(c_double))
ALLOCATE = ctypes.CFUNCTYPE(c_void_p, c_size_t, c_size_t)
RELEASE = ctypes.CFUNCTYPE(None, c_void_p)


class Fmi1Callbacks(ctypes.Structure):
    """fmiCallbackFunctions of FMI 1.0, which is passed by value."""

    _fields_: ClassVar[list[tuple[str, Any]]] = [
        (name, c_void_p) for name in ("log", "allocate", "release", "step_finished")
    ]


class Fmi2Callbacks(ctypes.Structure):
    """fmi2CallbackFunctions."""

    _fields_: ClassVar[list[tuple[str, Any]]] = [
        (name, c_void_p) for name in ("log", "allocate", "release", "step_finished", "environment")
    ]


def memory() -> tuple[int | None, int | None]:
    """Functions like calloc and free that an FMU may call from any thread."""
    calloc, free = ctypes.pythonapi.PyMem_RawCalloc, ctypes.pythonapi.PyMem_RawFree
    return ctypes.cast(calloc, c_void_p).value, ctypes.cast(free, c_void_p).value


def at(function: Any) -> int | None:
    """Address of a function made with one of the types above."""
    return ctypes.cast(function, c_void_p).value


def logger(keep: Callable[[bytes | None], None], version: int) -> Any:
    """A logger that hands each message to *keep*, as FMI *version* wants it.

    For FMI 2 it is the function that the kernel's own logger is given as its environment: Python cannot read what
    stands behind the format.
    """
    if version == 3:  # FMI 3
        return FMI3_LOG(lambda _environment, _status, _category, message: keep(message))
    if version == 2:  # FMI 2
        return LINE(keep)
    return FMI1_LOG(lambda _environment, _name, _status, _category, message: keep(message))
