"""What decides the last bits of a result beside the FMUs: the processor and the library of mathematical functions."""

from __future__ import annotations

import hashlib
import math
import platform
import socket
import struct
from dataclasses import dataclass
from functools import cache
from pathlib import Path

_ARGUMENTS = 2000


@dataclass(frozen=True, slots=True)
class Machine:
    """A *host* with its *processor* and C *library*; *bits* stands for what this makes of exp, sin, pow and atan2."""

    host: str
    processor: str
    library: str
    bits: str

    def __str__(self) -> str:
        return f"{self.host} ({self.processor}, {self.library})"


@cache
def this_machine() -> Machine:
    """The machine we are on."""
    library = " ".join(platform.libc_ver()).strip() or platform.platform()
    return Machine(socket.gethostname(), _processor(), library, _bits())


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        lines = []
    names = (line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    return next(names, platform.processor() or platform.machine())


def _bits() -> str:
    # glibc chooses other code on processors with fused multiply-add; Python's functions are those of the C library.
    digest = hashlib.sha256()
    for i in range(_ARGUMENTS):
        x = (i + 0.5) * 0.0137 + i * i * 1e-6
        values = (math.exp(-x), math.sin(x), math.pow(x, 1.37), math.atan2(x, 3.1 - x))
        digest.update(struct.pack("<4d", *values))
    return digest.hexdigest()[:16]
