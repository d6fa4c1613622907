"""The compiled kernel and the structures it works on, field by field as in kernel.h."""

from __future__ import annotations

import ctypes
import sys
from functools import lru_cache
from pathlib import Path
from typing import Any, ClassVar

from dse.errors import fail

LOG_LINES = 16
LOG_WIDTH = 512

_Fields = list[tuple[str, Any]]


class Progress(ctypes.Structure):
    """Which FMI call the simulation is in."""

    _fields_: ClassVar[_Fields] = [(name, ctypes.c_int64) for name in ("element", "call", "step", "run")]


class Log(ctypes.Structure):
    """The last lines an FMU logged."""

    _fields_: ClassVar[_Fields] = [("count", ctypes.c_uint64), ("lines", ctypes.c_char * LOG_WIDTH * LOG_LINES)]

    def read(self) -> tuple[str, ...]:
        """The lines, oldest first, without empty ones."""
        numbers = range(max(0, self.count - LOG_LINES), self.count)
        lines = (bytes(self.lines[number % LOG_LINES].value) for number in numbers)
        return tuple(text for line in lines if (text := line.decode("utf-8", "replace").strip()))


class Group(ctypes.Structure):
    """Variables that one accessor call reads or writes."""

    _fields_: ClassVar[_Fields] = [
        ("access", ctypes.c_void_p),
        ("instance", ctypes.c_void_p),
        ("references", ctypes.c_void_p),
        ("room", ctypes.c_void_p),
        ("values", ctypes.c_void_p),
        ("count", ctypes.c_int64),
        ("version", ctypes.c_int64),
        ("type", ctypes.c_int64),
        ("element", ctypes.c_int64),
        ("call", ctypes.c_int64),
    ]


class Groups(ctypes.Structure):
    """Groups in the order they are accessed."""

    _fields_: ClassVar[_Fields] = [
        (name, ctypes.c_void_p) for name in ("fmi2", "fmi3", "end", "converted", "truths", "no_truths")
    ]


class Truth(ctypes.Structure):
    """One Boolean output of FMI 2."""

    _fields_: ClassVar[_Fields] = [("room", ctypes.c_void_p), ("value", ctypes.c_void_p)]


class Element(ctypes.Structure):
    """One FMU instance: its functions and its groups of variables."""

    _fields_: ClassVar[_Fields] = [
        ("version", ctypes.c_int64),
        ("name", ctypes.c_char_p),
        ("token", ctypes.c_char_p),
        ("resources", ctypes.c_char_p),
        ("instantiate", ctypes.c_void_p),
        ("free_instance", ctypes.c_void_p),
        ("reset", ctypes.c_void_p),
        ("setup_experiment", ctypes.c_void_p),
        ("enter_initialization", ctypes.c_void_p),
        ("exit_initialization", ctypes.c_void_p),
        ("do_step", ctypes.c_void_p),
        ("terminate", ctypes.c_void_p),
        ("instance", ctypes.c_void_p),
        ("stepping_element", ctypes.c_int64),
        ("stepping_call", ctypes.c_int64),
        ("log", ctypes.c_void_p),
        ("callbacks", ctypes.c_void_p * 5),
        ("starts", Groups),
        ("inputs", Groups),
        ("outputs", Groups),
        ("first_value", ctypes.c_int64),
        ("n_values", ctypes.c_int64),
        ("first_staged", ctypes.c_int64),
        ("n_staged", ctypes.c_int64),
    ]


class Failure(ctypes.Structure):
    """Why and where the kernel stopped."""

    _fields_: ClassVar[_Fields] = [
        ("kind", ctypes.c_int64),
        ("status", ctypes.c_int64),
        ("progress", Progress),
        ("position", ctypes.c_int64),
        ("value", ctypes.c_double),
    ]


class System(ctypes.Structure):
    """All elements and the table of their outputs."""

    _fields_: ClassVar[_Fields] = [
        ("elements", ctypes.c_void_p),
        ("outputs", Groups),
        ("inputs", Groups),
        ("values", ctypes.c_void_p),
        ("previous", ctypes.c_void_p),
        ("starts", ctypes.c_void_p),
        ("staged", ctypes.c_void_p),
        ("sources", ctypes.c_void_p),
        ("n_elements", ctypes.c_int64),
        ("n_values", ctypes.c_int64),
        ("n_staged", ctypes.c_int64),
        ("sweeps", ctypes.c_int64),
        ("progress", ctypes.c_void_p),
        ("unwatched", Progress),
        ("failure", Failure),
    ]


class Request(ctypes.Structure):
    """One run."""

    _fields_: ClassVar[_Fields] = [
        ("stop", ctypes.c_double),
        ("step", ctypes.c_double),
        ("steps", ctypes.c_int64),
        ("record", ctypes.c_void_p),
        ("n_record", ctypes.c_int64),
        ("out", ctypes.c_void_p),
        ("digests", ctypes.c_void_p),
    ]


@lru_cache(maxsize=1)
def kernel() -> ctypes.CDLL:
    """The compiled kernel; DseError if it is not there or was built from other sources."""
    suffix = {"win32": ".dll", "darwin": ".dylib"}.get(sys.platform, ".so")
    path = Path(__file__).with_name(f"_kernel{suffix}")
    try:
        library = ctypes.CDLL(str(path))
    except OSError as error:
        raise fail(
            f"the simulation kernel cannot be loaded: {error}", hint="install dse again, it is built on installation"
        ) from error
    sizes = [ctypes.sizeof(structure) for structure in (Progress, Log, Group, Truth, Element, Failure, System, Request)]
    found = (ctypes.c_int64 * 9).in_dll(library, "dse_layout")
    if list(found) != [*sizes, LOG_LINES * LOG_WIDTH]:
        raise fail("the simulation kernel does not fit this version of dse", hint="install dse again")
    for name in ("dse_instantiate", "dse_reset", "dse_run", "dse_free"):
        getattr(library, name).restype = ctypes.c_int
        getattr(library, name).argtypes = [ctypes.c_void_p]
    library.dse_run.argtypes = [ctypes.c_void_p, ctypes.c_void_p]
    library.dse_free.restype = None
    return library
