"""Stopping whoever explores a study, from another process of the same user on the same machine."""

from __future__ import annotations

import os
import signal
import sys
from pathlib import Path

from dse.errors import DseError, Location, fail
from dse.storage import LOCK, Writer, this_process, writer_of


def stop(folder: str | Path) -> Writer:
    """Ask the process that explores the study in *folder* to stop, as Ctrl-C does: what was finished is stored.

    It may take a moment. Raises DseError if nobody explores it, or somebody who cannot be asked from here.
    """
    path = Path(folder)
    writer = writer_of(path)
    if writer is None:
        raise fail("no process explores this study at the moment", Location(str(path)))
    host = this_process().rpartition("/")[0]
    if writer.host != host:
        raise _refused(path, writer, f"it is on another machine than this one ({host})", "press Ctrl-C there")
    if writer.process == os.getpid():
        raise _refused(path, writer, "it is this program itself", "interrupt it where it was started")
    if sys.platform == "win32":
        raise _refused(path, writer, "Windows has no way to interrupt another console", "press Ctrl-C in its window")
    _require_ours(path, writer)
    number = _heard(path, writer)
    try:
        os.kill(writer.process, number)
    except ProcessLookupError:
        raise fail("no process explores this study any more", Location(str(path))) from None
    except PermissionError:
        raise _refused(path, writer, "it belongs to another user", "ask that user") from None
    return writer


def _require_ours(path: Path, writer: Writer) -> None:
    """DseError unless the process is this user's and has the folder's lock open.

    The note beside the lock came with the folder, from anywhere: what it says alone must not have a process stopped.
    """
    import psutil

    try:
        process = psutil.Process(writer.process)
        owner = process.uids().real
        if owner != os.getuid() and os.getuid() != 0:
            raise _refused(path, writer, f"it belongs to another user ({process.username()})", "ask that user")
        lock = (path / LOCK).resolve()
        has_lock = any(os.path.realpath(each.path) == str(lock) for each in process.open_files())
    except psutil.NoSuchProcess:
        raise fail("no process explores this study any more", Location(str(path))) from None
    except psutil.Error as error:
        raise _refused(path, writer, f"the system does not show whether it writes here ({error})", _THERE) from error
    if not has_lock:
        raise _refused(path, writer, f"it does not hold the folder's {LOCK}", _THERE)


def _heard(path: Path, writer: Writer) -> signal.Signals:
    """The signal to stop it with: what a shell has put into the background hears no Ctrl-C, but SIGTERM.

    Only a process that handles SIGTERM itself gets that: it would end any other in the middle of things.
    """
    try:
        told = Path(f"/proc/{writer.process}/status").read_text("ascii", "replace")
    except OSError:  # only Linux tells
        return signal.SIGINT
    masks = {line.partition(":")[0]: line.partition(":")[2].strip() for line in told.splitlines()}

    def has(mask: str, number: signal.Signals) -> bool:
        return bool(int(masks.get(mask, "0"), 16) >> (number - 1) & 1)

    if not has("SigIgn", signal.SIGINT):
        return signal.SIGINT
    if has("SigCgt", signal.SIGTERM):
        return signal.SIGTERM
    raise _refused(path, writer, "it ignores interrupts", "end it where it was started")


_THERE = "press Ctrl-C where it was started"


def _refused(path: Path, writer: Writer, why: str, hint: str) -> DseError:
    return fail(f"{writer} cannot be stopped from here: {why}", Location(str(path)), hint)
