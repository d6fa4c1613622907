"""What FMI calls the machine this runs on, and others, and where an FMU keeps the library for each."""

from __future__ import annotations

import platform
import sys
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import PurePosixPath

from dse.errors import closest, fail


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


WINDOWS = Platform("x86_64-windows", "win64", ".dll")
_DARWIN = tuple(Platform(f"{architecture}-darwin", "darwin64", ".dylib") for architecture in ("x86_64", "aarch64"))
_LINUX = Platform("x86_64-linux", "linux64", ".so")
_NAMED = {
    **{each.name: (each,) for each in (WINDOWS, *_DARWIN, _LINUX)},
    **{each.short_name: (each,) for each in (WINDOWS, _LINUX)},
    **dict.fromkeys(("darwin", "darwin64"), _DARWIN),
}


def platforms_named(names: Iterable[str]) -> tuple[Platform, ...]:
    """The platforms that *names* of FMI 2 or 3 stand for; ``darwin`` is both kinds of Mac. Raises DseError."""
    found: dict[Platform, None] = {}
    for name in names:
        if name not in _NAMED:
            raise fail(f"'{name}' is not a platform that FMUs can be built for", hint=closest(name, _NAMED))
        found |= dict.fromkeys(_NAMED[name])
    return tuple(found)


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
