"""The loop of an exploration: a sampler is asked, what its folder does not have yet is made, the sampler is told."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence, Set as AbstractSet
from dataclasses import dataclass
from functools import cache

import numpy as np

from dse.domain.run import RunRequest
from dse.domain.sampler import Architectures
from dse.domain.study import Keep, Shard, Study
from dse.errors import fail
from dse.exploration.batches import Chunks, Numbers
from dse.exploration.executor import Executor
from dse.exploration.known_runs import NOT_REPRODUCIBLE, NOTHING_KNOWN, KnownRuns
from dse.exploration.near_boundary import near_boundary
from dse.exploration.progress import Meter, Progress, Stage
from dse.exploration.repeat_check import Made, first_differences
from dse.exploration.scheduler import AskTellScheduler, Prepare
from dse.exploration.work import Batch, MakeRunner, Runnable, Work
from dse.storage import Attempt, DryRun, FileFacts, RowBlock, StudyFolder, over_draws
from dse.testbench import make_runner

_TELL_EVERY = 0.1

_MOST_TRACED = 3
"""Runs that came out otherwise the second time whose signals are compared."""


@dataclass(frozen=True, slots=True)
class Explored:
    """What an exploration did.

    *before* is how many runs the folder had, *runs* how many it has now, of which *failed*; with *extended* the study
    asks for other runs than before. *simulated* were made by this call, for the first time or again for their
    waveforms, *taken* were known; a few that were repeated only to compare are not counted. *kept* have waveforms.
    *retried* were tried twice, as the first time need not have been their fault; *irreproducible* gave another result
    the second time. The waveforms of *damaged* were gone, cut or changed. *remarks* are on who made them.
    """

    before: int
    runs: int
    failed: int
    simulated: int
    kept: int
    retried: int
    irreproducible: int
    extended: bool
    damaged: int = 0
    taken: int = 0
    remarks: tuple[str, ...] = ()

    @property
    def new(self) -> int:
        """How many runs were added."""
        return self.runs - self.before

    @property
    def again(self) -> int:
        """How many were simulated again for their waveforms."""
        return max(0, self.simulated - (self.new - self.taken))


class ExplorationInterruptedError(KeyboardInterrupt):
    """The user stopped the exploration; *finished* of *runs* runs are stored. The message states how to resume."""

    def __init__(self, finished: int, runs: int) -> None:
        super().__init__(
            f"stopped after {finished} of {runs} runs; they are stored: the same command resumes from there"
        )
        self.finished = finished
        self.runs = runs


def explore(
    study: Study,
    prepared: Mapping[str, Runnable],
    folder: StudyFolder,
    *,
    executor: Executor,
    on_progress: Callable[[Progress], None] | None = None,
    make_runner: MakeRunner = make_runner,
    known: KnownRuns = NOTHING_KNOWN,
    shard: Shard | None = None,
    space: Architectures | None = None,
    prepare: Prepare | None = None,
) -> Explored:
    """Have *executor* simulate what is missing in *folder*; *prepared* are the configurations by id.

    The study's sampler is asked, and asked again when the runs it wanted are there, until it wants no more. Waveforms
    are kept with the runs (`Keep.ALL`) or, for the runs near a boundary, by simulating these again, which must give the
    same bits. What is *known* is not simulated. A finished folder is left as it is and no worker is started. The
    results are the same with any executor, bit for bit. Of a *shard* only its runs are made, and none again for its
    waveforms: what is near a boundary is known when all shards are merged. A sampler that proposes configurations takes
    them from *space*; *prepare* adds those it asks for to *prepared*.

    Raises DseError if workers cannot work at all or end without a run, ExplorationInterruptedError on Ctrl-C.
    """
    header = folder.header
    work = Work(prepared, make_runner, folder.waveform_folder, header.measures, folder.log_folder, header.fingerprint)
    sink = _Sink(folder, on_progress, known)
    before = len(sink.finished)
    try:
        asking = AskTellScheduler(study, folder, space, prepare)
        # Of an extended study there may be runs of configurations that are not explored any more.
        most = cache(lambda name: prepared[name].most_runs if name in prepared else None)
        chunks = Chunks(asking.requests, folder.asks, most)
        with executor.open(work, sink) as pool:
            while asking.ask():
                asked = Numbers(chunks.part(asking.asked, shard) if shard else asking.asked)
                sink.take(asking.requests[number] for number in asked - sink.finished)
                keeps = study.keep is Keep.ALL
                there = asked & sink.finished & (sink.failed | sink.kept.keys() if keeps else asked)
                sink.begin(Stage.RUNS, asked, there)
                left = asked - there if there else asked
                pool.work_off(sink.unknown(chunks.waveforms(left, sink.kept)) if keeps else chunks.runs(left))
                if (lost := asked - sink.finished) and not isinstance(folder, DryRun):
                    what = f"the executor '{executor.name}' ended without {len(lost)} of the runs that it was given"
                    raise fail(what, hint="finished runs are stored: the same command resumes")
                asking.tell()
            if study.keep is Keep.NEAR_BOUNDARY and not shard:
                near = _near(study, folder, prepared)
                sink.begin(Stage.WAVEFORMS, near, near & sink.kept.keys())
                pool.work_off(sink.unknown(chunks.waveforms(near - sink.kept.keys(), sink.kept)))
            if repeats := list(sink.made.repeats(asking.requests)):
                sink.begin(Stage.REPEATS, {n for batch in repeats for n in batch.numbers}, set())
                pool.work_off(repeats)
            remarks = pool.remarks
        for number in sorted(sink.irreproducible)[:_MOST_TRACED]:
            request = asking.requests[number]
            bench = prepared[request.configuration]
            if where := first_differences(bench, request, executor, make_runner, header.measures):
                sink.add_to_problem(number, f"; the first to differ: {where}")
    except KeyboardInterrupt:
        raise ExplorationInterruptedError(len(folder.finished()), folder.header.runs) from None
    finally:
        known.put()
        folder.commit()
    folder.end()
    sink.tell()
    return Explored(
        before,
        len(sink.finished),
        len(sink.failed),
        sink.simulated,
        sum(bool(file) for file in sink.kept.values()),
        pool.retried,
        len(sink.irreproducible),
        folder.is_extended,
        len(folder.damaged),
        sink.taken,
        remarks,
    )


def _near(study: Study, folder: StudyFolder, prepared: Mapping[str, Runnable]) -> frozenset[int]:
    """Runs near a boundary that can be simulated: an extended study may have some of configurations it left."""
    table = over_draws(folder.table())
    here = np.array([name in prepared for name in table.configurations], dtype=np.bool_)
    return near_boundary(study, table, folder.header.slices) & frozenset(table.numbers[here].tolist())


class _Sink:
    """Stores results, compares those that were there before, and counts."""

    def __init__(self, folder: StudyFolder, on_progress: Callable[[Progress], None] | None, known: KnownRuns) -> None:
        self.finished = Numbers(folder.finished())
        self.failed = folder.failed()
        self.kept = dict(folder.kept())
        self.simulated = 0
        self.taken = 0
        self.irreproducible: dict[int, str] = {}
        self.made = Made()
        self._folder = folder
        self._known = known
        self._on_progress = on_progress
        self._stage: Stage | None = None

    def begin(self, stage: Stage, wanted: AbstractSet[int], there: AbstractSet[int]) -> None:
        """Count what comes as *stage*, of whose *wanted* runs some are *there* already; more of a stage adds to it."""
        if stage is not self._stage:
            self.tell()
            self._stage, self._meter, self._told = stage, Meter(self.simulated), 0.0
            self._wanted, self._there = Numbers(), Numbers()
        self._wanted.update(wanted)
        self._there.update(there)

    def take(self, requests: Iterable[RunRequest]) -> None:
        """Store those of *requests* that are known."""
        for there, block in self._known.rows(requests):
            self._store(there[0].configuration, there, block)
            self.taken += len(block)

    def unknown(self, batches: Iterable[Batch]) -> Iterator[Batch]:
        """Those of *batches* whose waveforms are not known; of the others the files are made."""
        for batch in batches:
            # Another study may have made them since it was asked for their rows.
            self.take(request for request in batch.requests if request.number not in self.finished)
            if all(number in self.finished for number in batch.numbers) and self._known.make_file(
                batch, self._folder.waveform_folder / batch.file
            ):
                self._keep(batch.numbers, batch.file)
                self._there.update(batch.numbers)
            else:
                yield batch

    def rows(self, batch: Batch, block: RowBlock) -> None:
        """Store the runs of *block* that are new, compare the others with what is stored."""
        numbers = block.numbers.tolist()
        fresh = np.array([number not in self.finished for number in numbers], dtype=np.bool_)
        new = block if fresh.all() else block.part(np.flatnonzero(fresh))
        self._store(batch.configuration, batch.requests, new)
        self._known.add(batch, new)
        self.made.add(batch.configuration, new)
        if new is not block:
            self._compare(batch, block.part(np.flatnonzero(~fresh)))
        self.simulated += len(block) * (self._stage is not Stage.REPEATS)
        self._there.update(number for number in numbers if number in self._wanted)

    def tried(self, attempts: Sequence[Attempt]) -> None:
        """Store tries that gave no row."""
        self._folder.add_attempts(attempts)

    def ended(self, batch: Batch, kept: tuple[int, ...]) -> None:
        """Note which waveforms are there, and of which runs none ever will be."""
        if batch.keep:
            facts = self._keep(kept, batch.file)
            self._there.update(number for number in kept if number in self._wanted)
            if facts:
                self._known.add_file(batch, kept, self._folder.waveform_folder / batch.file, facts.digest)
            self._keep([n for n in batch.numbers if n not in kept and n not in self.failed], "")
        self._folder.release(batch.name)

    def tick(self) -> None:
        """Commit and tell, each when it is time."""
        self._folder.commit_if_due()
        if time.monotonic() - self._told >= _TELL_EVERY:
            self.tell()

    def tell(self) -> None:
        """Tell how far it has come."""
        if self._stage is None or self._on_progress is None:
            return
        self._told = time.monotonic()
        done, rate = len(self._there), self._meter.rate(self.simulated)
        self._on_progress(Progress(self._stage, done, len(self._wanted), len(self.failed), rate))

    def add_to_problem(self, number: int, text: str) -> None:
        """Add *text* to what is said of a run that came out otherwise the second time."""
        self.irreproducible[number] += text
        self._folder.set_problem(number, self.irreproducible[number])

    def _keep(self, numbers: Sequence[int], file: str) -> FileFacts | None:
        if not numbers:  # of a chunk whose runs all failed there is no file
            return None
        self.kept |= dict.fromkeys(numbers, file)
        return self._folder.add_kept(numbers, file)

    def _store(self, configuration: str, requests: Sequence[RunRequest], block: RowBlock) -> None:
        numbers = block.numbers.tolist()
        points = {request.number: request.point for request in requests}
        names = self._folder.header.variables
        self._folder.add(configuration, [[points[n].get(name, math.nan) for name in names] for n in numbers], block)
        self.finished.update(numbers)
        self.failed.update(block.numbers[~block.done].tolist())

    def _compare(self, batch: Batch, again: RowBlock) -> None:
        numbers = again.numbers.tolist()
        self.made.compared += len(numbers)
        self._folder.add_attempts(
            [Attempt(number, again.maker, "", wall) for number, wall in zip(numbers, again.wall.tolist(), strict=True)]
        )
        stored = self._folder.table(numbers).block
        for row in np.flatnonzero(again.differs_from(stored)).tolist():
            number = numbers[row]
            why = again.problems.get(number, "") if not again.done[row] else "another result"
            self.irreproducible[number] = ""
            self.add_to_problem(number, f"{NOT_REPRODUCIBLE}simulated again it gave {why}")
            self._known.withdraw(batch, number)
            if not again.done[row]:
                self._keep((number,), "")
