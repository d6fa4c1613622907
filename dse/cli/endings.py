"""How a command ends: its exit codes."""

from __future__ import annotations

DONE, WRONG_FILES, USAGE, RUNS_FAILED = 0, 1, 2, 3
"""Exit codes: done; the files are wrong; wrong usage; some runs failed, or a requirement under --gate."""


class InterruptedCommandError(Exception):
    """A command was stopped; says what became of it, if there is something to say."""
