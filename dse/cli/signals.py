"""What a person or the system stops a command with: Ctrl-C, SIGTERM and SIGHUP do the same.

While a command is imported there is nothing to tidy up, and the process ends at once. While it runs a KeyboardInterrupt
is raised, once. Further signals change nothing for some time: what was finished is being stored, workers are ended.
"""

from __future__ import annotations

import atexit
import os
import signal
import sys
import time
from types import FrameType

SIGNALS = [getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)]

_PATIENCE = 10.0
"""Seconds to tidy up in; whoever stops the command after that has waited for too long."""

_AGAIN = 0.05

_asked: list[int] = []
_deadline = 0.0


def end_at_once() -> None:
    """From here on a signal ends the process."""
    atexit.register(_ignore)  # the first to be registered is the last to be called
    for number in SIGNALS:
        if signal.getsignal(number) is not signal.SIG_IGN:  # as nohup and the shell's background leave it
            signal.signal(number, _end)


def interrupt() -> None:
    """From here on the first signal raises a KeyboardInterrupt in the main thread."""
    sys.unraisablehook = _raise_again
    for number in SIGNALS:
        if signal.getsignal(number) is _end:
            signal.signal(number, _interrupt)


def tidy_up() -> None:
    """From here on a signal changes nothing, unless tidying up takes for ever."""
    global _deadline  # noqa: PLW0603  # a process has one
    _deadline = _deadline or time.monotonic() + _PATIENCE


def stop_code() -> int:
    """The exit code for the signal that came, as shells have it; 0 if none did."""
    return 128 + _asked[0] if _asked else 0


def _ignore() -> None:
    """Python gives up its handlers before the process has ended; the exit code stays what it is."""
    for number in SIGNALS:
        signal.signal(number, signal.SIG_IGN)


def _end(number: int, _frame: FrameType | None) -> None:
    os.write(2, b"stopped\n")
    os._exit(128 + number)


def _interrupt(number: int, frame: FrameType | None) -> None:
    if not _deadline:
        _asked.append(number)
        tidy_up()
        raise KeyboardInterrupt
    if time.monotonic() > _deadline:
        _end(number, frame)


def _raise_again(lost: sys.UnraisableHookArgs) -> None:
    """An interrupt that came where nothing can be raised, as in a callback of C, comes again a moment later."""
    if not issubclass(lost.exc_type, KeyboardInterrupt):
        sys.__unraisablehook__(lost)
        return
    from threading import Timer

    global _deadline  # noqa: PLW0603
    _deadline = 0.0
    Timer(_AGAIN, os.kill, [os.getpid(), _asked.pop() if _asked else signal.SIGINT]).start()
