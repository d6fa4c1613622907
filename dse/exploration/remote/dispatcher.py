"""Sends work to workers elsewhere, about a second's worth at a time, and takes what comes.

However many runs a study has, only a few loads for each worker are on the way. A load whose worker ended is sent again;
if that ends a worker, too, it is sent in halves, down to the run that does it. Where all that is under way is lost at
once, as a pool of processes breaks that one of them left, nobody knows which load it was: then each is sent alone.
"""

from __future__ import annotations

import math
import pickle
import time
import uuid
from collections import deque
from collections.abc import Iterable, Sequence
from concurrent.futures import BrokenExecutor, CancelledError, Future, ThreadPoolExecutor
from contextlib import suppress
from dataclasses import replace
from queue import Empty, SimpleQueue

from dse.cache import cache_folder
from dse.errors import DseError, fail
from dse.exploration.failures import failed_run
from dse.exploration.packed_configuration import PackedConfiguration, Packer
from dse.exploration.remote.assignments import Assignment, BatchSplitter
from dse.exploration.remote.entries import digest_of_entry, sent
from dse.exploration.remote.machine import Machine, this_machine
from dse.exploration.remote.messages import (
    Answer,
    BatchResults,
    BatchRows,
    MissingEntries,
    WorkerError,
    WorkMessage,
    message_bytes,
)
from dse.exploration.remote.transport import Transport
from dse.exploration.remote.worker import dismiss, work_on
from dse.exploration.work import Batch, Sink, Work
from dse.storage import Attempt, RowBlock, block_of

MOST_DEATHS = 2
"""Workers that may end with a run alone before it is taken to be what ends them."""

MOST_FRUITLESS = 12
"""Loads that may come to nothing in a row before the exploration is given up."""

PATIENCE = 600.0
"""Seconds without any worker before the exploration is given up."""

_LOAD_SECONDS = 1.0
# A load costs coordinator and Dask scheduler some 5 ms each (docs/decisions/0019-other-machines.md).
_MOST_LOADS_PER_SECOND = 50
_LARGEST_LOAD = 1000
_DEPTH = 2
_TURN = 0.1
_SLOTS_EVERY = 2.0
_MOST_PACKED = 64
_CANARY = 1 << 50

_CANNOT = (ImportError, AttributeError, pickle.PickleError, TypeError)
"""What a worker raises that lacks what is needed to open a message."""


class Dispatcher:
    """A pool over a *line*. Use it in a with statement."""

    def __init__(self, line: Transport, work: Work, sink: Sink) -> None:
        self._line = line
        self._work = work
        self._sink = sink
        self._study = uuid.uuid4().hex
        self._done: SimpleQueue[Future[Answer]] = SimpleQueue()
        self._sent: dict[Future[Answer], Assignment] = {}
        self._again: deque[Assignment] = deque()
        self._packed: dict[str, PackedConfiguration] = {}
        self._packer = Packer()
        self._needs: dict[str, dict[str, str]] = {}
        self._digests: dict[str, str] = {}
        self._seconds = 0.0
        self._fruitless = 0
        self._retried: set[int] = set()
        self._retried_there = 0
        self._slots, self._asked = 0, -_SLOTS_EVERY
        self._last_worker = time.monotonic()
        self._canary: Batch | None = None
        self._here = ThreadPoolExecutor(1, thread_name_prefix="dse-canary")
        self._expected: Future[Answer] | None = None
        self._machines: set[Machine] = set()
        self._canaries: list[tuple[Machine, RowBlock]] = []

    @property
    def retried(self) -> int:
        """Runs that were made twice because the first time said nothing about them."""
        return len(self._retried) + self._retried_there

    @property
    def remarks(self) -> tuple[str, ...]:
        """Which machines give other bits than this one."""
        here = this_machine()
        found: dict[Machine, list[str]] = {m: [] for m in self._machines}
        for machine, reasons in found.items():
            if machine.bits != here.bits:
                reasons.append("exp, sin, pow and atan2")
        with suppress(CancelledError):
            expected = self._expected.result() if self._expected is not None else None
        if isinstance(expected, BatchResults) and expected.canary is not None:
            for machine, block in self._canaries:
                if block.differs_from(expected.canary).any():
                    found[machine].append(f"run {expected.canary.numbers[0]} of the study")
        return tuple(
            f"{machine} gives different bits than {here}: {', '.join(dict.fromkeys(reasons))}"
            for machine, reasons in sorted(found.items(), key=lambda entry: entry[0].host)
            if reasons
        )

    def work_off(self, batches: Iterable[Batch]) -> None:
        """Carry out *batches*; returns when each of their runs has been given to the sink.

        DseError if there are no workers for long, or they cannot work.
        """
        cutter = BatchSplitter(batches)
        self._last_worker = time.monotonic()
        try:
            while True:
                self._send(cutter)
                if not self._sent and not self._again:
                    return
                self._wait()
                self._sink.tick()
        finally:
            for future in self._sent:
                future.cancel()
            self._sent.clear()
            self._again.clear()

    def __enter__(self) -> Dispatcher:
        return self

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> None:
        self._here.shutdown(wait=error is None, cancel_futures=True)
        dismiss(self._study)

    def _send(self, cutter: BatchSplitter) -> None:
        most = max(1, _DEPTH * self._slots_now())
        while len(self._sent) < most and not any(load.alone for load in self._sent.values()):
            if self._again and self._again[0].alone and self._sent:
                return
            load = self._again.popleft() if self._again else cutter.load(self._size())
            if load is None:
                return
            try:
                future = self._line.send(message_bytes(self._message(load)), load.worker)
            except (BrokenExecutor, CancelledError) as error:
                self._again.appendleft(load)
                self._lost_all([], error)
                return
            self._sent[future] = load
            future.add_done_callback(self._done.put)

    def _size(self) -> int:
        """How many runs make a load: of a second, or as long as it takes to keep up with so many workers."""
        if not self._seconds:
            return 1
        return int(min(_LARGEST_LOAD, max(1, max(_LOAD_SECONDS, self._slots / _MOST_LOADS_PER_SECOND) / self._seconds)))

    def _slots_now(self) -> int:
        now = time.monotonic()
        if now - self._asked >= _SLOTS_EVERY:
            self._slots, self._asked = self._line.slots(), now
        if self._slots:
            self._last_worker = now
        elif now - self._last_worker > PATIENCE:
            what = f"no worker was there for {PATIENCE / 60:g} minutes"
            raise fail(what, hint="finished runs are stored: the same command resumes when there are workers")
        return self._slots

    def _wait(self) -> None:
        with suppress(Empty):
            future = self._done.get(timeout=_TURN)
            while True:
                if load := self._sent.pop(future, None):
                    self._take(load, future)
                future = self._done.get_nowait()

    def _take(self, load: Assignment, future: Future[Answer]) -> None:
        try:
            answer = future.result()
        except (BrokenExecutor, CancelledError) as error:
            self._lost(load, error)
        except DseError:
            raise
        except _CANNOT as error:
            hint = "install there what is installed here: dse, and the packages that add to it"
            raise fail(f"a worker cannot take up the work: {type(error).__name__}: {error}", hint=hint) from error
        except Exception as error:  # noqa: BLE001  # each kind of executor has its own for a worker that is gone
            self._worker_died(load, error)
        else:
            self._answered(load, answer)

    def _answered(self, load: Assignment, answer: Answer) -> None:
        match answer:
            case BatchResults() if sum(len(block) for piece in answer.pieces for block in piece.blocks) == len(
                load.numbers
            ):
                self._store(load, answer)
            case MissingEntries():
                had = load.configurations, load.entries
                load.configurations = tuple(sorted({*load.configurations, *answer.configurations}))
                load.entries = tuple(sorted({*load.entries, *answer.entries}))
                load.worker = answer.worker
                if had == (load.configurations, load.entries):
                    load.troubles += 1
                    self._count_fruitless("a worker does not find what it was sent", load.troubles > MOST_DEATHS)
                self._again.appendleft(load)
            case _:
                load.troubles += 1
                what = "a worker answers without some of its runs"
                if isinstance(answer, WorkerError):
                    what = f"{answer.host} cannot make runs: {answer.words}"
                self._count_fruitless(what, load.troubles > MOST_DEATHS)
                self._again.append(load)

    def _store(self, load: Assignment, carried: BatchResults) -> None:
        self._fruitless = 0
        self._retried_there += carried.retried
        self._machines.add(carried.machine)
        if carried.canary is not None:
            self._canaries.append((carried.machine, carried.canary))
        seconds = carried.seconds / len(load.numbers)
        self._seconds = (self._seconds + seconds) / 2 if self._seconds else seconds
        if carried.attempts:
            self._sink.tried(carried.attempts)
        for part, piece in zip(load.parts, carried.pieces, strict=True):
            part.job.take(part.batch, piece, self._work.waveforms, self._sink)

    def _lost(self, load: Assignment, error: BaseException) -> None:
        """All that was under way is lost."""
        if load.alone and not self._sent and isinstance(error, BrokenExecutor):
            self._worker_died(load, error)
            self._renew(error)
        else:
            self._lost_all([load], error)

    def _lost_all(self, lost: Sequence[Assignment], error: BaseException) -> None:
        words = str(error) or type(error).__name__
        self._count_fruitless(f"the line to the workers broke: {words}")
        for load in (*lost, *self._sent.values()):
            load.alone = load.alone or isinstance(error, BrokenExecutor)
            self._note(load, f"lost on the way: {words}")
            self._again.append(load)
        self._sent.clear()
        self._renew(error)

    def _note(self, load: Assignment, cause: str) -> None:
        self._retried.update(load.numbers)
        self._sink.tried([Attempt(number, "", cause, math.nan) for number in load.numbers])

    def _renew(self, error: BaseException) -> None:
        self._line.renew(error)
        self._asked = -_SLOTS_EVERY

    def _worker_died(self, load: Assignment, error: BaseException) -> None:
        words = str(error) or type(error).__name__
        self._count_fruitless(f"workers end with what they are given, the last: {words}")
        self._note(load, f"lost with its worker: {words}")
        load.deaths += 1
        if load.deaths < MOST_DEATHS:
            self._again.append(load)
        elif len(load.numbers) > 1:
            self._again.extend(load.halves())
        else:
            (part,) = load.parts
            (request,) = part.batch.requests
            block = block_of([failed_run(request, f"ended its worker twice: {words}")], self._work.measures)
            part.job.take(part.batch, BatchRows((block,)), self._work.waveforms, self._sink)

    def _count_fruitless(self, what: str, is_enough: bool = False) -> None:
        self._fruitless += 1
        if is_enough or self._fruitless >= MOST_FRUITLESS:
            raise fail(what, hint="finished runs are stored: the same command resumes")

    def _message(self, load: Assignment) -> WorkMessage:
        if self._canary is None:
            first = load.parts[0].batch
            self._canary = Batch(_CANARY, first.configuration, first.requests[:1])
            # Before anything is sent: what is needed of it here is known afterwards.
            here = replace(load, parts=(), configurations=(first.configuration,))
            self._expected = self._here.submit(work_on, message_bytes(self._sealable(here, self._canary)))
        return self._sealable(load, self._canary)

    def _sealable(self, load: Assignment, canary: Batch) -> WorkMessage:
        names = {part.batch.configuration for part in load.parts} | {canary.configuration}
        needs = {name: self._needs_of(name) for name in sorted(names)}
        return WorkMessage(
            self._study,
            tuple(part.batch for part in load.parts),
            self._work.make_runner,
            self._work.measures,
            needs,
            canary,
            {name: self._pack(name).content for name in load.configurations},
            {self._digests[entry]: sent(cache_folder().absolute() / entry) for entry in load.entries},
        )

    def _needs_of(self, name: str) -> dict[str, str]:
        if name not in self._needs:
            configuration = self._pack(name)
            if configuration.elsewhere:
                what = f"the configuration {name} needs {configuration.elsewhere[0]}, which only this machine has"
                raise fail(what, hint="the executor 'local' can make its runs")
            for entry in configuration.entries:
                if entry not in self._digests:
                    self._digests[entry] = digest_of_entry(cache_folder().absolute() / entry)
            self._needs[name] = {entry: self._digests[entry] for entry in configuration.entries}
        return self._needs[name]

    def _pack(self, name: str) -> PackedConfiguration:
        if name not in self._packed:
            while len(self._packed) >= _MOST_PACKED:
                del self._packed[next(iter(self._packed))]
            self._packed[name] = self._packer.pack(self._work.configurations[name])
        return self._packed[name]
