"""A disk that refuses: what happened, in words, and that what was finished is safe."""

from __future__ import annotations

import errno
from pathlib import Path

from dse.errors import DseError, Location, fail

GO_ON = "what was finished is stored: mend that, and the same command resumes from there"

FULL = "the disk is full"

_WHY = {
    errno.ENOSPC: FULL,
    getattr(errno, "EDQUOT", -1): "the disk quota is used up",
    errno.EFBIG: "the system lets no file grow further (ulimit -f)",
    errno.EROFS: "the file system is read-only",
    errno.EACCES: "there is no right to",
    errno.EPERM: "there is no right to",
}


def not_made(path: Path, error: OSError) -> DseError:
    """What to tell of *error*, which came of making the folder *path*: nothing is stored yet."""
    why = _WHY.get(error.errno or 0, error.strerror or str(error))
    return fail(f"the folder cannot be made: {why}", Location(str(path)), "name another folder with -o")


def refused(path: Path, error: OSError) -> DseError:
    """What to tell of *error*, which came of writing into the folder *path*."""
    why = _WHY.get(error.errno or 0, error.strerror or str(error))
    return fail(f"the folder cannot be written to: {why}", Location(str(path)), GO_ON)
