"""What went wrong, in the words of a user: one message for whatever it was."""

from __future__ import annotations

import errno
import os
import sys
from pathlib import Path

from dse.cli.streams import OutputError
from dse.errors import DseError, Location, fail, remedy

_HINT = "check that it exists, is of the right kind and that you may use it"


def in_words(error: BaseException) -> DseError:
    """What went wrong in the words of a user, whatever it was."""
    deleted = _deleted_folder()
    if deleted:
        return fail("the current folder was deleted", Location(deleted), "go to a folder that exists")
    if isinstance(error, DseError):
        return error
    if isinstance(error, OutputError):
        return fail(str(error))
    # What a library says that finds no room is no more than words.
    if isinstance(error, MemoryError) or (isinstance(error, ImportError) and "map segment" in str(error)):
        return fail("there is not enough memory", hint=remedy(errno.ENOMEM))
    if isinstance(error, SystemError):
        return fail(f"Python failed within itself: {error}", hint=remedy(errno.ENOMEM))
    if isinstance(error, RuntimeError) and str(error) == "can't start new thread":
        return fail("the system starts no more threads", hint=remedy(errno.EAGAIN))
    if isinstance(error, OSError) and error.errno is not None:
        where = Location(os.fsdecode(error.filename)) if isinstance(error.filename, str | bytes) else None
        return fail(error.strerror or str(error), where, remedy(error.errno, _HINT if where else ""))
    return _unforeseen(error)


def _deleted_folder() -> str:
    """The path of the working folder, if it is no more."""
    try:
        os.getcwd()  # noqa: PTH109  # nothing is made of it
    except FileNotFoundError:
        try:
            return os.readlink("/proc/self/cwd").removesuffix(" (deleted)")  # noqa: PTH115  # it is no path any more
        except OSError:
            return os.environ.get("PWD", ".")
    return ""


def _unforeseen(error: BaseException) -> DseError:
    """An error of ours: its place is told, the way it took is kept in a file for whoever reports it."""
    import traceback

    from dse.cache import cache_folder

    last = traceback.extract_tb(error.__traceback__)[-1:]
    place = "".join(f" ({Path(frame.filename).name}:{frame.lineno})" for frame in last)
    what = f"{type(error).__name__}: {error}{place}: this is a mistake in dse"
    story = f"{sys.argv}\n{sys.version}\n" + "".join(traceback.format_exception(error))
    file = cache_folder() / "mistake.txt"
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(story, encoding="utf-8", errors="backslashreplace")
    except OSError:
        return fail(what, hint=f"please report it with this:\n{story}")
    return fail(what, hint=f"please report it with the content of {file}")
