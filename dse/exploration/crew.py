"""The runs of a batch on the seats of one worker: one after the other, or several at once in threads.

Threads help where simulating leaves the interpreter's lock alone, as calls into C do.
"""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Iterator, Sequence
from queue import SimpleQueue

from dse.domain.run import Run
from dse.exploration.job import Batch
from dse.exploration.seat import Seat


def simulate(batch: Batch, seats: Sequence[Seat]) -> Iterator[tuple[Run, float]]:
    """The runs of *batch* as they are finished, each with the seconds it took.

    Ends early if the process must not make another run.
    """
    if len(seats) == 1 or batch.alone or len(batch.numbers) == 1:
        return _in_turn(batch, seats[0])
    return _side_by_side(batch, seats)


def are_spent(seats: Sequence[Seat]) -> bool:
    """Whether the process must not make another run."""
    return any(seat.runs_left == 0 for seat in seats)


def _in_turn(batch: Batch, seat: Seat) -> Iterator[tuple[Run, float]]:
    end = time.perf_counter()
    for request in batch.requests():
        if are_spent((seat,)):
            return
        start = end
        run = seat.run(batch, request)
        if run is None:
            return
        end = time.perf_counter()
        yield run, end - start


def _side_by_side(batch: Batch, seats: Sequence[Seat]) -> Iterator[tuple[Run, float]]:
    todo = deque(batch.requests())
    finished: SimpleQueue[tuple[Run, float] | None] = SimpleQueue()

    def serve(seat: Seat) -> None:
        try:
            while not are_spent(seats):
                try:
                    request = todo.popleft()
                except IndexError:
                    break
                start = time.perf_counter()
                run = seat.run(batch, request)
                if run is None:
                    break
                finished.put((run, time.perf_counter() - start))
        finally:
            seat.rest()
            finished.put(None)

    threads = [threading.Thread(target=serve, args=(seat,), daemon=True) for seat in seats]
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
