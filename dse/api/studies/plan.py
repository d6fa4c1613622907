"""What exploring a study would do, and going on with a study whose files have changed."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from dse.cache import cache_folder
from dse.domain.address import Address
from dse.domain.component import Value
from dse.domain.run import RunRequest
from dse.domain.study import Shard, Study
from dse.exploration import Batch, KnownRuns, Sink, Work, explore, forget_unsettled, give
from dse.storage import DryRun, Measures, RunStore, StudyFolder, StudyHeader, changed_study
from dse.testbench import Prepared, PreparedStudy, address_of

_LOCAL = "local"


@dataclass(frozen=True, slots=True)
class Plan:
    """What exploring a study into a folder would do.

    The study asks for *runs* of *configurations*. *there* are in the folder and stay, *known* are taken from those that
    were made before, *missing* are simulated, of *simulated* configurations; *again* are simulated once more for their
    waveforms, as far as that can be told. With *open_ended* the sampler asks for more when it has seen the results.
    *changes* is what is not as it was when the folder was made, in words. *seconds* is how long it will take if runs
    take as long as those that were made before; None if nobody knows.
    """

    runs: int
    configurations: int
    there: int
    known: int
    missing: int
    simulated: int
    again: int
    open_ended: bool
    changes: tuple[str, ...]
    seconds: float | None


def known_runs(planned: PreparedStudy, *, reads: bool = True, writes: bool = True) -> KnownRuns:
    """What the cache has of the runs of *planned*."""
    kept = {name: bench.kept for name, bench in planned.benches.items()}
    measures = StudyHeader(planned.definition).measures
    return KnownRuns(_run_store(), _addresses(planned.benches), measures, kept, reads=reads, writes=writes)


def known_checks(benches: Mapping[str, Prepared], measures: Measures, *, reads: bool) -> KnownRuns:
    """What the cache has of runs of *benches* that give *measures*, error bars among them."""
    return KnownRuns(_run_store(), _addresses(benches), measures, {}, reads=reads)


def _addresses(benches: Mapping[str, Prepared]) -> dict[str, Address]:
    return {name: address for name, bench in benches.items() if (address := address_of(bench))}


def recall(planned: PreparedStudy, folder: Path) -> None:
    """Have *planned* prepare the configurations, too, that its sampler proposed when *folder* was made."""
    if planned.space is not None and StudyFolder.is_at(folder):
        with StudyFolder.open(folder) as stored:
            planned.recall([each.choices for each in stored.header.definition.configurations])


def on_demand(planned: PreparedStudy, store: StudyFolder, known: KnownRuns) -> Callable[[Sequence[str]], None] | None:
    """Has configurations that the sampler of *planned* proposes prepared; None if it has a list of them."""
    space = planned.space
    if space is None:
        return None

    def prepare(names: Sequence[str]) -> None:
        made = planned.add(space.configuration(name) for name in names if name not in planned.benches)
        addresses = _addresses(made)
        known.extend(addresses, {name: bench.kept for name, bench in made.items()})
        store.join(planned.definition)
        store.note_addresses(addresses)

    return prepare


def changes_since(folder: Path, planned: PreparedStudy, addresses: Mapping[str, Address]) -> tuple[str, ...]:
    """What of the files of a study changed since *folder* was made, in words; () if nothing that matters did.

    () also if *folder* is none, or holds something that cannot be gone on with: that is told when it is opened.
    """
    if not StudyFolder.is_at(folder):
        return ()
    with StudyFolder.open(folder) as stored:
        definition, there = stored.header.definition, stored.addresses()
    now = planned.definition
    if not definition.is_same_study(now) or any(each.id not in there for each in definition.configurations):
        return ()
    same = all(there[name].names_alike(address) for name, address in addresses.items() if name in there)
    if same and not definition.differences(now):
        return ()
    return tuple(changed_study(definition, now)) or ("the code that measures",)


def start_over(folder: Path) -> None:
    """Take all runs out of *folder* to where they are found again, and the study with them."""
    with StudyFolder.open(folder) as stored:
        definition = stored.header.definition
    # As its writer, so that what was finished and not stored when it was stopped is there, too.
    with StudyFolder.resume(folder, definition) as stored:
        give(stored, _run_store())
    StudyFolder.discard(folder)


def plan(
    planned: PreparedStudy,
    folder: Path,
    *,
    workers: int = 0,
    fresh: bool = False,
    retry_failed: bool = False,
    shard: Shard | None = None,
) -> Plan:
    """What exploring *planned* into *folder* would do. Nothing is simulated, and the folder is left as it is.

    Raises DseError as exploring would.
    """
    if not fresh:
        recall(planned, folder)
    known = known_runs(planned, reads=not (fresh or retry_failed), writes=False)
    changes = () if fresh else changes_since(folder, planned, known.addresses)
    before: dict[str, Address] = {}
    stay: set[tuple[str, tuple[Value, ...]]] = set()
    if changes:
        with StudyFolder.open(folder) as stored:
            give(stored, known.store)
            before = stored.addresses()
            alike = {name for name, address in known.addresses.items() if before.get(name) == address}
            stay = {_point(r) for r in stored.table().requests() if r.configuration in alike}
    rehearsed = folder / "nothing" if changes or fresh else folder
    counter = _Counter(planned.study)
    with DryRun.of(rehearsed, planned.definition) as scratch:
        if retry_failed:
            forget_unsettled(scratch, planned.study)
        there = scratch.finished()
        with suppress(_EnoughError):
            explore(
                planned.study,
                planned.benches,
                scratch,
                executor=counter,
                known=known,
                shard=shard,
                space=planned.space,
                prepare=on_demand(planned, scratch, known),
            )
        finished = scratch.finished()
        staying = sum(_point(request) in stay for request in scratch.table().requests()) if stay else 0
        runs, explored = scratch.header.runs, len(planned.definition.explored or planned.definition.configurations)
    todo = counter.requests
    missing = Counter(configuration for number, configuration in todo.items() if number not in finished)
    return Plan(
        runs=runs,
        configurations=explored,
        there=len(there) + staying,
        known=len(finished - there) - staying,
        missing=missing.total(),
        simulated=len(missing),
        again=len(todo) - missing.total(),
        open_ended=bool(todo) and not planned.study.once,
        changes=changes,
        seconds=_seconds(Counter(todo.values()), known, before, _at_once(planned.study, workers)),
    )


def _run_store() -> RunStore:
    return RunStore(cache_folder() / "runs")


def _point(request: RunRequest) -> tuple[str, tuple[Value, ...]]:
    return request.configuration, tuple(request.point.values())


class _EnoughError(Exception):
    """What the sampler asks for next depends on runs that are not there."""


class _Counter:
    """An executor that makes no run, and notes those it was to make: their configurations by number."""

    name: ClassVar[str] = "counter"
    remarks: tuple[str, ...] = ()

    def __init__(self, study: Study) -> None:
        self.requests: dict[int, str] = {}
        self.retried = 0
        self._once = study.once

    @contextmanager
    def open(self, _work: Work, _sink: Sink) -> Iterator[_Counter]:
        yield self

    def work_off(self, batches: Iterable[Batch]) -> None:
        for batch in batches:
            self.requests |= dict.fromkeys(batch.numbers, batch.configuration)
        if self.requests and not self._once:
            raise _EnoughError


def _at_once(study: Study, workers: int) -> int | None:
    """How many runs are made at a time; None if that is up to another executor than the local one."""
    given = study.executor
    if given.name != _LOCAL:
        return None
    return workers or int(given.options.get("workers", 0)) or os.cpu_count() or 1


def _seconds(todo: Counter[str], known: KnownRuns, before: Mapping[str, Address], at_once: int | None) -> float | None:
    """How long it takes to simulate so many runs of each configuration.

    A run takes as long as earlier ones of its configuration did, before it changed if need be; else as those of all.
    """
    if not todo:
        return 0.0
    if at_once is None:
        return None
    took = {name: known.store.seconds(address.entry) for name, address in known.addresses.items()}
    took |= {name: known.store.seconds(a.entry) for name, a in before.items() if not took.get(name, (0.0, 0))[1]}
    seconds, runs = (sum(column) for column in zip(*took.values(), strict=True)) if took else (0.0, 0)
    if not runs:
        return None
    means = {name: total / count for name, (total, count) in took.items() if count}
    return sum(count * means.get(name, seconds / runs) for name, count in todo.items()) / at_once
