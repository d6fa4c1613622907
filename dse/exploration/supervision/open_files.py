"""The files a worker has open: FMUs may leave some behind, and a process can have only so many."""

from __future__ import annotations

import errno
import os
import sys
from contextlib import suppress
from functools import lru_cache

OUT_OF_FILES = frozenset({errno.EMFILE, errno.ENFILE})
"""What is wrong with a process, or the system, that has too many open files."""

_MOST = 10_000
_SPARE = 16


def are_many_open() -> bool:
    """Whether so many files are open that the process should be renewed: three quarters of what it may have."""
    try:
        # The lowest number that is free is what is asked for: it counts all that are open, in no time.
        handle = os.dup(2)
    except OSError as error:
        return error.errno in OUT_OF_FILES
    os.close(handle)
    return handle >= _most()


@lru_cache(maxsize=1)
def _most() -> int:
    if sys.platform == "win32":
        return _MOST
    import resource

    soft, _ = resource.getrlimit(resource.RLIMIT_NOFILE)
    return _MOST if soft == resource.RLIM_INFINITY else min(_MOST, soft * 3 // 4)


class SpareFiles:
    """Numbers of files that are kept back, so that results can be written whatever the simulation leaves open."""

    def __init__(self) -> None:
        _most()  # before a simulation can change the limit
        self._kept: list[int] = []
        self.take()

    def take(self) -> None:
        """Keep them back, as many as there are."""
        with suppress(OSError):
            while len(self._kept) < _SPARE:
                self._kept.append(os.open(os.devnull, os.O_RDONLY))

    def give(self) -> None:
        """Let them be used."""
        while self._kept:
            with suppress(OSError):
                os.close(self._kept.pop())
