"""Who makes the runs: this machine's processors, or something else behind the same few words."""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import AbstractContextManager
from typing import ClassVar, Protocol, cast

from dse.domain.study import ExecutorChoice
from dse.exploration.work import Batch, Sink, Work
from dse.loading import EXECUTORS


class Pool(Protocol):
    """Workers at hand, until they are let go."""

    @property
    def retried(self) -> int:
        """Runs that were made twice because the first time said nothing about them."""

    @property
    def remarks(self) -> tuple[str, ...]:
        """What the user should know of who made the runs; asked when all are made."""

    def work_off(self, batches: Iterable[Batch]) -> None:
        """Carry out *batches*; returns when each of their runs has been given to the sink.

        A run that fails is a row. DseError if the workers cannot work at all. What was given to the sink counts, even
        if this is interrupted.
        """


class Executor(Protocol):
    """A way to make runs, with its options; frozen. *name* is what it is found by."""

    name: ClassVar[str]

    def open(self, work: Work, sink: Sink) -> AbstractContextManager[Pool]:
        """A pool for *work* that gives *sink* what comes; leaving its with block ends the workers.

        The results must not depend on the executor: same runs, same bits.
        """


def load_executor(choice: ExecutorChoice) -> Executor:
    """The executor of a study. Raises DseError if it is not installed here."""
    # What else an executor has to be, its protocol says and the suite over all of them checks.
    return cast(Executor, EXECUTORS.get(choice.name).model_validate(choice.options))
