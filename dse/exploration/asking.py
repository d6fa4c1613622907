"""A study's sampler at work: it asks, each run it wants is given a number, and it is told what came of them.

A study that was stopped is taken up by doing that again from its first ask: what is there is not simulated, and the
sampler must ask for the same as before. In one that was extended, runs that are there keep their numbers.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from dse.domain.bench import VERDICTS
from dse.domain.run import RunRequest
from dse.domain.sampler import Brief, Candidate, Outcomes, Point
from dse.domain.study import Study
from dse.errors import DseError, Location, fail
from dse.exploration.sampling import require_few
from dse.storage.folder import StudyFolder
from dse.storage.table import RunTable

_MOST_IDLE_ASKS = 100

Key = tuple[str, Point]
"""A run by its configuration and point."""


class Asking:
    """The asks of one *study*, which are noted in *folder*.

    *requests* holds every run that was asked for so far by its number, *asked* are the numbers of the last ask.
    """

    def __init__(self, study: Study, folder: StudyFolder) -> None:
        header = folder.header
        self.requests: dict[int, RunRequest] = {}
        self.asked: list[int] = []
        self._wanted: set[int] = set()
        self._study = study
        self._folder = folder
        self._names = header.variables
        self._numbers: dict[Key, int] = {}
        self._next = header.base
        self._made = 0
        self._idle = 0
        self._stored: RunTable | None = None
        if header.base or not study.sampler.once:
            self._stored = folder.table()
            for request in _requests(self._stored):
                if request.number < header.base:
                    self.requests[request.number] = request
                    self._numbers[request.configuration, _point(request)] = request.number
        table = folder.table((-1,)) if self._stored is None else self._stored
        earlier = _outcomes(table, list(self.requests))
        brief = Brief(study.variables, header.definition.explored, study.seed, earlier)
        self._search = study.sampler.start(brief)

    def ask(self) -> bool:
        """Ask once more; False if the study is complete. DseError if the sampler asks for what no study can have."""
        if self._study.sampler.once and self._made:
            return False
        candidates = self._search.ask()
        if not candidates:
            if not self._made:
                raise fail(f"the sampler '{self._study.sampler.name}' asks for no run at all", self._study.where)
            return False
        require_few(self._next - self._folder.header.base + len(candidates), self._study.where)
        self._check(candidates)
        fresh = self._take(candidates)
        self._idle = 0 if fresh else self._idle + 1
        if self._idle > _MOST_IDLE_ASKS:
            what = f"the sampler '{self._study.sampler.name}' asked {self._idle} times in a row for runs that are there"
            raise fail(what, self._study.where)
        self._folder.ask(self._made, fresh, len(self._wanted))
        self._made += 1
        return True

    def tell(self) -> None:
        """Tell the sampler what came of its last ask, all of whose runs are stored."""
        if not self._study.sampler.once:
            self._search.tell(_outcomes(self._folder.table(sorted(set(self.asked))), self.asked))

    def _take(self, candidates: Sequence[Candidate]) -> list[RunRequest]:
        """Give numbers to *candidates*; those that are new."""
        fresh = []
        self.asked = []
        for candidate in candidates:
            number = self._numbers.setdefault((candidate.configuration, candidate.point), self._next)
            if number == self._next:
                point = dict(zip(self._names, candidate.point, strict=True))
                fresh.append(RunRequest(number, candidate.configuration, point))
                self.requests[number] = fresh[-1]
                self._next += 1
            self.asked.append(number)
        self._wanted.update(self.asked)
        if self._stored is not None:
            self._compare(fresh)
        return fresh

    def _compare(self, fresh: Sequence[RunRequest]) -> None:
        """DseError if there are rows with the numbers of *fresh* that are other runs."""
        assert self._stored is not None  # noqa: S101  # asked before
        rows = np.flatnonzero(np.isin(self._stored.numbers, [request.number for request in fresh]))
        for stored in _requests(self._stored, rows.tolist()):
            if stored != self.requests[stored.number]:
                raise _unlike(self._folder, stored.number)

    def _check(self, candidates: Sequence[Candidate]) -> None:
        known = set(self._folder.header.definition.explored)
        ranges = [(v.low, v.high) for v in self._study.variables]
        for configuration, point in candidates:
            if configuration not in known:
                raise self._refused(f"the configuration '{configuration}', which is not explored")
            if len(point) != len(ranges):
                raise self._refused(f"a point of {len(point)} values for {len(ranges)} variables")
            for value, (low, high), name in zip(point, ranges, self._names, strict=True):
                if not (math.isfinite(value) and low <= value <= high):
                    raise self._refused(f"{name} = {value}, outside of its range {low} … {high}")

    def _refused(self, what: str) -> DseError:
        return fail(f"the sampler '{self._study.sampler.name}' asks for {what}", self._study.where)


def first_ask(study: Study, configurations: Sequence[str]) -> list[RunRequest]:
    """What *study* asks for first in a new folder, on *configurations*, numbered from 0."""
    names = [variable.name for variable in study.variables]
    none = np.zeros(0)
    nothing = Outcomes((), dict.fromkeys(names, none), none.astype(np.bool_), {}, {}, {})
    search = study.sampler.start(Brief(study.variables, tuple(configurations), study.seed, nothing))
    return [
        RunRequest(number, configuration, dict(zip(names, point, strict=True)))
        for number, (configuration, point) in enumerate(search.ask())
    ]


def _point(request: RunRequest) -> Point:
    return tuple(float(value) for value in request.point.values())


def _unlike(folder: StudyFolder, number: int) -> DseError:
    what = f"the sampler asks for another run {number} than it did before"
    return fail(what, Location(str(folder.path)), "explore into another folder, or say --fresh")


def _requests(table: RunTable, rows: Sequence[int] | None = None) -> list[RunRequest]:
    rows = range(len(table)) if rows is None else rows
    columns = {name: table.points[name].tolist() for name in table.header.variables}
    numbers = table.numbers.tolist()
    return [
        RunRequest(numbers[row], table.configurations[row], {name: column[row] for name, column in columns.items()})
        for row in rows
    ]


def _outcomes(table: RunTable, numbers: Sequence[int]) -> Outcomes:
    """What came of the runs of *numbers*, in this order."""
    rows = np.searchsorted(table.numbers, numbers) if len(table) else np.zeros(0, dtype=np.intp)
    header = table.header
    verdicts: Mapping[str, list[int]] = {name: table.verdicts(name)[rows].tolist() for name in header.requirements}
    return Outcomes(
        tuple(table.configurations[row] for row in rows.tolist()),
        {name: np.asarray(table.points[name], dtype=np.float64)[rows] for name in header.variables},
        table.done[rows],
        {name: table.metric(name)[rows] for name in header.metrics},
        {name: table.margins(name)[rows] for name in header.requirements},
        {name: tuple(VERDICTS[code] for code in codes) for name, codes in verdicts.items()},
    )
