"""Temporary folders: each goes with its context, and what dead processes left behind goes when the next one is made."""

from __future__ import annotations

import os
import re
import shutil
import sys
import tempfile
import zlib
from contextlib import suppress
from functools import cache
from pathlib import Path

from dse.errors import fail

_NAME = re.compile(r"dse-(?P<place>[0-9a-f]{8})-(?P<process>\d+)-(?P<start>\d+)-")


class ScratchFolder(tempfile.TemporaryDirectory[str]):
    """A new temporary folder. Raises DseError if none can be made."""

    def __init__(self) -> None:
        try:
            _sweep(tempfile.gettempdir())
            process = os.getpid()
            prefix = f"dse-{_place()}-{process}-{_start_of(process)}-"
            super().__init__(prefix=prefix, ignore_cleanup_errors=True)
        except OSError as error:
            what = f"no temporary folder can be made: {error.strerror or error}"
            raise fail(what, hint="set TMPDIR to a folder that exists, has space and may be written") from error


@cache  # once is enough
def _sweep(folder: str) -> None:
    """Remove what dead processes of this user left in *folder*."""
    for entry in os.scandir(folder):
        name = _NAME.match(entry.name)
        if name and name["place"] == _place():
            with suppress(OSError):  # it stays if nobody can say whose it is
                if _is_ours(entry) and int(name["start"]) != _start_of(int(name["process"])):
                    shutil.rmtree(entry.path, ignore_errors=True)


def _is_ours(entry: os.DirEntry[str]) -> bool:
    owner = entry.stat(follow_symlinks=False).st_uid
    return entry.is_dir(follow_symlinks=False) and (sys.platform == "win32" or owner == os.geteuid())


@cache
def _place() -> str:
    """Stands for where processes have numbers: not those of before a boot, or of a container with the same folder."""
    try:
        told = Path("/proc/sys/kernel/random/boot_id").read_text("ascii") + str(Path("/proc/self/ns/pid").readlink())
    except OSError:
        import platform

        told = platform.node()
    return f"{zlib.crc32(told.encode()):08x}"


def _start_of(process: int) -> int:
    """When *process* was started, by a clock that nobody sets; 0 if it does not live. Raises OSError if unknown."""
    if sys.platform == "linux":
        try:
            state, *rest = Path(f"/proc/{process}/stat").read_bytes().rpartition(b")")[2].split()
        except (FileNotFoundError, ProcessLookupError):
            return 0
        return 0 if state in b"ZX" else int(rest[18])
    import psutil

    try:
        return int(psutil.Process(process).create_time() * 1000)
    except psutil.NoSuchProcess:
        return 0
    except psutil.Error as error:
        raise OSError(str(error)) from error
