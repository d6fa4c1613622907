"""A disk that refuses: what happened, in words, and that what was finished is safe."""

from __future__ import annotations

import errno
from pathlib import Path

from dse.errors import DseError, Location, Problem, fail, is_gone, remedy

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


class UnreadableError(DseError):
    """A file is there and the system does not give what is in it, which may be whole."""


def unreadable(what: str, file: Path, error: Exception, hint: str) -> DseError:
    """What to tell of *error*, which came of reading *file*: an UnreadableError if that says nothing of its bytes."""
    # Arrow's own errors of damaged files are OSErrors without a number.
    is_of_system = isinstance(error, OSError) and error.errno is not None and not is_gone(error)
    why = (isinstance(error, OSError) and error.strerror) or error
    kind = UnreadableError if is_of_system else DseError
    return kind(Problem(f"{what} cannot be read: {why}", Location(str(file)), remedy(getattr(error, "errno", 0), hint)))


def refused(path: Path, error: OSError) -> DseError:
    """What to tell of *error*, which came of writing into the folder *path*."""
    why = _WHY.get(error.errno or 0, error.strerror or str(error))
    return fail(f"the folder cannot be written to: {why}", Location(str(path)), GO_ON)
