"""One writer per study folder: a lock that the system takes back from a dead process, and a note of who holds it."""

from __future__ import annotations

import errno
import json
import os
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType

from dse.errors import DseError, Location, fail
from dse.json_data import read_json, read_noun
from dse.scratch import start_of
from dse.storage.attempts import this_process
from dse.storage.disk import not_made, refused

LOCK = "writer.lock"
WRITER = "writer.json"

_NO_LOCKS = frozenset({errno.ENOSYS, errno.ENOTSUP, errno.EOPNOTSUPP, errno.ENOLCK})
"""What a file system without locks says."""

_WAIT = 0.2
"""Seconds to wait for the lock: who looks whether it is free holds it for a moment."""


@dataclass(frozen=True, slots=True)
class Writer:
    """The process that writes into a study folder; *started* is when it did, as `start_of` tells."""

    host: str
    process: int
    started: int = 0

    def __str__(self) -> str:
        return f"process {self.process} on {self.host}"


class WriterLock:
    """Held from its making until it is let go, or its process is dead. *path* is a folder, made if it is not there.

    DseError if another process holds it, or the folder cannot be written to.
    """

    def __init__(self, path: Path) -> None:
        from filelock import FileLock, Timeout

        self._path = path
        self._lock = FileLock(
            path / LOCK, timeout=_WAIT, poll_interval=_WAIT / 4, thread_local=False, fallback_to_soft=False
        )
        try:
            path.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise not_made(path, error) from error
        try:
            self._lock.acquire()
        except Timeout:
            raise _refused(path, writer_of(path)) from None
        except OSError as error:
            if error.errno not in _NO_LOCKS:
                raise refused(path, error) from error
            if writer := _noted(path):
                raise _refused(path, writer) from None
        self._is_held = True
        try:
            _note(path)
        except OSError as error:
            self.release()
            raise refused(path, error) from error

    def release(self) -> None:
        """Let go, if it is held."""
        if not self._is_held:
            return
        self._is_held = False
        for name in (WRITER, LOCK):
            with suppress(OSError):  # Windows keeps a file that is open
                (self._path / name).unlink()
        self._lock.release()

    def __enter__(self) -> WriterLock:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.release()


def writer_of(path: Path) -> Writer | None:
    """Who writes into the study folder *path* now; None if nobody does, as the lock shows where there are locks."""
    return None if _is_free(path / LOCK) else _noted(path)


def _noted(path: Path) -> Writer | None:
    """Who has noted to write into *path*; None for a process of this machine that is dead."""
    try:
        writer: Writer = read_noun(read_json((path / WRITER).read_bytes()), Writer, WRITER)
    except (OSError, ValueError):
        return None
    host, _, _ = this_process().rpartition("/")
    if writer.host == host:
        with suppress(OSError, OverflowError):
            return writer if 0 != start_of(writer.process) == writer.started else None
        return None
    return writer


def _is_free(lock: Path) -> bool:
    """Whether nobody holds *lock*, as far as that can be seen."""
    if os.name == "nt":
        return False
    import fcntl

    try:
        opened = os.open(lock, os.O_RDONLY | os.O_CLOEXEC)
    except OSError:
        return not lock.exists()
    try:
        fcntl.flock(opened, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except OSError:  # held, or there are no locks
        return False
    else:
        return True
    finally:
        os.close(opened)


def _note(path: Path) -> None:
    host, _, process = this_process().rpartition("/")
    note = {"host": host, "process": int(process), "started": start_of(int(process))}
    (path / WRITER).write_text(json.dumps(note), encoding="utf-8")


def _refused(path: Path, writer: Writer | None) -> DseError:
    who = str(writer or "another process")
    hint = f"wait for it, stop it, or give another folder with -o; if it is gone for good, delete {WRITER}"
    return fail(f"{who} is at work in it", Location(str(path)), hint)
