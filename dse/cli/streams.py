"""Standard input, output and error as commands need them, whatever whoever started us made of them."""

from __future__ import annotations

import io
import os
import sys
from typing import Any, TextIO


class Record:
    """What went to standard output, while it is wanted and not much; and whether there were notes, progress aside."""

    def __init__(self) -> None:
        self.content: bytearray | None = None
        self.has_notes = False

    def add(self, content: bytes) -> None:
        """Take *content*, or nothing any more."""
        if self.content is not None:
            self.content += content
            if len(self.content) > _MOST_RECORDED:
                self.content = None


record = Record()

_MOST_RECORDED = 2**20


class OutputError(Exception):
    """Standard output takes no more; *is_left* if because its reader went away, as ``head`` does."""

    def __init__(self, error: OSError) -> None:
        super().__init__(f"standard output cannot be written: {error.strerror or error}")
        self.is_left = isinstance(error, BrokenPipeError)


def mend_streams() -> None:
    """Closed streams lead nowhere, text is UTF-8, and what cannot be written is told: see `OutputError`."""
    for name in ("stdin", "stdout", "stderr"):
        if getattr(sys, name) is None:
            setattr(sys, name, _nowhere("r" if name == "stdin" else "w"))
    sys.stdout, sys.stderr = _checked(sys.stdout, _Output), _checked(sys.stderr, _Errors)


def silence() -> None:
    """Let nothing be written any more: what is still held back would fail again at the end of the process."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _nowhere(mode: str) -> TextIO:
    # The lowest number that is free is that of the stream: a file with this number would get what C prints.
    handle = os.open(os.devnull, os.O_RDWR)
    os.set_inheritable(handle, True)
    return io.TextIOWrapper(open(handle, mode + "b", closefd=False), encoding="utf-8")


class _Output(io.FileIO):
    def write(self, content: Any, /) -> int:
        record.add(content)
        try:
            return super().write(content)
        except OSError as error:
            raise OutputError(error) from None


class _Errors(io.FileIO):
    def write(self, content: Any, /) -> int:
        try:
            return super().write(content)
        except OSError:  # there is nobody left to tell
            return memoryview(content).nbytes


def _checked(stream: TextIO, kind: type[io.FileIO]) -> TextIO:
    if not isinstance(stream, io.TextIOWrapper):
        return stream
    # Windows and the C locale would refuse × and …; files and pipes are UTF-8 everywhere.
    code, otherwise = "utf-8", "backslashreplace"
    if type(getattr(stream.buffer, "raw", stream.buffer)) is not io.FileIO:  # a console of Windows
        stream.reconfigure(encoding=code, errors=otherwise)
        return stream
    buffer = io.BufferedWriter(kind(stream.fileno(), "w", closefd=False))
    return io.TextIOWrapper(buffer, code, otherwise, line_buffering=stream.line_buffering or stream.write_through)
