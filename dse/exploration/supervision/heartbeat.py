"""A small file that a worker and its supervisor have both mapped: it tells what the worker does even after it died."""

from __future__ import annotations

import mmap
import os
import struct
from dataclasses import dataclass
from enum import IntEnum
from pathlib import Path

from dse.exploration.work import PROGRESS_BYTES

_STATE = struct.Struct("=6q")
_SIZE = PROGRESS_BYTES + _STATE.size


class Phase(IntEnum):
    """What a worker is doing."""

    STARTING = 0
    WAITING = 1
    LOADING = 2
    RUNNING = 3
    WRITING = 4
    LEAVING = 5
    """The configuration before is freed."""


_PHASES = frozenset(Phase)


@dataclass(frozen=True, slots=True)
class State:
    """*beats* counts the changes of state; *batch* and *number* name the run at hand, if there is one.

    *printed* is how many bytes of output there were before, *process* whose state it is.
    """

    beats: int
    phase: Phase
    batch: int
    number: int
    printed: int
    process: int


class Heartbeat:
    """One thread's place in a worker's file: its simulation's progress block, then its state."""

    def __init__(self, file: Path, thread: int = 0) -> None:
        with file.open("r+b") as stream:
            self._map = mmap.mmap(stream.fileno(), 0)
        self._begin = thread * _SIZE
        self._beats = 0
        self._process = os.getpid()

    @staticmethod
    def lay_out(file: Path, threads: int = 1) -> None:
        """Make the file, all zero."""
        file.write_bytes(bytes(threads * _SIZE))

    @property
    def block(self) -> memoryview:
        """The progress block, to be written by the simulation; the file stays mapped as long as this view lives."""
        return memoryview(self._map)[self._begin : self._begin + PROGRESS_BYTES]

    def beat(self, phase: Phase, batch: int = -1, number: int = -1) -> None:
        """Tell that the thread is in *phase* now."""
        self._beats += 1
        try:
            printed = os.lseek(2, 0, os.SEEK_CUR)
        except OSError:  # a run has closed it
            printed = 0
        place = self._begin + PROGRESS_BYTES
        _STATE.pack_into(self._map, place, self._beats, phase, batch, number, printed, self._process)

    def state(self) -> State:
        """What was told last."""
        return _state(self._map, self._begin)

    def progress(self) -> bytes:
        """A copy of the progress block."""
        return self._map[self._begin : self._begin + PROGRESS_BYTES]

    def close(self) -> None:
        """Unmap the file; BufferError while a view of the block is alive."""
        self._map.close()


def states_in(file: Path) -> list[State]:
    """The last states of a worker whose supervisor is gone, too."""
    content = file.read_bytes() if file.is_file() else b""
    return [_state(content, begin) for begin in range(0, len(content) - _SIZE + 1, _SIZE)]


def _state(content: mmap.mmap | bytes, begin: int) -> State:
    beats, phase, *rest = _STATE.unpack_from(content, begin + PROGRESS_BYTES)
    # The file is open in the worker: an FMU may have written into it.
    return State(beats, Phase(phase) if phase in _PHASES else Phase.STARTING, *rest)
