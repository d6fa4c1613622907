"""What a process has only one of, and an FMU may change: it is put back after a run, or the process is given up."""

from __future__ import annotations

import locale
import os
import re
import signal
import sys
import time
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

_LOOK_EVERY, _LOOK_OFTEN = 0.05, 0.005
"""Seconds between two looks, and when half of the memory is used up."""

_NEAR = 0.8
_GROWN = 0.1
_LIMITS = ("AS", "CPU", "DATA", "FSIZE", "NOFILE", "NPROC", "STACK")
_STATUS = re.compile(rb"^(VmRSS|VmLck|SigBlk|SigIgn|SigCgt):\s*(\w+)", re.MULTILINE)

_OF_THREADS = 3 << 31
"""Signals that the C library takes for itself when the first thread is started."""


class _Look(NamedTuple):
    """*signals* blocked, ignored and caught, *locked* memory, where *printing* goes, bytes *resident*."""

    signals: tuple[int, ...] = ()
    locked: bool = False
    printing: tuple[tuple[int, int], ...] = ()
    resident: int = 0


class ProcessState:
    """The process as it is now: working folder, locale, permissions of new files, limits, signals; and no timer runs.

    *memory* is how many bytes the process may hold.
    """

    def __init__(self) -> None:
        self.memory = float("inf")
        self._folder = _folder()
        self._locale = locale.setlocale(locale.LC_ALL)
        self._umask = os.umask(0o077)
        os.umask(self._umask)
        self._limits = _limits()
        self._first = self._usual = _look()
        self._is_known = False
        self._looked, self._every = 0.0, _LOOK_EVERY

    def begin(self, memory: float) -> None:
        """Another configuration comes, which may hold so much: what its first run changes is what it needs."""
        self.memory, self._is_known = memory, False

    def restore(self) -> None:
        """Make folder, locale and permissions so again: later runs would find other files and read other numbers."""
        if _folder() != self._folder:
            with suppress(OSError):  # it was deleted
                os.chdir(self._folder)
        if locale.setlocale(locale.LC_ALL) != self._locale:
            locale.setlocale(locale.LC_ALL, self._locale)
        os.umask(self._umask)

    def harm(self, *, now: bool) -> str:
        """Why the process should make no more runs, "" if nothing is known; looked for only when it is time or *now*.

        Timers are stopped, and limits put back where that is allowed. What the first run of a configuration changes is
        no harm to the others of it, but to another configuration.
        """
        moment = time.perf_counter()
        if not (now or moment - self._looked > self._every or not self._is_known):
            return ""
        self._looked = moment
        _stop_timers()
        if limit := self._lowered_limit():
            return f"the limit {limit} was lowered for good"
        before, look = self._usual, _look()
        self._every = _LOOK_OFTEN if look.resident > self.memory / 2 else _LOOK_EVERY
        if not self._is_known:
            self._is_known, self._usual = True, look
            return ""
        if look.resident > max(_NEAR * self.memory, before.resident + _GROWN * self.memory):
            return "it has grown"
        return _difference(before, look)

    @property
    def is_marked(self) -> bool:
        """Whether runs have changed what other configurations would notice."""
        return bool(self._lowered_limit() or _difference(self._first, _look()))

    def _lowered_limit(self) -> str:
        """A limit that is lower than it was and cannot be put back."""
        if sys.platform == "win32":
            return ""
        import resource

        for name, was in self._limits.items():
            kind = getattr(resource, f"RLIMIT_{name}")
            soft, hard = resource.getrlimit(kind)
            if _height(soft) < _height(was):
                try:
                    resource.setrlimit(kind, (was, hard))
                except (ValueError, OSError):
                    return f"RLIMIT_{name}"
        return ""


def _difference(before: _Look, now: _Look) -> str:
    if now.signals != before.signals:
        return "signals are handled in another way"
    if now.locked != before.locked:
        return "memory was locked"
    return "standard output was closed" if now.printing != before.printing else ""


def _folder() -> str:
    try:
        return os.getcwd()  # noqa: PTH109  # asked after every run
    except OSError:
        return ""  # it was deleted


def _limits() -> dict[str, int]:
    if sys.platform == "win32":
        return {}
    import resource

    kinds = {name: getattr(resource, f"RLIMIT_{name}", None) for name in _LIMITS}
    return {name: resource.getrlimit(kind)[0] for name, kind in kinds.items() if kind is not None}


def _height(limit: int) -> float:
    return float("inf") if limit < 0 else limit


def _look() -> _Look:
    printing = tuple(_identity(handle) for handle in (1, 2))
    try:
        found = dict(_STATUS.findall(Path("/proc/self/status").read_bytes()))
    except OSError:  # only Linux has it
        return _Look(printing=printing)
    signals = tuple(int(found.get(key, b"0"), 16) & ~_OF_THREADS for key in (b"SigBlk", b"SigIgn", b"SigCgt"))
    return _Look(signals, found.get(b"VmLck", b"0") != b"0", printing, int(found.get(b"VmRSS", b"0")) * 1024)


def _identity(handle: int) -> tuple[int, int]:
    try:
        status = os.fstat(handle)
    except OSError:
        return -1, -1
    return status.st_dev, status.st_ino


def _stop_timers() -> None:
    if sys.platform != "win32":
        for timer in (signal.ITIMER_REAL, signal.ITIMER_VIRTUAL, signal.ITIMER_PROF):
            signal.setitimer(timer, 0)
