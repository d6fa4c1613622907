"""What is still to be made: batches, and runs and configurations that get a second try.

What comes to nothing may be the fault of what was done to the process before, or of nobody here: only what a fresh
process comes to is a result, so that results do not depend on how runs fell to workers. Nothing is tried a third time.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import islice

from dse.exploration.failures import failed_run
from dse.exploration.work import Batch, Sink
from dse.storage import Attempt, Measures, block_of

_MOST_DRAWN = 1000
"""Batches that are ready at most: more than workers can take at once."""


@dataclass(slots=True)
class _Whole:
    """A *batch* that was split, of which so many *parts* are still to come."""

    batch: Batch
    parts: int


class WorkQueue:
    """Batches in the order they are made in, those for fresh processes apart. *sink* is told what workers cannot tell.

    Batches are taken from where they come only as they are needed: those of a million runs would take 400 MB.

    *retried* is how many runs got a second try.
    """

    def __init__(self, sink: Sink, measures: Measures) -> None:
        self.retried = 0
        self._sink = sink
        self._measures = measures
        self._source: Iterator[Batch] = iter(())
        self._pending: deque[Batch] = deque()
        self._again: deque[Batch] = deque()
        self._tried: set[int] = set()
        self._unloadable: set[str] = set()
        self._wholes: dict[int, _Whole] = {}

    def __len__(self) -> int:
        """How many batches there are, or so many that it makes no difference."""
        self._draw()
        return len(self._pending) + len(self._again)

    @property
    def wants_fresh(self) -> bool:
        """Whether something waits for a process that has made no run."""
        return bool(self._again)

    def fill(self, batches: Iterable[Batch]) -> None:
        """More is to be made; what was tried before counts no more."""
        self._tried.clear()
        self._source = iter(batches)

    def numbers(self) -> set[int]:
        """The runs that are to be made."""
        self._pending.extend(self._source)
        return {request.number for batch in self._pending for request in batch.todo}

    def take(
        self, *, fresh: bool, maker: str | None = None, loaded: str = "", others: Collection[str] = ()
    ) -> Batch | None:
        """What a process makes next that is *fresh* or not; None if there is nothing for it or for this *maker*.

        Loading a configuration takes as long as many runs: first comes what is of the one it has *loaded*, then what is
        of none that *others* have.
        """
        self._draw()
        queue = self._again if self._again and fresh else self._pending
        suits: tuple[Callable[[str], bool], ...] = (lambda c: c == loaded, lambda c: c not in others, lambda _: True)
        for is_next in suits:
            for place, batch in enumerate(queue):
                if batch.unlike != maker and is_next(batch.configuration):
                    del queue[place]
                    return batch
        return None

    def is_loaded(self, configuration: str) -> None:
        """A run of *configuration* has come back."""
        self._unloadable.discard(configuration)

    def try_again(self, rest: Batch, causes: Mapping[int, str], maker: str, seconds: float) -> None:
        """Have the runs of *rest* that *causes* names tried once more, each alone in a fresh process; then they failed.

        *maker* has tried for so many *seconds*. The others are passed on.
        """
        given_up = causes.keys() & self._tried
        for number in given_up:
            self._fail(rest, causes[number], number, seconds)
        doubtful = [number for number in causes if number not in given_up]
        self._sink.tried([Attempt(number, maker, causes[number], seconds) for number in doubtful])
        self._tried.update(doubtful)
        self.retried += len(doubtful)
        self._split(rest.after(given_up), doubtful)

    def load_again(self, rest: Batch, cause: str, maker: str, seconds: float) -> None:
        """Have the configuration of *rest* loaded once more by a fresh process; then all its runs have failed."""
        configuration = rest.configuration
        if configuration in self._unloadable and rest.fresh:
            for batch in [rest, *self._withdrawn(configuration)]:
                self._fail(batch, cause)
                self.pass_on(batch.after({*batch.numbers}))
            return
        self._sink.tried([Attempt(rest.todo[0].number, maker, cause, seconds)])
        self._unloadable.add(configuration)
        self._again.append(replace(rest, fresh=True))

    def pass_on(self, batch: Batch) -> None:
        """Have *batch* made next, by any worker, or nothing more if that is all there is to it."""
        if batch.todo or batch.makes_file:
            self._pending.appendleft(replace(batch, fresh=False))
        else:
            self.end(batch, ())

    def end(self, batch: Batch, kept: tuple[int, ...]) -> None:
        """Tell the sink that all of *batch* has come, or of what it was the last part of."""
        if not batch.part:
            self._sink.ended(batch, kept)
            return
        whole = self._wholes[batch.identity]
        whole.parts -= 1
        if not whole.parts:
            del self._wholes[batch.identity]
            self.pass_on(whole.batch.after({*whole.batch.numbers}))

    def _draw(self) -> None:
        self._pending.extend(islice(self._source, max(0, _MOST_DRAWN - len(self._pending))))

    def _withdrawn(self, configuration: str) -> list[Batch]:
        """What is still to be made of *configuration*, taken from the queues."""
        self._pending.extend(self._source)
        found = []
        for queue in (self._again, self._pending):
            found += [batch for batch in queue if batch.configuration == configuration]
            others = [batch for batch in queue if batch.configuration != configuration]
            queue.clear()
            queue.extend(others)
        return found

    def _split(self, batch: Batch, singles: Sequence[int]) -> None:
        """Have *singles* of *batch* made each on its own, by fresh processes, and pass on the rest."""
        if not singles:
            self.pass_on(batch)
            return
        parts = [replace(batch.only(number), alone=True, fresh=True) for number in singles]
        rest = replace(batch.after({*singles}), part=True)
        if not batch.part:
            self._wholes[batch.identity] = _Whole(batch, 1)
        self._wholes[batch.identity].parts += len(parts) - (not rest.todo)
        self._again.extend(parts)
        if rest.todo:
            self.pass_on(rest)

    def _fail(self, batch: Batch, problem: str, number: int | None = None, seconds: float = math.nan) -> None:
        """Tell the sink that the runs of *batch*, or the one with *number*, came to nothing."""
        runs = [failed_run(request, problem) for request in batch.todo if number in (None, request.number)]
        if runs:
            self._sink.rows(batch, block_of(runs, self._measures, [seconds] * len(runs)))
