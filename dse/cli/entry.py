"""The command line: registers the commands, runs one, turns what went wrong into words and an exit code."""

from __future__ import annotations

import errno
import gc
import os
import sys
import warnings
from pathlib import Path
from typing import Any

from dse.cache import CacheWarning
from dse.cli.answers import found_prepared, keep
from dse.cli.endings import DONE, WRONG_FILES, InterruptedCommandError
from dse.cli.signals import interrupt, stop_code, tidy_up
from dse.cli.streams import OutputError, silence
from dse.cli.terminal import print_line, show_problems
from dse.errors import DseError, Location, fail, remedy

_python_shows = warnings.showwarning

_HINT = "check that it exists, is of the right kind and that you may use it"


def run() -> None:
    """Run the command line in ``sys.argv`` and raise SystemExit."""
    try:
        code = _carry_out()
        if code == DONE:
            keep()
        tidy_up()
    except KeyboardInterrupt:  # while it was told what went wrong
        code = stop_code()
    gc.freeze()  # Python would look through all of it again at its end, which took a tenth of a short command
    sys.exit(code)


def _carry_out() -> int:
    try:
        # The shapes of our files need no plugin, and looking for one reads the metadata of every installed package.
        os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
        warnings.showwarning = _show_warning
        if (kept := found_prepared()) is None:
            from dse.cli.commands import register
            from dse.cli.completion import words

            register(sys.argv[1:] or words())
        # What a command reads and imports stays until its end: looking through it again and again is in vain.
        gc.set_threshold(50_000, 20, 20)
        interrupt()
        try:
            if kept is not None:
                from dse.cli.prepared import simulate_prepared

                return simulate_prepared(kept)
            from dse.cli.app import app

            app()
        finally:
            sys.stdout.flush()
    except SystemExit as end:
        if not stop_code():
            return int(end.code or DONE)
        said = ""
    except BaseException as error:  # noqa: BLE001  # one message for whatever it is
        if not stop_code():
            return _shown(error)
        said = str(error) if isinstance(error, InterruptedCommandError) else ""
    print_line(said or "stopped", stderr=True)
    return stop_code()


def _shown(error: BaseException) -> int:
    """Show what went wrong; the exit code it deserves."""
    if isinstance(error, OutputError):
        silence()
        if error.is_left:
            return DONE
    show_problems(_in_words(error))
    return WRONG_FILES


def _in_words(error: BaseException) -> DseError:
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


def _show_warning(message: Warning | str, category: type[Warning], *place: Any, **more: Any) -> None:
    """What was wrong with the cache is told as a note."""
    if issubclass(category, CacheWarning):
        print_line(f"note: {message}", stderr=True)
    else:
        _python_shows(message, category, *place, **more)
