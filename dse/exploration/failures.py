"""Runs that came to nothing, and why, in words."""

from __future__ import annotations

import traceback
from pathlib import Path

from dse.domain.run import Outcome, Run, RunRequest
from dse.errors import DseError, fail
from dse.storage import Measures


def failed_run(request: RunRequest, problem: str) -> Run:
    """A run that came to nothing because of *problem*."""
    return Run(request, Outcome.FAILED, problem=problem)


def checked_run(run: Run, measures: Measures) -> Run:
    """*run* itself; LookupError if it came to its end without one of *measures*."""
    if run.outcome is Outcome.DONE:
        judged = {judgement.requirement for judgement in run.judgements}
        missing = {*measures.metrics} - {*run.metrics} or {*measures.requirements} - judged
        if missing:
            raise LookupError(f"the simulation gave no {', '.join(sorted(missing))}")
    return run


def not_stored(why: str) -> DseError:
    """The end of an exploration of which something could not be stored, *why* says what."""
    return fail(why, hint="finished runs are stored: the same command resumes when there is room")


def in_words(error: Exception) -> str:
    """What a run or a configuration failed of; what was not foreseen is printed, too."""
    if isinstance(error, DseError):
        return str(error)
    traceback.print_exception(error)
    frame = traceback.extract_tb(error.__traceback__)[-1]
    return f"unexpected {type(error).__name__} at {Path(frame.filename).name}:{frame.lineno}: {error}".rstrip(": ")
