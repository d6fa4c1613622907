"""Exploring: make the runs of a study that its folder does not have yet."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from collections.abc import Set as AbstractSet
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from dse.domain.study import Keep, Study
from dse.errors import fail
from dse.exploration.boundary import near_boundary
from dse.exploration.job import Batch, Bench, MakeExecutor, Setup
from dse.exploration.plan import missing_runs, missing_waveforms
from dse.exploration.progress import Meter, Progress, Stage
from dse.exploration.samplers import requests
from dse.exploration.supervisor import Supervisor
from dse.results.folder import StudyFolder
from dse.results.rows import RowBlock

_TELL_EVERY = 0.1


@dataclass(frozen=True, slots=True)
class Summary:
    """What came of an exploration.

    *runs* the study has, of which *failed*; *simulated* were made by this call, for the first time or again for
    their waveforms. *kept* have waveforms. *retried* were tried twice because their worker was killed from outside
    or grew too large over several runs, *irreproducible* gave another result the second time.
    """

    runs: int
    failed: int
    simulated: int
    kept: int
    retried: int
    irreproducible: int


class ExplorationInterruptedError(KeyboardInterrupt):
    """The user stopped the exploration; what was finished is stored. The message says so, and how to go on."""

    def __init__(self, finished: int, runs: int) -> None:
        super().__init__(
            f"stopped after {finished} of {runs} runs; they are stored: the same command goes on from there"
        )
        self.finished = finished
        self.runs = runs


def explore(
    study: Study,
    prepared: Mapping[str, Bench],
    folder: StudyFolder,
    *,
    workers: int,
    make_executor: MakeExecutor,
    on_progress: Callable[[Progress], None],
    threads: int = 1,
) -> Summary:
    """Simulate what is missing in *folder* with *workers* processes; *prepared* holds each configuration's bench.

    Each makes *threads* runs at once; where FMUs do not bear that, there are as many more processes instead. The
    results are the same, bit for bit.

    First every run that has no row. Waveforms are kept with them (`Keep.ALL`) or, for the runs near a boundary,
    by simulating these again, which must give the same bits. A finished folder is left as it is and no worker is
    started. Raises DseError if workers cannot work at all, ExplorationInterruptedError on Ctrl-C.
    """
    asked = requests(study, folder.header.configurations)
    if len(asked) != folder.header.runs:
        raise fail(f"the folder is for {folder.header.runs} runs, the study has {len(asked)}")
    header = folder.header
    setup = Setup(make_executor, Path(), folder.waveform_folder, header.metrics, header.requirements, threads)
    most = {name: bench.most_runs for name, bench in prepared.items() if bench.most_runs is not None}
    sink = _Sink(folder, on_progress)
    try:
        with Supervisor(setup, prepared, sink, workers) as supervisor:
            every = frozenset(range(len(asked)))
            if study.keep is Keep.ALL:
                wanted = every - folder.failed()
                sink.begin(Stage.RUNS, every, sink.finished & (folder.failed() | set(folder.kept())))
                supervisor.work_off(missing_waveforms(asked, wanted, folder.kept(), most))
            else:
                sink.begin(Stage.RUNS, every, sink.finished)
                supervisor.work_off(missing_runs(asked, sink.finished, most))
            if study.keep is Keep.NEAR_BOUNDARY:
                near, kept = near_boundary(study, folder.table()), folder.kept()
                sink.begin(Stage.WAVEFORMS, near, near & kept.keys())
                supervisor.work_off(missing_waveforms(asked, near, kept, most))
    except KeyboardInterrupt:
        raise ExplorationInterruptedError(len(folder.finished()), len(asked)) from None
    finally:
        folder.commit()
    sink.tell()
    kept_files = sum(bool(file) for file in folder.kept().values())
    return Summary(
        len(asked), len(sink.failed), sink.simulated, kept_files, supervisor.retried, len(sink.irreproducible)
    )


class _Sink:
    """Stores results, compares those that were there before, and counts."""

    def __init__(self, folder: StudyFolder, on_progress: Callable[[Progress], None]) -> None:
        self.finished = folder.finished()
        self.failed = folder.failed()
        self.simulated = 0
        self.irreproducible: set[int] = set()
        self._folder = folder
        self._on_progress = on_progress
        self.begin(Stage.RUNS, frozenset(), set())

    def begin(self, stage: Stage, wanted: frozenset[int], there: AbstractSet[int]) -> None:
        """Count what comes as *stage*, of whose *wanted* runs some are *there* already."""
        self._stage, self._wanted, self._there = stage, wanted, set(there)
        self._meter = Meter(len(there))
        self._told = 0.0

    def rows(self, batch: Batch, block: RowBlock) -> None:
        """Store the runs of *block* that are new, compare the others with what is stored."""
        numbers = block.numbers.tolist()
        fresh = np.array([number not in self.finished for number in numbers], dtype=np.bool_)
        if fresh.all():
            self._store(batch, block)
        else:
            self._store(batch, block.part(np.flatnonzero(fresh)))
            self._compare(block.part(np.flatnonzero(~fresh)))
        self.simulated += len(block)
        self._there.update(self._wanted.intersection(numbers))

    def ended(self, batch: Batch, kept: tuple[int, ...]) -> None:
        """Note which waveforms are there, and of which runs none ever will be."""
        if batch.keep:
            self._folder.add_kept(kept, batch.file)
            self._folder.add_kept([n for n in batch.numbers if n not in kept and n not in self.failed], "")

    def tick(self) -> None:
        """Commit and tell, each when it is time."""
        self._folder.commit_if_due()
        if time.monotonic() - self._told >= _TELL_EVERY:
            self.tell()

    def tell(self) -> None:
        """Tell how far it has come."""
        done = len(self._there)
        self._told = time.monotonic()
        self._on_progress(Progress(self._stage, done, len(self._wanted), len(self.failed), self._meter.rate(done)))

    def _store(self, batch: Batch, block: RowBlock) -> None:
        numbers = block.numbers.tolist()
        order = [batch.names.index(name) for name in self._folder.header.variables]
        by_number = dict(zip(batch.numbers, batch.points, strict=True))
        self._folder.add(batch.configuration, [[by_number[n][i] for i in order] for n in numbers], block)
        self.finished.update(numbers)
        self.failed.update(block.numbers[~block.done].tolist())

    def _compare(self, again: RowBlock) -> None:
        numbers = again.numbers.tolist()
        stored = self._folder.table(numbers).block
        for row in np.flatnonzero(again.differs_from(stored)).tolist():
            number = numbers[row]
            why = again.problems.get(number, "") if not again.done[row] else "another result"
            self._folder.set_problem(number, f"not reproducible: simulated again it gave {why}")
            self.irreproducible.add(number)
            if not again.done[row]:
                self._folder.add_kept((number,), "")
