"""The console script: registers the commands, runs one, turns what went wrong into words and an exit code."""

from __future__ import annotations

import gc
import os
import sys
import warnings
from typing import Any

from dse.cache import CacheWarning
from dse.cli.app import WRONG_FILES, app
from dse.cli.commands import register
from dse.cli.terminal import say, show_problems
from dse.errors import DseError, Location, fail

_python_shows = warnings.showwarning
_OUTPUT = "check that the folder exists, is a folder, has space and may be written"


def main() -> None:
    """Run the command line; the console script ``dse``."""
    for stream in (sys.stdout, sys.stderr):
        # Windows and the C locale would refuse × and …; files and pipes are UTF-8 everywhere.
        if hasattr(stream, "reconfigure") and (stream.encoding or "").lower() != "utf-8":
            stream.reconfigure(encoding="utf-8")
    # The shapes of our files need no plugin, and looking for one reads the metadata of every installed package.
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
    warnings.showwarning = _show_warning
    register(sys.argv[1:])
    # What a command reads and imports stays until its end: looking through it again and again is in vain.
    gc.set_threshold(50_000, 20, 20)
    try:
        app()
    except DseError as error:
        show_problems(error)
        sys.exit(WRONG_FILES)
    except OSError as error:
        show_problems(fail(error.strerror or str(error), Location(str(error.filename or "dse")), _OUTPUT))
        sys.exit(WRONG_FILES)


def _show_warning(message: Warning | str, category: type[Warning], *place: Any, **more: Any) -> None:
    """What was wrong with the cache is told as a note."""
    if issubclass(category, CacheWarning):
        say(f"note: {message}", stderr=True)
    else:
        _python_shows(message, category, *place, **more)
