"""Which C compiler builds components on this machine."""

from __future__ import annotations

import importlib.metadata
import importlib.util
import json
import os
import platform
import re
import shlex
import shutil
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import TypeVar

from dse.cache import cache_folder, content_key, keep_content, recent_entries
from dse.errors import DseError, Problem, fail
from dse.fmu.toolchain.platforms import WINDOWS, Platform, this_platform

T = TypeVar("T")

_NAMES = ("cc", "gcc", "clang")
_MINGW = "x86_64-w64-mingw32-gcc"
_ZIGLANG = "pip install 'dse-workbench[toolchain]'"
_INSTALL = f"install a C compiler (gcc or clang), or run: {_ZIGLANG}"


@dataclass(frozen=True, slots=True)
class Compiler:
    """A C compiler that takes gcc's options.

    *command* starts it; it is empty if the compiler is not here, but made what is in the cache. *identity* says its
    name, version and target; it holds no path, so that it may stand in a cache key. *link_options* are what its linker
    needs to write the same bytes twice. *system* is what the code is for: linux, darwin or win32.
    """

    command: tuple[str, ...]
    identity: str
    link_options: tuple[str, ...] = ()
    system: str = sys.platform


class NoCompilerError(DseError):
    """There is no C compiler on this machine."""


def no_compiler() -> NoCompilerError:
    """The error that says how to get one."""
    return NoCompilerError(Problem("there is no C compiler on this machine", hint=_INSTALL))


def find_compiler() -> Compiler:
    """The compiler named by ``$CC``, else cc, gcc or clang, else the one in the ziglang wheel.

    Raises NoCompilerError if there is none, DseError if ``$CC`` names one that cannot be run.
    """
    named = os.environ.get("CC", "").strip()
    if named:
        return _named(named)
    for name in _NAMES:
        path = shutil.which(name)
        identity = _identify((path,)) if path else None
        if path and identity:
            return Compiler((path,), identity, _without_timestamp(identity))
    if importlib.util.find_spec("ziglang") is not None:
        return _zig(this_platform())
    raise no_compiler()


def find_compiler_for(target: Platform) -> Compiler:
    """The one in the ziglang wheel, which compiles for any *target*. Raises NoCompilerError if it is not here."""
    if importlib.util.find_spec("ziglang") is None:
        what = f"the ziglang package, which compiles for {target.name}, is not installed"
        raise NoCompilerError(Problem(what, hint=f"run: {_ZIGLANG}"))
    return _zig(target)


def find_windows_compiler() -> Compiler:
    """A compiler that makes 64-bit programs for Windows: MinGW's gcc, else the one in the ziglang wheel.

    Raises NoCompilerError if there is none.
    """
    path = shutil.which(_MINGW)
    identity = _identify((path,)) if path else None
    if path and identity:
        return Compiler((path,), identity, _without_timestamp(identity), "win32")
    if importlib.util.find_spec("ziglang") is not None:
        return _zig(WINDOWS)
    what = "there is no compiler for Windows programs on this machine"
    raise NoCompilerError(Problem(what, hint=f"run: {_ZIGLANG}, or install {_MINGW}"))


WEB = "wasi"
"""The system that modules for pages are compiled for."""


def find_web_compiler() -> Compiler:
    """The compiler for modules in pages: that of the ziglang wheel. Raises NoCompilerError if it is not here."""
    if importlib.util.find_spec("ziglang") is None:
        what = "the ziglang package, which compiles what a page simulates, is not installed"
        raise NoCompilerError(Problem(what, hint=f"run: {_ZIGLANG}"))
    triple = "wasm32-wasi"
    # What every browser of the last years has.
    command = (sys.executable, "-m", "ziglang", "cc", "-target", triple, "-mcpu=generic+simd128+bulk_memory")
    return Compiler(command, f"ziglang {importlib.metadata.version('ziglang')}; {triple}", system=WEB)


def with_compiler(cache: Path | None, work: Callable[[Compiler], T]) -> T:
    """What *work* gives with the compiler of this machine.

    Where there is none, with one that was used before, if *work* then finds all it needs in the cache. Raises DseError
    as `find_compiler`, and what *work* raises.
    """
    used = cache_folder(cache) / "compilers"
    try:
        compiler = find_compiler()
    except NoCompilerError:
        for identity, *link_options in map(json.loads, recent_entries(used)):
            try:
                return work(Compiler((), identity, tuple(link_options)))
            except NoCompilerError:
                continue
        raise
    made = work(compiler)
    about = json.dumps([compiler.identity, *compiler.link_options]).encode()
    keep_content(used / content_key([("compiler", about)]), lambda: about)
    return made


def environment() -> dict[str, str]:
    """The environment a compiler runs in: English messages, and no search path that its key does not know."""
    kept = {name: value for name, value in os.environ.items() if name not in _HIDDEN_INPUTS}
    return {**kept, "LC_ALL": "C", "LANGUAGE": "C"}


_HIDDEN_INPUTS = {"CPATH", "C_INCLUDE_PATH", "LIBRARY_PATH", "COMPILER_PATH", "GCC_EXEC_PREFIX"}


def _named(text: str) -> Compiler:
    whole = shutil.which(text)
    words = [whole] if whole else shlex.split(text, posix=os.name != "nt")
    path = shutil.which(words[0])
    if path is None:
        raise _unusable(text, "it is not on PATH")
    command = (path, *words[1:])
    identity = _identify(command)
    if identity is None:
        raise _unusable(text, "it does not answer like gcc or clang")
    return Compiler(command, identity, _without_timestamp(identity))


def _unusable(text: str, reason: str) -> DseError:
    return fail(f"CC is set to '{text}', but {reason}", hint="set CC to gcc or clang, or unset it")


def _identify(command: tuple[str, ...]) -> str | None:
    executable = Path(command[0])
    try:
        changed = executable.stat().st_mtime_ns
    except OSError:
        return None
    return _ask(command, changed)


@lru_cache(maxsize=32)
def _ask(command: tuple[str, ...], changed: int) -> str | None:  # noqa: ARG001  # an updated compiler is asked anew
    try:
        answer = subprocess.run(
            [*command, "-v"],
            env=environment(),
            capture_output=True,
            text=True,
            encoding="utf-8",
            errors="replace",
            timeout=60,
            check=False,
        )
    except (OSError, subprocess.TimeoutExpired):
        return None
    version = re.search(r"^.*\b(?:gcc|clang) version .*$", answer.stderr, re.MULTILINE)
    target = re.search(r"^Target: (\S+)", answer.stderr, re.MULTILINE)
    if answer.returncode != 0 or version is None or target is None:
        return None
    options = " ".join(command[1:])
    return f"{version[0].strip()}; {target[1]}; {options}".rstrip("; ")


def _without_timestamp(identity: str) -> tuple[str, ...]:
    """Windows libraries carry the time they were linked at, unless the linker is told not to."""
    if "mingw" in identity or "windows-gnu" in identity:
        return ("-Wl,--no-insert-timestamp",)
    return ("-Wl,/Brepro",) if "windows-msvc" in identity else ()


def _zig(target: Platform) -> Compiler:
    # A named target takes the baseline processor, and an old glibc or macOS, so that the library runs elsewhere too.
    architecture, _, system = target.name.partition("-")
    is_musl = target == this_platform() and platform.libc_ver()[0] != "glibc"
    linux = "linux-musl" if is_musl else "linux-gnu.2.17"
    triple = f"{architecture}-{ {'windows': 'windows-gnu', 'darwin': 'macos.11.0'}.get(system, linux) }"
    command = (sys.executable, "-m", "ziglang", "cc", "-target", triple)
    identity = f"ziglang {importlib.metadata.version('ziglang')}; {triple}"
    # Its linker for macOS writes where the objects were, unless it strips.
    stripped = ("-s",) if system == "darwin" else ()
    return Compiler(command, identity, stripped, {"windows": "win32"}.get(system, system))
