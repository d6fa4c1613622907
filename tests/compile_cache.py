"""A C compiler that compiles the same thing once: everyday tests compile hundreds of libraries that do not change.

``use`` has ``$CC`` name a launcher of this file, for the tests and for every process they start. The launcher hands the
work on to the real compiler and keeps what it makes, by the compiler, its options and the sources, preprocessed with
their comments (some warnings read them). Only what compiled without a word is kept, so that errors and warnings are
told every time. Two processes that want the same wait for one another.

Everyday tests compile without the optimizer, which takes three quarters of the time: all of them, so that results can
be compared to the last bit. What asks for warnings keeps it, as some warnings are its findings, and so do the thorough
tests (``--optimized``), which compile as users do.
"""

from __future__ import annotations

import os
import sys

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    import pytest

OPTIMIZED = "DSE_TESTS_OPTIMIZED"
"""The variable that leaves the optimizer on."""

_REAL = "DSE_TESTS_CC"
_SPENT = "DSE_TESTS_CC_SPENT"
_DAYS = 14
_FEW = 100
_MAKES = ("-shared", "-s", "-c", "-S")
_UNKNOWN = ("-g", "-fsanitize", "-save", "-M", "-L", "--coverage", "@")  # what is made depends on folders, or is more
_READ = ("LIBRARY_PATH", "COMPILER_PATH", "GCC_EXEC_PREFIX")  # by compilers, and not in the key


def use(folder: Path, *, optimized: bool) -> None:
    """Set ``$CC`` to a launcher that keeps its results in *folder*; what was not used for two weeks is removed."""
    import shlex
    import time

    from dse.fmu.toolchain.compiler import find_compiler

    if sys.platform != "linux":  # elsewhere a library holds its own path or time
        return
    os.environ[_SPENT] = str(folder / f"spent{os.getpid()}")
    if _REAL in os.environ:  # a worker of a parallel run has it from its parent
        return
    if optimized:
        os.environ[OPTIMIZED] = "1"
    oldest = time.time() - _DAYS * 86400
    for path in folder.iterdir():
        if path.is_file() and path.stat().st_mtime < oldest:
            path.unlink(missing_ok=True)
    compiler = find_compiler()
    # Imported, it is not compiled to bytecode each time.
    start = f"import sys; sys.path.insert(0, {os.path.dirname(__file__)!r}); import compile_cache; compile_cache.main()"
    words = [sys.executable, "-I", "-S", "-c", start, str(folder), compiler.identity, *compiler.command]
    launcher = folder / "bin" / "cc"
    launcher.parent.mkdir(exist_ok=True)
    aside = launcher.with_name(f"cc{os.getpid()}")
    aside.write_text(f'#!/bin/sh\nexec {shlex.join(words)} -- "$@"\n', encoding="utf-8")
    aside.chmod(0o755)
    aside.replace(launcher)
    os.environ[_REAL] = os.environ.get("CC", "")
    os.environ["CC"] = str(launcher)


def leave(monkeypatch: pytest.MonkeyPatch) -> None:
    """Undo ``use`` until *monkeypatch* is undone."""
    real = os.environ.get(_REAL)
    if real:
        monkeypatch.setenv("CC", real)
    elif real is not None:
        monkeypatch.delenv("CC", raising=False)


def account() -> str:
    """The file in which launchers that work for this process write what they spend."""
    return os.environ.get(_SPENT, "")


def spent(account: str) -> float:
    """Seconds of processor time that went into what is kept now, by the file *account*."""
    try:
        return sum(map(float, _read(account).split()))
    except OSError:
        return 0.0


def main() -> None:
    """What the launcher does: ``FOLDER IDENTITY COMPILER … -- ARGUMENTS…``."""
    place = sys.argv.index("--")
    sys.exit(_compile(sys.argv[1], sys.argv[2], sys.argv[3:place], sys.argv[place + 1 :]))


def _compile(folder: str, identity: str, command: Sequence[str], arguments: Sequence[str]) -> int:
    if "-Wall" not in arguments and OPTIMIZED not in os.environ:
        arguments = ["-O0" if word == "-O2" else word for word in arguments]
    makes_one_file = arguments.count("-o") == 1 and bool({"-shared", "-c", "-S"} & {*arguments})
    if not makes_one_file or any(name in os.environ for name in _READ):
        return _run([*command, *arguments])
    at = arguments.index("-o")
    target, options = arguments[at + 1], [*arguments[:at], *arguments[at + 2 :]]
    key = _key(folder, [identity, *command], options)
    if key is None:
        return _run([*command, *arguments])
    import fcntl

    kept = os.path.join(folder, key)
    lock = os.open(f"{kept}.lock", os.O_CREAT | os.O_RDWR, 0o666)
    fcntl.flock(lock, fcntl.LOCK_EX)  # let go of when the process ends
    if os.path.exists(kept):
        os.utime(kept)
        _copy(kept, target)
        return 0
    aside = f"{kept}.{os.getpid()}"
    code = _run([*command, *arguments], aside)
    with open(aside, "rb") as file:
        said = file.read()
    sys.stderr.buffer.write(said)
    if code == 0 and not said:
        _copy(target, aside)
        os.replace(aside, kept)
        if _SPENT in os.environ:
            with open(os.environ[_SPENT], "a") as file:
                file.write(f"{sum(os.times()[:4]):.2f}\n")
    else:
        os.unlink(aside)
    return code


def _key(folder: str, compiler: Sequence[str], options: Sequence[str]) -> str | None:
    """The name of the result; None if it depends on more than is looked at, or cannot be made."""
    import hashlib

    files = [word for word in options if not word.startswith("-")]
    units = [word for word in files if word.endswith(".c")]
    linked = [word for word in files if word.endswith((".o", ".so", ".a"))]
    if not files or len(files) > len(units) + len(linked) or any(word.startswith(_UNKNOWN) for word in options):
        return None
    try:
        texts = [_read(path) for path in linked]
        if units:
            texts += _staged([*units, *options]) or _preprocessed(folder, compiler[1:], options, linked)
    except OSError:
        return None
    program = os.stat(compiler[1])
    words = [*compiler, str(program.st_size), str(program.st_mtime_ns)]
    words += [os.path.basename(word) if word in files else word for word in options]
    digest = hashlib.sha256("\0".join(word for word in words if not word.startswith("-I/")).encode())
    for text in texts:
        digest.update(b"%d " % len(text) + text)
    return digest.hexdigest()


def _staged(words: Sequence[str]) -> list[bytes]:
    """All files of the current folder, if it is a small one beyond which no word reaches but for the system's headers.

    That is how dse compiles; it takes a tenth of the time of preprocessing.
    """
    if any(word.removeprefix("-I").startswith(("/", "..")) or word == "-include" for word in words):
        return []
    paths: list[str] = []
    for place, _, names in os.walk("."):
        paths += (os.path.join(place, name) for name in names)
        if len(paths) > _FEW:
            return []
    return [text for path in sorted(paths) for text in (path.encode(), _read(path))]


def _preprocessed(folder: str, command: Sequence[str], options: Sequence[str], linked: Sequence[str]) -> list[bytes]:
    for_linking = {*linked, *(word for word in options if word.startswith(("-l", "-Wl,"))), *_MAKES}
    aside = os.path.join(folder, f"{os.getpid()}.i")
    try:
        words = [*command, "-E", "-C", *(word for word in options if word not in for_linking)]
        if _run(words, os.devnull, aside) != 0:
            raise FileNotFoundError
        lines = _read(aside).split(b"\n")
    finally:
        if os.path.exists(aside):
            os.unlink(aside)
    # The folders of a run are in the lines that say whence a line comes: of those, the file's name will do.
    return [line.rpartition(b"/")[2] if line.startswith(b"# ") else line for line in lines]


def _run(command: Sequence[str], errors: str = "", output: str = "") -> int:
    actions = [
        (os.POSIX_SPAWN_OPEN, number, path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o666)
        for number, path in ((1, output), (2, errors))
        if path
    ]
    process = os.posix_spawnp(command[0], command, os.environ, file_actions=actions)
    return os.waitstatus_to_exitcode(os.waitpid(process, 0)[1])


def _copy(source: str, target: str) -> None:
    with open(target, "wb") as file:
        file.write(_read(source))
    os.chmod(target, os.stat(source).st_mode)


def _read(path: str) -> bytes:
    with open(path, "rb") as file:
        return file.read()
