"""Runs that need not be made: another study, or this one before its files were changed, made them already."""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import groupby, islice
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dse.domain.address import Address
from dse.domain.run import RunRequest
from dse.domain.study import Keep, Study
from dse.errors import DseError, fail
from dse.exploration.work import Batch
from dse.storage import (
    FileFacts,
    Measures,
    RowBlock,
    RunStore,
    RunTable,
    StudyFolder,
    checked,
    gather_waveforms,
    this_process,
)

NOT_REPRODUCIBLE = "not reproducible: "
"""What is said of a run begins with it if it gave another result when it was made again."""

_PUT_EVERY = 1.0
_AT_ONCE = 50_000
_COLUMNS = ("numbers", "done", "metrics", "verdicts", "margins", "wall")


class KnownRuns:
    """What *store* has of the runs of a study, whose configurations have *addresses*; it is given what is new.

    *measures* are the study's, *kept* the names of what each configuration records, in its order. Only runs that came
    to their end are kept, as a failure may be the machine's. With *reads* False nothing is taken, with *writes* False
    nothing is given, and no file of waveforms is made.
    """

    def __init__(
        self,
        store: RunStore,
        addresses: Mapping[str, Address],
        measures: Measures,
        kept: Mapping[str, tuple[str, ...]],
        *,
        reads: bool = True,
        writes: bool = True,
    ) -> None:
        self.store = store
        self.addresses = dict(addresses)
        self._kept = dict(kept)
        self._reads = reads
        self._writes = writes
        self._counts = len(measures.metrics), len(measures.requirements)
        # In the store metrics and requirements are sorted: their order in a study does not matter.
        self._to_store = [np.argsort(np.array(names, dtype=np.str_), kind="stable") for names in _each(measures)]
        self._from_store = [np.argsort(order) for order in self._to_store]
        self._waiting: dict[str, list[tuple[list[RunRequest], RowBlock]]] = {}
        self._put = time.monotonic()

    def extend(self, addresses: Mapping[str, Address], kept: Mapping[str, tuple[str, ...]]) -> None:
        """Have the runs of more configurations, too: what names them, and which columns of theirs are kept."""
        self.addresses |= addresses
        self._kept |= kept

    def rows(self, requests: Iterable[RunRequest]) -> Iterator[tuple[list[RunRequest], RowBlock]]:
        """Those of *requests* of which there is a row, by configuration, with these rows."""
        for asked in _parts(requests):
            configuration = asked[0].configuration
            names = self._names(configuration, asked) if self._reads else None
            if names is None:
                continue
            at, block = self.store.find(self.addresses[configuration].entry, names, *self._counts)
            if len(at):
                there = [asked[row] for row in at.tolist()]
                numbers = np.array([request.number for request in there], dtype=np.int64)
                yield there, _numbered(_ordered(block, self._from_store), numbers)

    def add(self, batch: Batch, block: RowBlock) -> None:
        """Note runs of *batch* that were made just now. What another machine made stays with its study."""
        is_ours = not block.maker or _host(block.maker) == _host(this_process())
        if not self._writes or not is_ours or batch.configuration not in self.addresses:
            return
        requests = {request.number: request for request in batch.requests}
        made = [requests[number] for number in block.numbers.tolist()]
        self._waiting.setdefault(batch.configuration, []).append((made, block))
        if time.monotonic() - self._put > _PUT_EVERY:
            self.put()

    def withdraw(self, batch: Batch, number: int) -> None:
        """Run *number* of *batch* gave another result when it was made again."""
        names = self._names(batch.configuration, [r for r in batch.requests if r.number == number])
        if names is not None and self._writes:
            self.put()
            self.store.withdraw(self.addresses[batch.configuration].entry, names)

    def put(self) -> bool:
        """Give the store what is waiting; False if it cannot keep it."""
        waiting, self._waiting = self._waiting, {}
        done = True
        for configuration, added in waiting.items():
            block = _joined([block for _, block in added])
            fit = np.flatnonzero(block.done)
            requests = [request for made, _ in added for request in made]
            names = self._names(configuration, requests)
            if names is not None and len(fit):
                rows = _ordered(block.part(fit), self._to_store)
                done &= self.store.add(self.addresses[configuration].entry, names[fit], rows)
        self._put = time.monotonic()
        return done

    def make_file(self, batch: Batch, file: Path) -> bool:
        """Write the *file* of waveforms of *batch* from those that are there; False unless all of them are."""
        names = self._names(batch.configuration, batch.requests) if self._reads else None
        if names is None:
            return False
        places = [place for place in self.store.places(self.addresses[batch.configuration].entry, names) if place]
        if len(places) < len(names):
            return False
        try:
            if self._writes:
                gather_waveforms(file, batch.numbers, places, self._kept[batch.configuration])
        except DseError:
            return False
        return True

    def add_file(self, batch: Batch, kept: Sequence[int], file: Path, digest: str) -> None:
        """Note that the waveforms of the runs *kept* of *batch* are in *file*, which has this SHA-256."""
        there = set(kept)
        names = self._names(batch.configuration, [r for r in batch.requests if r.number in there])
        if names is not None and kept and self._writes:
            self.store.add_waveforms(self.addresses[batch.configuration].entry, names, sorted(there), file, digest)

    def _names(self, configuration: str, requests: Sequence[RunRequest]) -> NDArray[np.uint8] | None:
        address = self.addresses.get(configuration)
        if address is None or not requests:
            return None
        variables = tuple(requests[0].point)
        if any(name not in address.places for name in variables):
            return None
        points = np.array([tuple(request.point.values()) for request in requests], dtype=np.float64)
        return address.of(variables, points.reshape(len(requests), len(variables)))


def unsettled(folder: StudyFolder) -> set[int]:
    """Runs that failed, and those that gave another result when they were simulated again."""
    return folder.failed() | folder.with_problem(NOT_REPRODUCIBLE)


def forget_unsettled(folder: StudyFolder, study: Study) -> None:
    """Take away what is `unsettled`; if that is anything, also what was kept of runs near the boundary.

    Without the runs that failed, others were nearest to it.
    """
    gone = unsettled(folder)
    folder.forget(gone)
    if gone and study.keep is Keep.NEAR_BOUNDARY:
        folder.forget_kept()


def give(folder: StudyFolder, store: RunStore) -> None:
    """Give *store* all runs of *folder* that came to their end, with their waveforms. DseError if it cannot keep them.

    Those that were not reproducible are left out.
    """
    known = KnownRuns(store, folder.addresses(), folder.header.measures, {})
    files, facts = folder.kept(), folder.files()
    for block in folder.asks.blocks:
        for first in range(block.first, block.first + block.count, _AT_ONCE):
            _give(
                folder.table(range(first, min(first + _AT_ONCE, block.first + block.count))),
                known,
                files,
                facts,
                folder,
            )
    if not known.put():
        raise fail(f"the runs cannot be kept in {store.folder}", hint="set DSE_CACHE to a folder of yours with room")


def _give(
    table: RunTable,
    known: KnownRuns,
    files: Mapping[int, str],
    facts: Mapping[str, FileFacts],
    folder: StudyFolder,
) -> None:
    """Give the runs of *table*, all of one configuration."""
    fit = zip(table.requests(), table.done.tolist(), table.problems, strict=True)
    requests = tuple(r for r, done, said in fit if done and not said.startswith(NOT_REPRODUCIBLE))
    if not requests:
        return
    batch = Batch(0, requests[0].configuration, requests)
    there = {request.number for found, _ in known.rows(requests) for request in found}
    missing = [number for number in batch.numbers if number not in there]
    known.add(batch, table.block.part(np.searchsorted(table.numbers, missing)))
    for file, numbers in groupby(batch.numbers, key=lambda number: files.get(number, "")):
        now = checked(folder.waveform_folder / file, facts.get(file)) if file else None
        if now:
            known.add_file(batch, list(numbers), folder.waveform_folder / file, now.digest)


def _host(maker: str) -> str:
    return maker.rpartition("/")[0]


def _parts(requests: Iterable[RunRequest]) -> Iterator[list[RunRequest]]:
    """*requests* by configuration and number, not too many at once: as nouns, a million would take half a gigabyte."""
    left = iter(requests)
    while some := sorted(islice(left, _AT_ONCE), key=lambda r: (r.configuration, r.number)):
        yield from (list(group) for _, group in groupby(some, key=lambda r: r.configuration))


def _each(measures: Measures) -> tuple[tuple[str, ...], tuple[str, ...]]:
    return measures.metrics, measures.requirements


def _ordered(block: RowBlock, orders: Sequence[NDArray[np.intp]]) -> RowBlock:
    metrics, requirements = orders
    return replace(
        block,
        metrics=block.metrics[:, metrics],
        verdicts=block.verdicts[:, requirements],
        margins=block.margins[:, requirements],
    )


def _numbered(block: RowBlock, numbers: NDArray[np.int64]) -> RowBlock:
    named = dict(zip(block.numbers.tolist(), numbers.tolist(), strict=True))
    problems = {named[row]: problem for row, problem in block.problems.items()}
    return replace(block, numbers=numbers, problems=problems)


def _joined(blocks: Sequence[RowBlock]) -> RowBlock:
    columns: dict[str, Any] = {name: np.concatenate([getattr(block, name) for block in blocks]) for name in _COLUMNS}
    problems = {number: problem for block in blocks for number, problem in block.problems.items()}
    return replace(blocks[0], problems=problems, **columns)


NOTHING_KNOWN = KnownRuns(RunStore(Path()), {}, Measures(), {})
"""Has nothing and keeps nothing."""
