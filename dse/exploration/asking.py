"""A study's sampler at work: it asks, each run it wants is given a number, and it is told what came of them.

A study that was stopped is taken up by doing that again from its first ask: what is there is not simulated, and the
sampler must ask for the same as before. In one that was extended, runs that are there keep their numbers.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import chain

from dse.domain.run import RunRequest
from dse.domain.sampler import Brief, Candidate, Point
from dse.domain.study import Study
from dse.errors import DseError, Location, fail
from dse.exploration.once_sampler import require_few
from dse.storage import StudyFolder

_MOST_IDLE_ASKS = 100


class Requests(Mapping[int, RunRequest]):
    """Runs with the variables *names* by number: *earlier* ones, and those from *base* on, as they are asked for.

    As nouns, a million of them would take half a gigabyte.
    """

    def __init__(self, names: tuple[str, ...], base: int, earlier: Mapping[int, RunRequest]) -> None:
        self._names = names
        self._base = base
        self._earlier = earlier
        self._candidates: list[Candidate] = []

    def __getitem__(self, number: int) -> RunRequest:
        if number < self._base:
            return self._earlier[number]
        if number >= self._base + len(self._candidates):
            raise KeyError(number)
        configuration, point = self._candidates[number - self._base]
        return RunRequest(number, configuration, dict(zip(self._names, point, strict=True)))

    def __iter__(self) -> Iterator[int]:
        return chain(self._earlier, range(self._base, self._base + len(self._candidates)))

    def __len__(self) -> int:
        return len(self._earlier) + len(self._candidates)

    def append(self, candidate: Candidate) -> None:
        """Have *candidate* as the next run."""
        self._candidates.append(candidate)


class Asking:
    """The asks of one *study*, which are noted in *folder*.

    *requests* holds every run that was asked for so far by its number, *asked* are the numbers of the last ask.
    """

    def __init__(self, study: Study, folder: StudyFolder) -> None:
        header = folder.header
        self.asked: list[int] = []
        self._wanted: set[int] = set()
        self._study = study
        self._folder = folder
        self._names = header.variables
        self._numbers: dict[tuple[str, Point], int] = {}
        self._next = header.base
        self._made = 0
        self._idle = 0
        is_fresh = study.sampler.once and not header.base
        # Of a study that is asked once, and as a whole, nothing has to be compared.
        table = folder.table((-1,)) if is_fresh else folder.table()
        self._stored = {request.number: request for request in table.requests()}
        there = {number: request for number, request in self._stored.items() if number < header.base}
        for number, request in there.items():
            self._numbers[request.configuration, tuple(map(float, request.point.values()))] = number
        self.requests = Requests(header.variables, header.base, there)
        earlier = table.outcomes(list(self.requests))
        self._search = study.sampler.start(Brief(study.variables, header.definition.explored, study.seed, earlier))

    def ask(self) -> bool:
        """Ask once more; False if the study is complete. DseError if the sampler asks for what no study can have."""
        if self._study.sampler.once and self._made:
            return False
        candidates = self._search.ask()
        if not candidates:
            if not self._made:
                raise self._refused("asks for no run at all")
            return False
        require_few(self._next - self._folder.header.base + len(candidates), self._study.where)
        self._check(candidates)
        fresh = self._take(candidates)
        self._idle = 0 if fresh else self._idle + 1
        if self._idle > _MOST_IDLE_ASKS:
            raise self._refused(f"asked {self._idle} times in a row for runs that are there")
        self._folder.ask(self._made, map(self.requests.__getitem__, fresh), len(self._wanted))
        self._made += 1
        return True

    def tell(self) -> None:
        """Tell the sampler what came of its last ask, all of whose runs are stored."""
        if not self._study.sampler.once:
            self._search.tell(self._folder.table(sorted(set(self.asked))).outcomes(self.asked))

    def _take(self, candidates: Sequence[Candidate]) -> range:
        """Give numbers to *candidates*; those that are new. DseError if there are rows of them that are other runs."""
        first = self._next
        self.asked = []
        for candidate in candidates:
            number = self._numbers.setdefault(candidate, self._next)
            if number == self._next:
                self.requests.append(candidate)
                if number in self._stored and self._stored[number] != self.requests[number]:
                    what = f"the sampler asks for another run {number} than it did before"
                    raise fail(what, Location(str(self._folder.path)), "explore into another folder, or say --fresh")
                self._next += 1
            self.asked.append(number)
        self._wanted.update(self.asked)
        if self._study.sampler.once:
            self._numbers.clear()
        return range(first, self._next)

    def _check(self, candidates: Sequence[Candidate]) -> None:
        known = set(self._folder.header.definition.explored)
        ranges = [(v.low, v.high) for v in self._study.variables]
        for configuration, point in candidates:
            if configuration not in known:
                raise self._refused(f"asks for the configuration '{configuration}', which is not explored")
            if len(point) != len(ranges):
                raise self._refused(f"asks for a point of {len(point)} values for {len(ranges)} variables")
            for value, (low, high), name in zip(point, ranges, self._names, strict=True):
                if not (math.isfinite(value) and low <= value <= high):
                    raise self._refused(f"asks for {name} = {value}, outside of its range {low} … {high}")

    def _refused(self, what: str) -> DseError:
        return fail(f"the sampler '{self._study.sampler.name}' {what}", self._study.where)
