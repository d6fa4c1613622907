"""The compiled kernel and the structures it works on, field by field as in kernel.h."""

from __future__ import annotations

import ctypes
import sys
from functools import lru_cache
from pathlib import Path
from typing import Any, ClassVar

from dse.cosim.binding.calls import FUNCTIONS, Call
from dse.cosim.binding.exchange_layout import Exchange, Solver, Standing
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


class Conversion(ctypes.Structure):
    """What dse.domain.system.Conversion says; *pairs* is an array of inside, outside, inside, outside, …"""

    _fields_: ClassVar[_Fields] = [
        ("factor", ctypes.c_double),
        ("offset", ctypes.c_double),
        ("pairs", ctypes.c_void_p),
        ("n_pairs", ctypes.c_int64),
    ]


class Group(ctypes.Structure):
    """Variables that one accessor call reads or writes."""

    _fields_: ClassVar[_Fields] = [
        ("access", ctypes.c_void_p),
        ("instance", ctypes.c_void_p),
        ("references", ctypes.c_void_p),
        ("room", ctypes.c_void_p),
        ("count", ctypes.c_int64),
        ("n_values", ctypes.c_int64),
        ("element", ctypes.c_int64),
        ("call", ctypes.c_int64),
        ("values", ctypes.c_void_p),
        *((name, ctypes.c_void_p) for name in ("conversions", "transforms", "slopes", "scratch", "orders")),
        ("version", ctypes.c_int64),
        ("type", ctypes.c_int64),
        ("id", ctypes.c_int64),
        ("given", ctypes.c_void_p),
    ]


class Text(ctypes.Structure):
    """A string or binary that the kernel keeps."""

    _fields_: ClassVar[_Fields] = [
        ("bytes", ctypes.c_void_p),
        ("size", ctypes.c_size_t),
        ("room", ctypes.c_size_t),
        ("print", ctypes.c_uint64),
    ]


class TextGroup(ctypes.Structure):
    """Strings or binaries that one accessor call reads or writes."""

    _fields_: ClassVar[_Fields] = [
        ("access", ctypes.c_void_p),
        ("instance", ctypes.c_void_p),
        ("references", ctypes.c_void_p),
        ("pointers", ctypes.c_void_p),
        ("sizes", ctypes.c_void_p),
        ("texts", ctypes.c_void_p),
        ("count", ctypes.c_int64),
        ("n_values", ctypes.c_int64),
        ("version", ctypes.c_int64),
        ("type", ctypes.c_int64),
        ("element", ctypes.c_int64),
        ("call", ctypes.c_int64),
        ("id", ctypes.c_int64),
        ("given", ctypes.c_void_p),
    ]


class Groups(ctypes.Structure):
    """Groups in the order they are accessed."""

    _fields_: ClassVar[_Fields] = [
        (name, ctypes.c_void_p)
        for name in ("fmi2", "fmi3", "end", "converted", "truths", "no_truths", "texts", "no_texts")
    ]


class Truth(ctypes.Structure):
    """One Boolean output of FMI 2."""

    _fields_: ClassVar[_Fields] = [("room", ctypes.c_void_p), ("value", ctypes.c_void_p)]


class Element(ctypes.Structure):
    """One FMU instance: its functions and its groups of variables."""

    _fields_: ClassVar[_Fields] = [
        ("version", ctypes.c_int64),
        ("do_step", ctypes.c_void_p),
        ("instance", ctypes.c_void_p),
        ("stepping_element", ctypes.c_int64),
        ("stepping_call", ctypes.c_int64),
        ("abilities", ctypes.c_int64),
        ("name", ctypes.c_char_p),
        ("token", ctypes.c_char_p),
        ("resources", ctypes.c_char_p),
        *((call.name.lower(), ctypes.c_void_p) for call in FUNCTIONS if call is not Call.DO_STEP),
        ("log", ctypes.c_void_p),
        ("callbacks", ctypes.c_void_p * 5),
        *((name, Groups) for name in ("configuration", "starts", "inputs", "outputs")),
        ("first_value", ctypes.c_int64),
        ("n_values", ctypes.c_int64),
        ("first_staged", ctypes.c_int64),
        ("n_staged", ctypes.c_int64),
        ("intermediate", ctypes.c_void_p),
        ("n_intermediate", ctypes.c_int64),
        ("takes_slopes", ctypes.c_int64),
        ("moving", ctypes.c_void_p),
        ("moving_from", ctypes.c_double),
        ("exchange", ctypes.c_void_p),
        ("saved", ctypes.c_void_p),
        ("stop", ctypes.c_double),
        ("next_event", ctypes.c_double),
        ("saved_next_event", ctypes.c_double),
        *((name, ctypes.c_int64) for name in ("mode", "life", "finished", "finished_at", "asked", "broken")),
        ("system", ctypes.c_void_p),
    ]


class Failure(ctypes.Structure):
    """Why and where the kernel stopped."""

    _fields_: ClassVar[_Fields] = [
        ("kind", ctypes.c_int64),
        ("status", ctypes.c_int64),
        ("progress", Progress),
        ("group", ctypes.c_int64),
        ("position", ctypes.c_int64),
        ("value", ctypes.c_double),
        ("time", ctypes.c_double),
    ]


class System(ctypes.Structure):
    """All elements and the table of their outputs."""

    _fields_: ClassVar[_Fields] = [
        ("elements", ctypes.c_void_p),
        ("outputs", Groups),
        ("inputs", Groups),
        ("values", ctypes.c_void_p),
        ("starts", ctypes.c_void_p),
        ("staged", ctypes.c_void_p),
        ("slopes", ctypes.c_void_p),
        ("sources", ctypes.c_void_p),
        ("texts", ctypes.c_void_p),
        ("tables", ctypes.c_void_p),
        *((name, ctypes.c_int64) for name in ("n_tables", "n_texts", "texts_changed")),
        ("n_elements", ctypes.c_int64),
        ("n_values", ctypes.c_int64),
        ("n_staged", ctypes.c_int64),
        ("is_plain", ctypes.c_int64),
        ("may_roll_back", ctypes.c_int64),
        ("progress", ctypes.c_void_p),
        ("unwatched", Progress),
        ("now", ctypes.c_double),
        ("failure", Failure),
        ("plan", ctypes.c_void_p),
        ("fused", ctypes.c_void_p),
        ("fused_steps", ctypes.c_int64),
        ("watches", ctypes.c_int64),
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


_STRUCTURES: tuple[type[ctypes.Structure], ...] = (
    Progress, Log, Conversion, Group, Text, TextGroup, Truth, Element, Failure, System, Request,
)  # fmt: skip


@lru_cache(maxsize=1)
def kernel() -> ctypes.CDLL:
    """The compiled kernel; DseError if it is not there or was built from other sources."""
    suffix = {"win32": ".dll", "darwin": ".dylib"}.get(sys.platform, ".so")
    path = Path(__file__).parents[1] / f"_kernel{suffix}"
    try:
        library = ctypes.CDLL(str(path))
    except OSError as error:
        raise fail(
            f"the simulation kernel cannot be loaded: {error}", hint="install dse again, it is built on installation"
        ) from error
    sizes = [ctypes.sizeof(structure) for structure in _STRUCTURES]
    found = (ctypes.c_int64 * (len(sizes) + 1)).in_dll(library, "dse_layout")
    exchanges = [ctypes.sizeof(structure) for structure in (Standing, Solver, Exchange)]
    found_exchanges = (ctypes.c_int64 * len(exchanges)).in_dll(library, "dse_exchange_layout")
    if list(found) != [*sizes, LOG_LINES * LOG_WIDTH] or list(found_exchanges) != exchanges:
        raise fail("the simulation kernel does not fit this version of dse", hint="install dse again")
    for name in ("dse_instantiate", "dse_reset", "dse_run", "dse_free", "dse_forget_texts"):
        getattr(library, name).restype = ctypes.c_int
        getattr(library, name).argtypes = [ctypes.c_void_p]
    library.dse_run.argtypes = [ctypes.c_void_p, ctypes.c_void_p]
    library.dse_free.restype = library.dse_forget_texts.restype = None
    return library
