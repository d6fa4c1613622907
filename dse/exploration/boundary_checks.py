"""Runs near a boundary are made again with all that numerics could change: which verdicts hold, and which are doubtful.

Which these are follows from the finished study alone, and from the error bars found first: not from who makes them, nor
from how often that was stopped.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence, Set as AbstractSet
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from dse.domain.bench import VERDICTS, Verdict
from dse.domain.run import ERROR_BAR, VERDICTS_UNDER
from dse.domain.study import Study
from dse.exploration.batches import Chunks
from dse.exploration.executor import Executor
from dse.exploration.known_runs import NOT_REPRODUCIBLE, NOTHING_KNOWN, KnownRuns
from dse.exploration.loop import ExplorationInterruptedError
from dse.exploration.near_boundary import near_boundary
from dse.exploration.progress import Meter, Progress, Stage
from dse.exploration.variables import unit_of
from dse.exploration.work import Batch, MakeRunner, Runnable, Work
from dse.storage import Attempt, Checks, Measures, RowBlock, RunTable, StudyFolder, over_draws
from dse.testbench import make_runner

_TELL_EVERY = 0.1
_JUDGED = tuple(VERDICTS.index(verdict) for verdict in (Verdict.PASS, Verdict.FAIL))
_NO_RUN = float(1 << VERDICTS.index(Verdict.FAILED_TO_RUN))


@dataclass(frozen=True, slots=True)
class Checkable:
    """Configurations by id as they make error bars beside their runs, and what is known of such runs."""

    configurations: Mapping[str, Runnable]
    known: KnownRuns = NOTHING_KNOWN


def check_measures(measures: Measures) -> Measures:
    """What a run gives that is made again, of a study whose runs give *measures*."""
    bars = (f"{name}{ERROR_BAR}" for name in measures.metrics)
    under = (f"{name}{VERDICTS_UNDER}" for name in measures.requirements)
    return Measures((*measures.metrics, *bars, *under), measures.requirements)


def check_near_boundary(
    study: Study,
    explored: AbstractSet[str],
    folder: StudyFolder,
    checkable: Callable[[AbstractSet[str]], Checkable],
    *,
    executor: Executor,
    on_progress: Callable[[Progress], None] | None = None,
    make_runner: MakeRunner = make_runner,
) -> int:
    """Have *executor* make the runs of *folder* near a boundary again, and store what came of it; how many there are.

    The study is finished; of its configurations those *explored* can be made, and *checkable* gets them ready. Runs are
    made that have a neighbour with another verdict, and the one nearest to each bound; then those whose margin is no
    larger than the error that the nearest of these may have. A run that is checked already is not made again.

    Raises DseError as `explore` does, ExplorationInterruptedError on Ctrl-C.
    """
    table = over_draws(folder.table())
    can_be_made = frozenset(table.numbers[np.isin(np.array(table.configurations), sorted(explored))].tolist())
    first = (near_boundary(study, table, folder.header.slices) | _nearest(table)) & can_be_made
    checking = _Checking(folder, checkable, executor, make_runner, on_progress)
    try:
        checking.check(first)
        checking.check(first | (_small(study, over_draws(folder.table()), first) & can_be_made))
    except KeyboardInterrupt:
        raise ExplorationInterruptedError(len(folder.finished()), folder.header.runs) from None
    finally:
        folder.commit()
    folder.end()
    return len(folder.table().checks)


def _nearest(table: RunTable) -> frozenset[int]:
    """The run with the smallest margin to each bound, on whichever side."""
    found = set()
    for name in table.header.requirements:
        distance = np.where(_judged(table, name), np.abs(table.margins(name)), np.nan)
        if not np.isnan(distance).all():
            found.add(int(table.numbers[np.nanargmin(distance)]))
    return frozenset(found)


def _small(study: Study, table: RunTable, first: AbstractSet[int]) -> frozenset[int]:
    """Runs with a margin no larger than the error that the nearest runs of *first* may have in the same metric.

    These are of the same configuration if it has any, and as many as `near_boundary` compares.
    """
    rows = np.searchsorted(table.numbers, sorted(first))
    nearest = _nearest_of(rows, unit_of(table.coordinates(), study.sampled), np.array(table.configurations))
    found: set[int] = set()
    for requirement in table.header.definition.requirements:
        bars = table.errors(requirement.metric)
        errors = np.where(np.isfinite(bars), bars, -1.0)[nearest].max(axis=1, initial=-1.0)
        near = _judged(table, requirement.name) & (np.abs(table.margins(requirement.name)) <= errors)
        found.update(table.numbers[near].tolist())
    return frozenset(found)


def _nearest_of(rows: NDArray[np.intp], points: NDArray[np.float64], names: NDArray[np.str_]) -> NDArray[np.intp]:
    """For each of n *points* (n, d) the 2 d + 1 of *rows* that are nearest, (n, at most 2 d + 1)."""
    from scipy.spatial import cKDTree

    count = min(2 * points.shape[1] + 1, len(rows))
    found = np.zeros((len(points), count), dtype=np.intp)
    for name in dict.fromkeys(names.tolist()) if count else ():
        alike = rows[names[rows] == name]
        those = alike if len(alike) else rows
        # Where there are fewer, the first stands for the others.
        at = np.asarray(cKDTree(points[those]).query(points[names == name], k=np.arange(1, count + 1))[1])
        found[names == name] = those[np.where(at < len(those), at, at[:, :1])]
    return found


def _judged(table: RunTable, requirement: str) -> NDArray[np.bool_]:
    return np.isin(table.verdicts(requirement), _JUDGED)


class _Checking:
    """Makes runs of *folder* again, and is the sink of who does."""

    def __init__(
        self,
        folder: StudyFolder,
        checkable: Callable[[AbstractSet[str]], Checkable],
        executor: Executor,
        make_runner: MakeRunner,
        on_progress: Callable[[Progress], None] | None,
    ) -> None:
        self._folder = folder
        self._checkable = checkable
        self._executor = executor
        self._make_runner = make_runner
        self._on_progress = on_progress
        self._known = NOTHING_KNOWN
        self._there = set(folder.table().checks.numbers.tolist())
        self._meter, self._made, self._reported = Meter(0), 0, 0.0

    def check(self, numbers: AbstractSet[int]) -> None:
        """Check those runs of *numbers* that are not."""
        folder, self._wanted = self._folder, numbers
        missing = sorted(numbers - self._there)
        if not missing:
            return
        requests = {request.number: request for request in folder.table(missing).requests()}
        ready = self._checkable({request.configuration for request in requests.values()})
        self._known = ready.known
        for _, block in ready.known.rows(requests.values()):
            self._store(block)
        limits = {name: each.most_runs for name, each in ready.configurations.items()}
        work = Work(
            ready.configurations,
            self._make_runner,
            folder.waveform_folder,
            check_measures(folder.header.measures),
            folder.log_folder / "checks",
            f"{folder.header.fingerprint}-checks",
        )
        try:
            if left := numbers - self._there:
                with self._executor.open(work, self) as pool:
                    pool.work_off(Chunks(requests, folder.asks, limits.get).runs(left))
        finally:
            self._known.put()
            self._report()

    def rows(self, batch: Batch, block: RowBlock) -> None:
        """Store what came of some runs of *batch*."""
        self._made += len(block)
        self._known.add(batch, self._store(block))

    def tried(self, attempts: Sequence[Attempt]) -> None:
        """Store tries that gave no row."""
        self._folder.add_attempts(attempts)

    def ended(self, _batch: Batch, _kept: tuple[int, ...]) -> None:
        """No waveforms are kept."""

    def tick(self) -> None:
        """Commit and tell, each when it is time."""
        self._folder.commit_if_due()
        if time.monotonic() - self._reported >= _TELL_EVERY:
            self._report()

    def _report(self) -> None:
        self._reported = time.monotonic()
        if self._on_progress is not None:
            done, rate = len(self._there & self._wanted), self._meter.rate(self._made)
            self._on_progress(Progress(Stage.CHECKS, done, len(self._wanted), 0, rate))

    def _store(self, block: RowBlock) -> RowBlock:
        """Store the checks of *block*; those of its runs that came out as before."""
        block = block.part(np.argsort(block.numbers))
        before = self._folder.table(block.numbers.tolist()).block
        count = before.metrics.shape[1]
        differ = replace(block, metrics=block.metrics[:, :count]).differs_from(before)
        errors, under = block.metrics[:, count : 2 * count].copy(), block.metrics[:, 2 * count :].copy()
        errors[differ], under[differ] = np.nan, 0.0
        under[~block.done] = _NO_RUN
        numbers = block.numbers.tolist()
        problems = {
            number: _check_text(block.problems.get(number, ""), before.problems.get(number, ""), differs=other and done)
            for number, other, done in zip(numbers, differ.tolist(), block.done.tolist(), strict=True)
        }
        self._folder.add_checks(Checks(block.numbers, errors, under.astype(np.int64), problems))
        self._there.update(numbers)
        return block.part(np.flatnonzero(~differ))


def _check_text(problem: str, before: str, *, differs: bool) -> str:
    """What a check has to say beside what its run said *before*."""
    if differs:
        return f"{NOT_REPRODUCIBLE}simulated again it gave another result"
    return problem.removeprefix(before).removeprefix("; ")
