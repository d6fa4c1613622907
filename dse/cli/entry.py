"""The console script: registers the commands, runs one, turns what went wrong into words and an exit code."""

from __future__ import annotations

import sys

from dse.cli.app import DONE, INTERRUPTED, WRONG_FILES, app, console, show_problems
from dse.cli.commands import register
from dse.errors import DseError


def main() -> None:
    """Run the command line; the console script ``dse``."""
    for stream in (sys.stdout, sys.stderr):
        # Windows and the C locale would refuse × and …; files and pipes are UTF-8 everywhere.
        if hasattr(stream, "reconfigure") and (stream.encoding or "").lower() != "utf-8":
            stream.reconfigure(encoding="utf-8")
    register()
    try:
        app()
    except DseError as error:
        show_problems(error)
        sys.exit(WRONG_FILES)
    except BrokenPipeError:
        # The reader of our output (head, less) has seen enough.
        sys.stderr.close()
        sys.exit(DONE)
    except KeyboardInterrupt as stop:
        # An interrupted exploration says what is stored and how to go on.
        console(stderr=True).print(str(stop) or "stopped", soft_wrap=True)
        sys.exit(INTERRUPTED)
