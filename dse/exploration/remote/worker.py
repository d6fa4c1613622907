"""Executes messages where they arrive: each in a supervised process, so that no FMU takes the worker with it.

Such a process is kept for the next message of the same study, and let go when none has come for a while.
"""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Callable, Sequence
from functools import cache
from multiprocessing.util import Finalize
from pathlib import Path

from dse.errors import DseError
from dse.exploration.packed_configuration import unpacked
from dse.exploration.remote.entries import found, receive_entry
from dse.exploration.remote.machine import this_machine
from dse.exploration.remote.messages import (
    Answer,
    BatchResults,
    BatchRows,
    MissingEntries,
    WorkerError,
    WorkMessage,
    read_message,
)
from dse.exploration.supervision.supervisor import Supervisor
from dse.exploration.work import Batch, Runnable, Work
from dse.scratch import ScratchFolder
from dse.storage import Attempt, RowBlock, clear_log

IDLE_SECONDS = 60.0
"""How long a process waits for another message."""

_MOST_CONFIGURATIONS = 64

_lock = threading.Lock()
_idle: list[_Crew] = []


def work_on(content: bytes) -> Answer:
    """Make the runs of the message in *content*. A run that fails is a row, also if its FMU crashes or hangs.

    Raises DseError if the message was made by another version of dse or for another platform.
    """
    machine = this_machine()
    message = read_message(content, machine.host)
    try:
        crew = _taken(message)
        try:
            answer = crew.results_of(message)
        except BaseException as error:
            crew.close(error)
            raise
    except (DseError, OSError) as error:
        return WorkerError(machine.host, str(error))
    _let_go_later(crew)
    return answer


def dismiss(study: str) -> None:
    """Let the processes go that wait here for messages of *study*."""
    _let_go(lambda crew: crew.study == study)


def _taken(message: WorkMessage) -> _Crew:
    with _lock:
        for crew in _idle:
            if crew.study == message.study:
                _idle.remove(crew)
                return crew
    return _Crew(message)


def _let_go_later(crew: _Crew) -> None:
    _let_go_at_exit()
    with _lock:
        crew.idle_since = time.monotonic()
        _idle.append(crew)
    timer = threading.Timer(IDLE_SECONDS, _let_go, [lambda crew: crew.idle_since <= time.monotonic() - IDLE_SECONDS])
    timer.daemon = True
    timer.start()


def _let_go(is_leaving: Callable[[_Crew], bool]) -> None:
    with _lock:
        leaving = [crew for crew in _idle if is_leaving(crew)]
        _idle[:] = [crew for crew in _idle if crew not in leaving]
    for crew in leaving:
        crew.close()


@cache
def _let_go_at_exit() -> None:
    """Have processes that wait here end before this one does: a pool of processes would wait for them."""
    Finalize(None, _let_go, [lambda _: True], exitpriority=100)


class _Crew:
    """A process with its supervisor, for the messages of one study, one at a time."""

    def __init__(self, message: WorkMessage) -> None:
        self.study = message.study
        self.idle_since = 0.0
        self._folder = ScratchFolder()
        self._configurations: dict[str, Runnable] = {}
        self._sink = _Gathered(Path(self._folder.name))
        self._log = self._sink.folder / "spool"
        work = Work(self._configurations, message.make_runner, self._sink.folder, message.measures, self._log)
        self._supervisor = Supervisor(work, self._sink, workers=1)
        self._is_compared = False

    def results_of(self, message: WorkMessage) -> Answer:
        """What comes of *message*. DseError if the process cannot work at all."""
        batches = message.batches if self._is_compared else (message.canary, *message.batches)
        if missing := self._prepare({batch.configuration for batch in batches}, message):
            return missing
        retried, canary = self._supervisor.retried, None
        if not self._is_compared:
            self._is_compared, (canary,) = True, self._pieces((message.canary,))[0].blocks
        begun = time.perf_counter()
        pieces = self._pieces(message.batches)
        seconds, retried = time.perf_counter() - begun, self._supervisor.retried - retried
        return BatchResults(pieces, this_machine(), seconds, retried, tuple(self._sink.attempts), canary)

    def close(self, error: BaseException | None = None) -> None:
        """End the process."""
        try:
            self._supervisor.__exit__(type(error) if error else None, error, None)
        finally:
            self._folder.cleanup()

    def _pieces(self, batches: tuple[Batch, ...]) -> tuple[BatchRows, ...]:
        self._sink.begin(batches)
        self._supervisor.work_off(batches)
        # A supervisor does not make what the write-ahead log holds, and the same message may come again: its answer
        # can be lost.
        clear_log(self._log, {batch.name for batch in batches})
        return self._sink.pieces()

    def _prepare(self, names: set[str], message: WorkMessage) -> MissingEntries | None:
        """Have the configurations of *names* at hand; what is missing for that."""
        lacking, places, absent = [], {}, []
        for digest, content in message.entries.items():
            receive_entry(digest, content)
        for name in sorted(names - self._configurations.keys()):
            if name not in message.configurations:
                lacking.append(name)
            for place, digest in message.needs[name].items():
                path = found(place, digest)
                if path is None:
                    absent.append(place)
                else:
                    places[place] = path
        if lacking or absent:
            return MissingEntries(tuple(lacking), tuple(sorted(set(absent))), _address())
        for name in sorted(names - self._configurations.keys()):
            self._configurations[name] = unpacked(message.configurations[name], places)
        for name in list(self._configurations)[: max(0, len(self._configurations) - _MOST_CONFIGURATIONS)]:
            if name not in names:
                del self._configurations[name]
        return None


class _Gathered:
    """A sink that gathers what comes of batches; files of waveforms are read from *folder*, and not left there."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._owner: dict[int, int] = {}
        self._blocks: list[list[RowBlock]] = []
        self._kept: list[list[int]] = []
        self._files: list[list[bytes]] = []
        self.attempts: list[Attempt] = []

    def begin(self, batches: tuple[Batch, ...]) -> None:
        """From now on it is results of *batches* that come."""
        # By number: a supervisor may take a batch apart.
        self._owner = {number: i for i, batch in enumerate(batches) for number in batch.numbers}
        self._blocks = [[] for _ in batches]
        self._kept = [[] for _ in batches]
        self._files = [[] for _ in batches]
        self.attempts = []

    def pieces(self) -> tuple[BatchRows, ...]:
        """What came."""
        parts = zip(self._blocks, self._kept, self._files, strict=True)
        return tuple(BatchRows(tuple(blocks), tuple(sorted(kept)), tuple(files)) for blocks, kept, files in parts)

    def rows(self, batch: Batch, block: RowBlock) -> None:
        if len(block):
            self._blocks[self._owner[batch.numbers[0]]].append(block)

    def tried(self, attempts: Sequence[Attempt]) -> None:
        self.attempts += attempts

    def ended(self, batch: Batch, kept: tuple[int, ...]) -> None:
        if kept:
            file = self.folder / batch.file
            owner = self._owner[kept[0]]
            self._kept[owner] += kept
            self._files[owner].append(file.read_bytes())
            file.unlink()

    def tick(self) -> None:
        pass


def _address() -> str:
    """By what a scheduler could send something to this very worker; "" if it cannot."""
    if "distributed" in sys.modules:
        from distributed import get_worker

        try:
            return str(get_worker().address)
        except ValueError:
            return ""
    return ""
