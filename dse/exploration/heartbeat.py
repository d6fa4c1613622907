"""A small file that a worker and its supervisor have both mapped: it tells what the worker does even after it died."""

from __future__ import annotations

import mmap
import struct
from dataclasses import dataclass
from enum import IntEnum
from pathlib import Path

PROGRESS_BYTES = 64
"""Size of the block the simulation itself writes to."""

_STATE = struct.Struct("=4q")


class Phase(IntEnum):
    """What a worker is doing."""

    STARTING = 0
    WAITING = 1
    LOADING = 2
    RUNNING = 3
    WRITING = 4


@dataclass(frozen=True, slots=True)
class State:
    """*beats* counts the changes of state; *batch* and *number* name the run at hand, if there is one."""

    beats: int
    phase: Phase
    batch: int
    number: int


class Heartbeat:
    """One worker's file: the simulation's progress block, then the worker's state."""

    def __init__(self, file: Path) -> None:
        with file.open("r+b") as stream:
            self._map = mmap.mmap(stream.fileno(), PROGRESS_BYTES + _STATE.size)
        self._beats = 0

    @staticmethod
    def lay_out(file: Path) -> None:
        """Make the file, all zero."""
        file.write_bytes(bytes(PROGRESS_BYTES + _STATE.size))

    @property
    def block(self) -> memoryview:
        """The progress block, to be written by the simulation; the file stays mapped as long as this view lives."""
        return memoryview(self._map)[:PROGRESS_BYTES]

    def beat(self, phase: Phase, batch: int = -1, number: int = -1) -> None:
        """Tell that the worker is in *phase* now."""
        self._beats += 1
        _STATE.pack_into(self._map, PROGRESS_BYTES, self._beats, phase, batch, number)

    def state(self) -> State:
        """What the worker told last."""
        beats, phase, batch, number = _STATE.unpack_from(self._map, PROGRESS_BYTES)
        return State(beats, Phase(phase), batch, number)

    def progress(self) -> bytes:
        """A copy of the progress block."""
        return self._map[:PROGRESS_BYTES]

    def close(self) -> None:
        """Unmap the file; BufferError while a view of the block is alive."""
        self._map.close()
