"""The library that lets system calls fail, and the file by which a test tells it which."""

from __future__ import annotations

import errno
import struct
import subprocess
from dataclasses import dataclass
from pathlib import Path

KINDS = (
    *("write", "rename", "fsync", "mmap", "malloc", "open", "ftruncate", "fork"),
    *("full", "broken", "files", "denied"),
)
"""write: pwrite and writev, too; open: for writing, and mkdir; ftruncate: whatever changes a file's length;
fork: what starts processes and threads. The last four are all calls on the files of a case that a full disk, a broken
disk, a limit on open files or a missing right lets fail. The order is that of shim.c."""

ROLES = ("coordinator", "worker", "compiler")
"""The command itself; every other Python it starts; every other program."""

LEAST = 65536
"""Bytes from which on an allocation counts."""

ONCE, FROM_THEN_ON, EACH = range(3)

_SET = struct.Struct("=6q512s")
_TOLD = struct.Struct(f"=2q{len(ROLES) * len(KINDS)}q1024s")


@dataclass(frozen=True, slots=True)
class Fault:
    """The *nth* call of *kind* in processes of *role*, counted from 1, fails with *error*.

    *stays* FROM_THEN_ON: all later ones do, too, in every process, until the command ends. EACH: each *nth* does.
    """

    kind: str
    role: str
    error: str
    nth: int
    stays: int = ONCE

    def __str__(self) -> str:
        which = (f"{self.nth}", f"{self.nth} and all after it", f"each {self.nth}th")[self.stays]
        return f"{self.kind} {which} of the {self.role}: {self.error}"


@dataclass(frozen=True, slots=True)
class Told:
    """What the library saw: whether a call *failed*, *what* it was, and how many calls there were by role and kind."""

    failed: int
    what: str
    counts: dict[tuple[str, str], int]


def build(folder: Path) -> Path:
    """The library, compiled."""
    target = folder / "shim.so"
    source = Path(__file__).with_name("shim.c")
    subprocess.run(["cc", "-O1", "-shared", "-fPIC", "-o", str(target), str(source), "-ldl"], check=True)
    return target


def set_fault(file: Path, fault: Fault | None, below: Path) -> None:
    """Lay out *file*; without a fault calls are only counted. The files of the case are *below* that folder."""
    kind, role, nth, stays, error = -1, -1, 0, 0, 0
    if fault:
        kind, role, nth = KINDS.index(fault.kind), ROLES.index(fault.role), fault.nth
        stays, error = fault.stays, getattr(errno, fault.error)
    file.write_bytes(_SET.pack(kind, role, nth, stays, error, LEAST, bytes(below)) + bytes(_TOLD.size))


def told(file: Path) -> Told:
    """What stands in *file* after the command."""
    _, failed, *counts, what = _TOLD.unpack_from(file.read_bytes(), _SET.size)
    places = [(role, kind) for role in ROLES for kind in KINDS]
    text = what.partition(b"\0")[0].decode(errors="replace")
    return Told(failed, text, dict(zip(places, counts, strict=True)))
