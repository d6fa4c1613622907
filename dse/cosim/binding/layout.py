"""The compiled kernel and the structures it works on, field by field as in kernel.h."""

from __future__ import annotations

import ctypes
import sys
from functools import lru_cache
from pathlib import Path
from typing import Any, ClassVar

from dse.cosim.binding.calls import FUNCTIONS, Call
from dse.cosim.binding.exchange_layout import numbers, pointers, reals
from dse.csolve import FOLDER, fingerprint
from dse.errors import fail

_COSIM = Path(__file__).parents[1]

LOG_LINES = 16
LOG_WIDTH = 512

_Fields = list[tuple[str, Any]]


class Place(ctypes.Structure):
    """An FMI call of an element."""

    _fields_: ClassVar[_Fields] = numbers("element", "call")


class Progress(ctypes.Structure):
    """Which FMI call the simulation is in."""

    _fields_: ClassVar[_Fields] = [("place", Place), *numbers("step", "run")]


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
        *reals("factor", "offset"),
        *pointers("pairs"),
        *numbers("n_pairs"),
    ]


class Group(ctypes.Structure):
    """Variables that one accessor call reads or writes."""

    _fields_: ClassVar[_Fields] = [
        *pointers("access", "instance", "references", "room"),
        *numbers("count", "n_values"),
        ("place", Place),
        *pointers("values", "conversions", "transforms", "slopes", "scratch", "orders"),
        *numbers("version", "type", "id"),
        *pointers("given"),
    ]


class Text(ctypes.Structure):
    """A string or binary that the kernel keeps."""

    _fields_: ClassVar[_Fields] = [
        *pointers("bytes"),
        ("size", ctypes.c_size_t),
        ("room", ctypes.c_size_t),
        ("print", ctypes.c_uint64),
        *pointers("before"),
        ("room_before", ctypes.c_size_t),
    ]


class TextGroup(ctypes.Structure):
    """Strings or binaries that one accessor call reads or writes."""

    _fields_: ClassVar[_Fields] = [
        *pointers("access", "instance", "references", "pointers", "sizes", "texts"),
        *numbers("count", "n_values", "version", "type"),
        ("place", Place),
        *numbers("id"),
        *pointers("given"),
    ]


class Groups(ctypes.Structure):
    """Groups in the order they are accessed."""

    _fields_: ClassVar[_Fields] = pointers(
        "fmi2", "fmi3", "end", "converted", "truths", "no_truths", "texts", "no_texts"
    )


class Truth(ctypes.Structure):
    """One Boolean output of FMI 2."""

    _fields_: ClassVar[_Fields] = pointers("room", "value")


class Element(ctypes.Structure):
    """One FMU instance: its functions and its groups of variables."""

    _fields_: ClassVar[_Fields] = [
        *numbers("version"),
        *pointers("do_step", "instance"),
        ("stepping", Place),
        *numbers("abilities"),
        ("name", ctypes.c_char_p),
        ("token", ctypes.c_char_p),
        ("resources", ctypes.c_char_p),
        *((call.name.lower(), ctypes.c_void_p) for call in FUNCTIONS if call is not Call.DO_STEP),
        *pointers("log"),
        ("callbacks", ctypes.c_void_p * 5),
        *((name, Groups) for name in ("configuration", "starts", "inputs", "outputs")),
        *numbers("first_value", "n_values", "first_staged", "n_staged"),
        *pointers("intermediate"),
        *numbers("n_intermediate", "takes_slopes"),
        *pointers("moving"),
        *reals("moving_from"),
        *pointers("exchange", "saved"),
        *reals("stop", "tolerance", "next_event", "saved_next_event"),
        *numbers("mode", "life", "finished", "finished_at", "asked", "broken"),
        *pointers("system"),
    ]


class Failure(ctypes.Structure):
    """Why and where the kernel stopped."""

    _fields_: ClassVar[_Fields] = [
        *numbers("kind", "status"),
        ("progress", Progress),
        *numbers("group", "position"),
        *reals("value", "time"),
    ]


class System(ctypes.Structure):
    """All elements and the table of their outputs."""

    _fields_: ClassVar[_Fields] = [
        *pointers("elements"),
        ("outputs", Groups),
        ("inputs", Groups),
        *pointers("values", "starts", "staged", "slopes", "sources", "texts", "tables"),
        *numbers(
            "n_tables", "n_texts", "texts_changed", "n_elements", "n_values", "n_staged", "is_plain", "may_roll_back"
        ),
        *pointers("progress"),
        ("unwatched", Progress),
        *reals("now"),
        ("failure", Failure),
        *pointers("plan", "fused"),
        *numbers("fused_steps", "watches", "rows", "has_ended", "takes_end"),
    ]


class Request(ctypes.Structure):
    """One run."""

    _fields_: ClassVar[_Fields] = [
        *reals("stop", "step"),
        *numbers("steps"),
        *pointers("record"),
        *numbers("n_record"),
        *pointers("out", "digests"),
    ]


@lru_cache(maxsize=1)
def kernel() -> ctypes.CDLL:
    """The compiled kernel; DseError if it is not there or was built from other sources."""
    suffix = {"win32": ".dll", "darwin": ".dylib"}.get(sys.platform, ".so")
    path = _COSIM / f"_kernel{suffix}"
    try:
        library = ctypes.CDLL(str(path))
    except OSError as error:
        raise fail(
            f"the simulation kernel cannot be loaded: {error}", hint="install dse again, it is built on installation"
        ) from error
    try:
        made_of = (ctypes.c_char * 32).in_dll(library, "dse_sources").value.decode("ascii", "replace")
    except ValueError:
        made_of = ""
    if made_of != fingerprint((_COSIM / "kernel", FOLDER)):
        raise fail("the simulation kernel was not built from this version of dse", hint="install dse again")
    for name in ("dse_instantiate", "dse_reset", "dse_run", "dse_free", "dse_forget_texts"):
        getattr(library, name).restype = ctypes.c_int
        getattr(library, name).argtypes = [ctypes.c_void_p]
    library.dse_run.argtypes = [ctypes.c_void_p, ctypes.c_void_p]
    library.dse_free.restype = library.dse_forget_texts.restype = None
    return library
