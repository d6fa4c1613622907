"""The command line: registers the commands, runs one, turns what went wrong into words and an exit code."""

from __future__ import annotations

import gc
import os
import sys
import warnings
from typing import Any

from dse.cache import CacheWarning
from dse.cli.answers import found_prepared, keep
from dse.cli.endings import DONE, WRONG_FILES, InterruptedCommandError
from dse.cli.signals import interrupt, stop_code, tidy_up
from dse.cli.streams import OutputError, silence
from dse.cli.terminal import print_line, show_problems

_python_shows = warnings.showwarning


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
    from dse.cli.mistakes import in_words

    show_problems(in_words(error))
    return WRONG_FILES


def _show_warning(message: Warning | str, category: type[Warning], *place: Any, **more: Any) -> None:
    """What was wrong with the cache is told as a note."""
    if issubclass(category, CacheWarning):
        print_line(f"note: {message}", stderr=True)
    else:
        _python_shows(message, category, *place, **more)
