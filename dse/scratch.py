"""What is there for a while: folders that go with their context, files until they become what the user wants.

What dead processes left behind of such folders goes when the next one is made.
"""

from __future__ import annotations

import os
import re
import shutil
import sys
import tempfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path

from dse.errors import fail, remedy

_NAME = re.compile(r"\.?dse-(?P<place>[0-9a-f]{8})-(?P<process>\d+)-(?P<start>\d+)-")


class ScratchFolder(tempfile.TemporaryDirectory[str]):
    """A new temporary folder. Raises DseError if none can be made."""

    def __init__(self) -> None:
        with _swept():
            super().__init__(prefix=name_of_mine(), ignore_cleanup_errors=True)


def new_folder() -> Path:
    """A new temporary folder that its maker removes. Raises DseError if none can be made."""
    with _swept():
        return Path(tempfile.mkdtemp(prefix=name_of_mine())).resolve()


@contextmanager
def _swept() -> Iterator[None]:
    try:
        _sweep(tempfile.gettempdir())
        yield
    except OSError as error:
        what = f"no temporary folder can be made: {error.strerror or error}"
        hint = remedy(error.errno, "set TMPDIR to a folder that exists, has space and may be written")
        raise fail(what, hint=hint) from error


def name_of_mine() -> str:
    """How the name of a temporary folder of this process begins."""
    process = os.getpid()
    return f"dse-{_place()}-{process}-{start_of(process)}-"


def is_left_over(name: str) -> bool | None:
    """Whether the process has ended whose temporary folder is called *name*; None if nobody here can say."""
    found = _NAME.match(name)
    if found is None or found["place"] != _place():
        return None
    try:
        return int(found["start"]) != start_of(int(found["process"]))
    except OSError:
        return None


@cache  # once is enough
def _sweep(folder: str) -> None:
    """Remove what dead processes of this user left in *folder*."""
    for entry in os.scandir(folder):
        with suppress(OSError):
            if is_left_over(entry.name) and _is_ours(entry):
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


def start_of(process: int) -> int:
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


@contextmanager
def written_whole(target: Path) -> Iterator[Path]:
    """Gives the path to write what the user wants to have in *target*, which then is there whole or as it was before.

    A pipe or device is written itself, a link stays one. OSError inside becomes a DseError.
    """
    real = Path(os.path.realpath(target))
    is_special = real.exists() and not real.is_file()
    aside = real if is_special else real.with_name(f".{real.stem[:99]}.{os.getpid()}.part{real.suffix}")
    try:
        yield aside
        if not is_special:
            aside.replace(real)
    except OSError as error:
        hint = remedy(error.errno, "choose another place with -o")
        raise fail(f"cannot write {target}: {error.strerror or error}", hint=hint) from error
    finally:
        if not is_special:
            with suppress(OSError):
                aside.unlink(missing_ok=True)


def make_folder(path: Path) -> None:
    """Make the folder *path*, which the user named, and those it lies in, unless they are there. Raises DseError."""
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        what = f"cannot make the folder {path}: {error.strerror or error}"
        raise fail(what, hint=remedy(error.errno, "choose another place with -o")) from error


def write_whole(target: Path, content: str | bytes) -> None:
    """Write *content*, text as UTF-8, to *target*, which the user named: whole or not at all. Raises DseError."""
    with written_whole(target) as path:
        path.write_bytes(content.encode() if isinstance(content, str) else content)
