"""An executor over ``concurrent.futures``: the same few lines serve any pool with ``submit``, also of other machines.

Nothing watches its processes: an FMU that crashes breaks the pool and ends the study. Finished runs are stored, and the
same command goes on.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from itertools import islice
from multiprocessing import get_context
from typing import Any, ClassVar

from pydantic import Field

from dse.plugins import Batch, Carried, ExecutorSection, Sink, Work, carry_out, fail, hand_over, parcel

_TURN = 0.1
"""Seconds between two ticks of the sink at most."""


class Futures(ExecutorSection):
    """*workers* processes, each with a batch of runs at a time."""

    name: ClassVar[str] = "futures"
    examples: ClassVar[tuple[Mapping[str, Any], ...]] = ({"workers": 2},)

    workers: int = Field(default=2, ge=1)

    @contextmanager
    def open(self, work: Work, sink: Sink) -> Iterator[_Pool]:
        """The processes end with the block, after the batches they are at."""
        with ProcessPoolExecutor(self.workers, mp_context=get_context("spawn")) as processes:
            yield _Pool(processes, 2 * self.workers, work, sink)


class _Pool:
    retried = 0

    def __init__(self, processes: ProcessPoolExecutor, most: int, work: Work, sink: Sink) -> None:
        self._processes, self._most, self._work, self._sink = processes, most, work, sink

    def work_off(self, batches: Iterable[Batch]) -> None:
        todo = iter(batches)
        pending: dict[Future[Carried], Batch] = {}
        try:
            while True:
                for batch in islice(todo, self._most - len(pending)):
                    pending[self._processes.submit(carry_out, parcel(self._work, batch))] = batch
                if not pending:
                    return
                for future in wait(pending, _TURN, FIRST_COMPLETED).done:
                    hand_over(future.result(), pending.pop(future), self._work, self._sink)
                self._sink.tick()
        except BrokenProcessPool:
            what = "a process of the executor 'futures' died"
            raise fail(what, hint="finished runs are stored; the executor 'local' finds out which run it was") from None
        finally:
            for future in pending:
                future.cancel()
