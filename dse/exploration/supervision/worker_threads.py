"""The runs of a batch in one worker: one after the other, or several at once in threads.

Threads help where simulating leaves the interpreter's lock alone, as calls into C do.
"""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Iterator, Sequence
from queue import SimpleQueue

from dse.domain.run import Run
from dse.exploration.supervision.guarded_runner import GuardedRunner
from dse.exploration.work import Batch


def simulate(batch: Batch, runners: Sequence[GuardedRunner]) -> Iterator[tuple[Run, float]]:
    """The runs of *batch* as they are finished, each with the seconds it took.

    Ends early if the process must not make another run.
    """
    if len(runners) == 1 or batch.alone or len(batch.todo) == 1:
        return _in_turn(batch, runners[0])
    return _side_by_side(batch, runners)


def are_spent(runners: Sequence[GuardedRunner]) -> bool:
    """Whether the process must not make another run."""
    return any(runner.runs_left == 0 for runner in runners)


def _in_turn(batch: Batch, runner: GuardedRunner) -> Iterator[tuple[Run, float]]:
    end = time.perf_counter()
    for request in batch.todo:
        if are_spent((runner,)):
            return
        start = end
        run = runner.run(batch, request)
        if run is None:
            return
        end = time.perf_counter()
        yield run, end - start


def _side_by_side(batch: Batch, runners: Sequence[GuardedRunner]) -> Iterator[tuple[Run, float]]:
    todo = deque(batch.todo)
    finished: SimpleQueue[tuple[Run, float] | None] = SimpleQueue()

    def serve(runner: GuardedRunner) -> None:
        try:
            while not are_spent(runners):
                try:
                    request = todo.popleft()
                except IndexError:
                    break
                start = time.perf_counter()
                run = runner.run(batch, request)
                if run is None:
                    break
                finished.put((run, time.perf_counter() - start))
        finally:
            runner.rest()
            finished.put(None)

    threads = [threading.Thread(target=serve, args=(runner,), daemon=True) for runner in runners]
    for thread in threads:
        thread.start()
    at_work = len(threads)
    while at_work:
        result = finished.get()
        if result is None:
            at_work -= 1
        else:
            yield result
    for thread in threads:
        thread.join()
