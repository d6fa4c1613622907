"""Any executor of ``concurrent.futures``, also of other machines: loky, mpi4py.futures, Parsl and others."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from concurrent.futures import Executor as Workers, Future
from contextlib import closing, contextmanager
from dataclasses import dataclass
from typing import ClassVar

from dse.errors import fail
from dse.exploration.executor import Pool
from dse.exploration.remote.dispatcher import Dispatcher
from dse.exploration.remote.messages import Answer
from dse.exploration.remote.worker import work_on
from dse.exploration.work import Sink, Work


@dataclass(frozen=True)
class FuturesExecutor:
    """Makes runs with *given*: workers, which are left as they are, or a function that makes them.

    *count* is how many there are, if they do not tell; 0 if they do.
    """

    name: ClassVar[str] = "futures"

    given: Workers | Callable[[], Workers]
    count: int = 0

    @contextmanager
    def open(self, work: Work, sink: Sink) -> Iterator[Pool]:
        """An FMU that crashes or hangs costs its run and nothing else; a worker that is killed, what it had."""
        with closing(_FuturesTransport(self.given, self.count)) as line, Dispatcher(line, work, sink) as pool:
            yield pool


class _FuturesTransport:
    """What breaks when a worker dies is made anew if it was made here."""

    def __init__(self, given: Workers | Callable[[], Workers], count: int) -> None:
        self._make = None if isinstance(given, Workers) else given
        self._workers = given if isinstance(given, Workers) else given()
        self._count = count

    def slots(self) -> int:
        """As many as it has workers."""
        return self._count or getattr(self._workers, "_max_workers", 0) or os.cpu_count() or 1

    def send(self, content: bytes, worker: str) -> Future[Answer]:
        """Whoever is free takes it."""
        del worker
        return self._workers.submit(work_on, content)

    def renew(self, error: BaseException) -> None:
        """Make another executor."""
        if self._make is None:
            what = f"the executor broke when a worker of it ended: {error or type(error).__name__}"
            hint = "finished runs are stored; give a function that makes executors, and the study resumes by itself"
            raise fail(what, hint=hint)
        self._workers.shutdown(wait=False, cancel_futures=True)
        self._workers = self._make()

    def close(self) -> None:
        """Shut down what was made here."""
        if self._make is not None:
            self._workers.shutdown(wait=True, cancel_futures=True)
