"""What FMI calls the machine this runs on, and where an FMU keeps the library for it."""

from __future__ import annotations

import platform
import sys
from dataclasses import dataclass
from pathlib import PurePosixPath


@dataclass(frozen=True, slots=True)
class Platform:
    """A kind of machine: its name in FMI 3 (``x86_64-linux``), in FMI 2 (``linux64``), and how libraries end."""

    name: str
    short_name: str
    suffix: str

    def library(self, version: int, identifier: str) -> PurePosixPath:
        """Where an FMU of this FMI version that we write keeps the library, relative to its root."""
        folder = self.name if version == 3 else self.short_name
        return PurePosixPath("binaries", folder, identifier + self.suffix)

    def candidates(self, version: int, identifier: str) -> tuple[PurePosixPath, ...]:
        """Where to look for the library in an FMU of this FMI version; some older FMUs use FMI 3.0's names."""
        folders = (self.name,) if version == 3 else (self.short_name, self.name)
        return tuple(PurePosixPath("binaries", folder, identifier + self.suffix) for folder in folders)


def this_platform() -> Platform:
    """The platform of the running interpreter."""
    machine = platform.machine().lower()
    architecture = {"amd64": "x86_64", "arm64": "aarch64", "i386": "x86", "i686": "x86"}.get(machine, machine)
    is_64_bit = sys.maxsize > 2**32
    if architecture == "x86_64" and not is_64_bit:
        architecture = "x86"
    system, prefix, suffix = {
        "win32": ("windows", "win", ".dll"),
        "darwin": ("darwin", "darwin", ".dylib"),
    }.get(sys.platform, ("linux", "linux", ".so"))
    return Platform(f"{architecture}-{system}", f"{prefix}{64 if is_64_bit else 32}", suffix)
