"""The line over which an FMU asks its partner, and what every partner does when it begins."""

from __future__ import annotations

import fcntl
import os
import signal
import struct
from collections.abc import Sequence

START, STEP, END = range(3)
"""Kinds of questions: the outputs at the start of a run, those after a step; the end of the run, without an answer."""
_HEAD = struct.Struct("=II")
_LONGEST = 400

Question = tuple[int, tuple[float, ...]]
"""Its kind; the length of the step (s), then parameters and inputs."""


class Line:
    """The socket over which questions come and answers go."""

    def __init__(self, file: int) -> None:
        self._file = file

    def question(self) -> Question | None:
        """The next; None if there are no more."""
        head = self._read(_HEAD.size)
        if head is None:
            return None
        kind, count = _HEAD.unpack(head)
        numbers = self._read(8 * count)
        return None if numbers is None else (kind, struct.unpack(f"={count}d", numbers))

    def answer(self, values: Sequence[float]) -> None:
        """The outputs."""
        self._write(_HEAD.pack(0, len(values)) + struct.pack(f"={len(values)}d", *values))

    def refuse(self, why: str) -> None:
        """The run fails, and this is why."""
        text = why.encode()[:_LONGEST]
        self._write(_HEAD.pack(1, len(text)) + text)

    def _read(self, size: int) -> bytes | None:
        parts = b""
        while len(parts) < size:
            part = os.read(self._file, size - len(parts))
            if not part:
                return None
            parts += part
        return parts

    def _write(self, content: bytes) -> None:
        while content:
            content = content[os.write(self._file, content) :]


def open_line() -> Line:
    """The line on standard input. This process ends, with all forks, when the other end of standard output is closed.

    What is printed goes to standard error from now on.
    """
    line, life = os.dup(0), os.dup(1)
    nothing = os.open(os.devnull, os.O_RDWR)
    os.dup2(nothing, 0)
    os.dup2(2, 1)
    # Who hangs reads nothing: the system ends the whole group when the process that started it is gone.
    fcntl.fcntl(life, fcntl.F_SETOWN, -os.getpgrp())
    fcntl.fcntl(life, fcntl.F_SETFL, os.O_ASYNC)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    return Line(line)


def how_ended(child: int, who: str) -> str:
    """Wait for the process *child*; "" if it ended of itself, else what became of *who*."""
    status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    if status < 0:
        return f"{who} has crashed ({signal.Signals(-status).name})"
    return f"{who} has ended with the exit code {status}" if status else ""
