"""FMUs for Windows on Linux: a bridge in the place of their library, and for that a host, which wine runs."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import warnings
from collections.abc import Callable, Mapping
from functools import cache as once
from pathlib import Path, PurePosixPath

from dse.cache import CacheWarning, cache_folder, content_key, keep_files, keep_living_folder
from dse.domain.fmu import Host
from dse.errors import Location, fail
from dse.fmu.reading.description import Description
from dse.fmu.toolchain.compilation import CompilationError, compile_library, compile_program, options
from dse.fmu.toolchain.compiler import Compiler, find_windows_compiler, with_compiler
from dse.fmu.toolchain.platforms import WINDOWS, this_platform

_SOURCES = Path(__file__).parent / "bridge"
_WINES = ("wine64", "wine", "/usr/lib/wine/wine64")  # the last is Debian's, which puts it on no PATH
_LONGEST = 600
"""Seconds that wine may take to make a folder of Windows."""


def windows_library(folder: Path, description: Description) -> Path | None:
    """The library for 64-bit Windows in the unpacked FMU in *folder*, if this machine could run it in wine at all."""
    if this_platform().name != "x86_64-linux" or description.version == 1:
        return None
    paths = (folder / path for path in WINDOWS.candidates(description.version, description.identifier))
    return next((path for path in paths if path.is_file()), None)


def needed_for_wine(folder: Path, description: Description) -> str:
    """Why wine is of no use for the FMU, to be put behind a hint; "" if it has nothing for Windows."""
    if not any((folder / "binaries").glob("*win*/*.dll")) or this_platform().name != "x86_64-linux":
        return ""
    if description.version == 1:
        return ", or in FMI 2.0 or 3.0 (wine is used for those only)"
    return f", or for {WINDOWS.short_name} (wine is used for 64-bit libraries of its modelIdentifier only)"


def bridge_to(library: Path, identifier: str, where: Location, cache: Path | None) -> tuple[Path, Host]:
    """The bridge to *library* for Windows, which the FMU calls *identifier*, and the host to be started for it.

    What wine needs is made once, and kept in the cache. Raises DseError located at *where* that says what is missing,
    be it wine or a compiler for Windows.
    """
    wine = find_wine()
    if not wine:
        what = f"the FMU has no library for {this_platform().name}, only for Windows, and there is no wine to run it"
        hint = "run: apt install wine64 (and pip install 'dse-workbench[toolchain]'), or export it for this platform"
        raise fail(what, where, hint)
    prefix = folder_of_windows(wine, cache)
    try:
        made = with_compiler(cache, lambda compiler: _compiled(compiler, _version_of(wine), cache))
    except CompilationError as error:
        raise fail(f"the bridge to wine does not compile: {error.diagnostics[0].message}", where) from error
    place = str(PurePosixPath(library.absolute())).replace("/", "\\")
    command = (wine, str((made / "host.exe").absolute()), f"Z:{place}")
    return bridge_of(library, identifier, made, cache), Host(command, _settings(prefix), is_wine=True)


def bridge_of(library: Path, identifier: str, made: Path, cache: Path | None) -> Path:
    """A copy of the bridge in the folder *made* for *library* alone: the system loads the same one only once."""
    name, content = f"{identifier}.so", (made / "bridge.so").read_bytes()
    key = content_key([("bridge", content), ("library", os.fsencode(library.absolute()))])
    return keep_files(cache_folder(cache) / "bridges" / key, lambda: {name: content}) / name


def find_wine() -> str:
    """The path of wine, "" if there is none."""
    return next((path for name in _WINES if (path := shutil.which(name))), "")


def folder_of_windows(wine: str, cache: Path | None) -> Path:
    """The folder in which *wine* has its Windows, never the user's own; made unless it is in the cache."""
    version = content_key([("wine", _version_of(wine).encode())])
    return keep_living_folder(cache_folder(cache).absolute() / "wine" / version, _filler(wine))


def bridge_sources() -> dict[str, bytes]:
    """The sources of bridge and host, by name."""
    return {path.name: path.read_bytes() for path in sorted(_SOURCES.glob("*.[ch]"))}


@once
def _version_of(wine: str) -> str:
    answer = subprocess.run([wine, "--version"], capture_output=True, text=True, timeout=60, check=False)
    return answer.stdout.strip()  # "wine-8.0 (Debian 8.0~repack-4)"


def _compiled(compiler: Compiler, version: str, cache: Path | None) -> Path:
    """The folder with the bridge and the host."""
    windows = find_windows_compiler()
    files = bridge_sources()
    told = re.sub(r"[^\w .~()-]", "", version, flags=re.ASCII)
    files["bridge.c"] = f'#define WINE "{told}"\n'.encode() + files["bridge.c"]
    identity = repr((compiler.identity, options(compiler), windows.identity))
    return keep_files(
        cache_folder(cache) / "bridges" / content_key([*files.items(), ("build", identity.encode())]),
        lambda: {
            "bridge.so": compile_library(compiler, files, ["bridge.c"], ".", "bridge.so"),
            "host.exe": compile_program(windows, files, "host.c", "host.exe", "-municode"),
        },
    )


def _filler(wine: str) -> Callable[[Path], None]:
    """What has *wine* make a folder of Windows."""

    def fill(folder: Path) -> None:
        warnings.warn("wine makes its folder of Windows, once: about 20 s, 0.7 GB", CacheWarning, stacklevel=2)
        environment = {**os.environ, **_settings(folder)}
        told = _run([wine, "wineboot", "--init"], environment)
        if server := shutil.which("wineserver", path=f"{Path(wine).parent}{os.pathsep}{os.environ.get('PATH', '')}"):
            _run([server, "--wait"], environment)  # it writes its files when it ends
        if not (folder / _MARK).is_file():
            raise fail(f"wine cannot make its folder of Windows: {told or 'it gives no reason'}")

    return fill


_MARK = ".update-timestamp"
"""The last that wine writes into a new folder."""


def _run(command: list[str], environment: Mapping[str, str]) -> str:
    """The last line that *command* says."""
    try:
        answer = subprocess.run(
            command,
            env=environment,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            timeout=_LONGEST,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return f"it took longer than {_LONGEST} s"
    except OSError as error:
        return str(error)
    return (answer.stderr.decode("utf-8", "replace").strip().splitlines() or [""])[-1]


def _settings(prefix: Path) -> Mapping[str, str]:
    """The environment that keeps wine to its folder: no windows, no debugger, nothing of the user's."""
    return {
        "WINEPREFIX": str(prefix),
        "HOME": "/nonexistent",
        "WINEARCH": "win64",
        "WINEDEBUG": "-all",
        "WINEDLLOVERRIDES": "mscoree,mshtml=;winemenubuilder.exe,winedbg.exe=d",
        "DISPLAY": "",
        "WAYLAND_DISPLAY": "",
    }
