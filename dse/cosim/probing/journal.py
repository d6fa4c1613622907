"""Where an experiment is, readable by the one who started it even after it crashed."""

from __future__ import annotations

import mmap
import struct
from pathlib import Path

_COUNT = struct.Struct("=q")
_TEXT = 200


class Journal:
    """A small file that two processes have mapped: a count, and what is being done in words."""

    def __init__(self, file: Path) -> None:
        with file.open("r+b") as stream:
            self._map = mmap.mmap(stream.fileno(), 0)

    @staticmethod
    def lay_out(file: Path) -> None:
        """Make the file, empty."""
        file.write_bytes(bytes(_COUNT.size + _TEXT))

    def note(self, doing: str) -> None:
        """Write down what is about to be done."""
        text = doing.encode()[: _TEXT - 1]
        self._map[_COUNT.size : _COUNT.size + len(text) + 1] = text + b"\0"

    def count(self, number: int) -> None:
        """Write down how often something has been done."""
        _COUNT.pack_into(self._map, 0, number)

    @property
    def doing(self) -> str:
        """What was noted last."""
        return self._map[_COUNT.size :].split(b"\0", 1)[0].decode("utf-8", "replace")

    @property
    def counted(self) -> int:
        """The last count."""
        (number,) = _COUNT.unpack_from(self._map, 0)
        return int(number)

    def close(self) -> None:
        """Unmap the file."""
        self._map.close()
