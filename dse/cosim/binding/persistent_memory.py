"""Memory that FMUs know the address of: it outlives what it is used for.

An FMU may call back with the address it was given long after its instance was freed, from threads of its own. Such a
call must find the memory there, and must not find it in use by another FMU: it is never given back to the system, and
used again only when it has lain idle for a while and nobody has written to it meanwhile.
"""

from __future__ import annotations

import ctypes
from collections import deque
from threading import Lock
from typing import Any

from dse.cosim.binding import layout

QUARANTINE = 32
"""Systems of one size that have to be closed later than another before its memory is used again."""

_lasting: list[Any] = []
_idle: dict[int, deque[tuple[Any, Any, list[int]]]] = {}
_lock = Lock()


def borrow(count: int) -> tuple[Any, Any]:
    """Arrays of *count* elements and as many logs, all zero; give them back with :func:`give_back`."""
    with _lock:
        waiting = _idle.setdefault(count, deque())
        while len(waiting) > QUARANTINE:
            elements, logs, lines = waiting.popleft()
            if lines == [log.count for log in logs]:
                break
        else:
            elements, logs = (layout.Element * count)(), (layout.Log * count)()
            _lasting.append((elements, logs))
    for array in (elements, logs):
        ctypes.memset(array, 0, ctypes.sizeof(array))
    return elements, logs


def give_back(elements: Any, logs: Any) -> None:
    """What was borrowed may be used for other elements."""
    with _lock:
        _idle.setdefault(len(elements), deque()).append((elements, logs, [log.count for log in logs]))
