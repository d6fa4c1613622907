"""Memory that FMUs know the address of: it outlives what it is used for.

An FMU may call back with the address it was given long after its instance was freed, from threads of its own. Such a
call must find the memory there, so it is never given back to the system, only used again for the same.
"""

from __future__ import annotations

import ctypes
from threading import Lock
from typing import Any

from dse.cosim import layout

_lasting: list[Any] = []
_free: dict[int, list[tuple[Any, Any]]] = {}
_lock = Lock()


def borrow(count: int) -> tuple[Any, Any]:
    """Arrays of *count* elements and as many logs, all zero; give them back with :func:`give_back`."""
    with _lock:
        idle = _free.get(count)
        elements, logs = idle.pop() if idle else _new(count)
    for array in (elements, logs):
        ctypes.memset(array, 0, ctypes.sizeof(array))
    return elements, logs


def _new(count: int) -> tuple[Any, Any]:
    made = (layout.Element * count)(), (layout.Log * count)()
    _lasting.append(made)
    return made


def give_back(elements: Any, logs: Any) -> None:
    """What was borrowed may be used for other elements."""
    with _lock:
        _free.setdefault(len(elements), []).append((elements, logs))
