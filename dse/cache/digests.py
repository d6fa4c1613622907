"""What a file or a folder holds, in 64 hexadecimal digits; for a file they are its SHA-256."""

from __future__ import annotations

import os
import stat
from collections.abc import Iterator, Mapping
from pathlib import Path

from dse.errors import is_gone

Stamp = tuple[tuple[str, int, int, int, int, int], ...]

FOLDER = "/"
_NEITHER = "?"
_SMALL = 2**20


def stamp(path: Path) -> Stamp:
    """What changes whenever something in *path* is written: nobody can set back the time at which an entry changed."""
    return tuple(
        (name, found.st_mode, found.st_size, found.st_mtime_ns, found.st_ctime_ns, found.st_ino)
        for name, found in _walk(path)
    )


def contents(path: Path) -> dict[str, str]:
    """What is at *path* (its name is "") and below, sorted: the digests of files, `FOLDER`, or that it is neither.

    Nothing if there is nothing. Links are not followed. Raises OSError if something cannot be read.
    """
    return {name: _content(path / name, found) for name, found in _walk(path)}


def digest_of(found: Mapping[str, str]) -> str:
    """The digest of what has these contents."""
    from hashlib import sha256

    if found.keys() == {""} and found[""] != FOLDER:
        return found[""]
    lines = (f"{name}\0{content}\n" for name, content in found.items())
    return sha256("".join(lines).encode(errors="surrogateescape")).hexdigest()


def _walk(path: Path) -> Iterator[tuple[str, os.stat_result]]:
    pending = [""]
    found = {}
    while pending:
        name = pending.pop()
        try:
            found[name] = os.lstat(path / name)
            if stat.S_ISDIR(found[name].st_mode):
                pending += [f"{name}/{below}" if name else below for below in _names(path / name)]
        except OSError as error:
            if not is_gone(error):
                raise
    yield from sorted(found.items())


def _names(folder: Path) -> list[str]:
    with os.scandir(folder) as found:
        return [entry.name for entry in found]


def _content(path: Path, found: os.stat_result) -> str:
    from hashlib import file_digest, sha256

    if stat.S_ISDIR(found.st_mode):
        return FOLDER
    if not stat.S_ISREG(found.st_mode):
        return _NEITHER
    try:
        if found.st_size < _SMALL:  # for which a buffer would cost more than its bytes
            return sha256(path.read_bytes()).hexdigest()
        with path.open("rb") as file:
            return file_digest(file, "sha256").hexdigest()
    except OSError as error:
        if not is_gone(error):
            raise
        return _NEITHER
