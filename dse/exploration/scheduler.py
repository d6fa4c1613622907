"""A study's sampler at work: it asks, each run it wants is given a number, and it is told what came of them.

A study that was stopped is taken up by doing that again from its first ask: what is there is not simulated, and the
sampler must ask for the same as before. In one that was extended, runs that are there keep their numbers.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import chain, groupby

import numpy as np
from numpy.typing import NDArray

from dse.domain.run import RunRequest
from dse.domain.sampler import Architectures, Brief, Candidate, Everywhere, Outcomes, Point
from dse.domain.study import Study
from dse.errors import DseError, Location, fail
from dse.exploration.one_shot_sampler import require_few
from dse.exploration.replicates import start_search
from dse.exploration.variables import allowing, conditions_of, once_each
from dse.storage import RunTable, StudyFolder
from dse.testbench import with_composites

_MOST_IDLE_ASKS = 100

Prepare = Callable[[Sequence[str]], None]
"""Has configurations, by their ids, ready to be simulated and known to the study's folder."""


class AskTellScheduler:
    """The asks of one *study*, which are noted in *folder*.

    *requests* holds every run that was asked for so far by its number, *asked* are the numbers of the last ask. A
    sampler that proposes configurations takes them from *space*, and has those it asks for *prepared*.
    """

    def __init__(
        self, study: Study, folder: StudyFolder, space: Architectures | None = None, prepare: Prepare | None = None
    ) -> None:
        header = folder.header
        self.asked: Sequence[int] = ()
        self._wanted: set[int] = set()
        self._study = study
        self._folder = folder
        self._prepare = prepare
        self._ready = set(header.definition.explored)
        self._nominal = np.array([variable.nominal for variable in study.variables])
        self._numbers: dict[tuple[str, Point], int] = {}
        self._made = 0
        self._idle = 0
        self._is_fresh = study.once and not header.base
        # Of a study that is asked once, and as a whole, nothing has to be compared.
        table = folder.table((-1,)) if self._is_fresh else folder.table()
        self._stored = {request.number: request for request in table.requests()}
        there = {number: request for number, request in self._stored.items() if number < header.base}
        for number, request in there.items():
            point = (request.point.get(name, low) for name, low in zip(header.variables, self._nominal, strict=True))
            self._numbers[request.configuration, tuple(map(float, point))] = number
        self.requests = Requests(header.variables, header.base, there)
        brief = Brief(
            study.variables,
            header.definition.explored,
            study.seed,
            self._outcomes(table, [*there]),
            space if study.sampler.proposes else None,
            study.objectives,
            conditions_of(study.variables),
            study.correlations,
            allowing(study.constraints, study.sampled),
        )
        self._search = start_search(study, brief, header.definition)

    def ask(self) -> bool:
        """Ask once more; False if the study is complete. DseError if the sampler asks for what no study can have."""
        if self._study.once and self._made:
            return False
        candidates = self._search.ask()
        if not len(candidates):
            if not self._made:
                raise self._refused("asks for no run at all")
            return False
        require_few(self.requests.end - self._folder.header.base + len(candidates), self._study.where)
        self._require_known(candidates)
        fresh = self._take(candidates)
        self._idle = 0 if fresh else self._idle + 1
        if self._idle > _MOST_IDLE_ASKS:
            raise self._refused(f"asked {self._idle} times in a row for runs that are there")
        # Of a study that is asked once and is new, every run is wanted: a set of them would take 60 bytes for each.
        wanted = len(self._wanted) or len(fresh)
        self._folder.ask(self._made, map(self.requests.__getitem__, fresh), wanted)
        self._made += 1
        return True

    def tell(self) -> None:
        """Tell the sampler what came of its last ask, all of whose runs are stored."""
        if not self._study.once:
            self._search.tell(self._outcomes(self._folder.table(sorted(set(self.asked))), self.asked))

    def _outcomes(self, table: RunTable, numbers: Sequence[int]) -> Outcomes:
        objectives = self._study.objectives
        totals = [name for objective in objectives for name in objective.totals]
        return with_composites(table.outcomes(numbers, totals), objectives, self._folder.header.definition)

    def _require_known(self, candidates: Sequence[Candidate]) -> None:
        whole = candidates.configurations if isinstance(candidates, Everywhere) else None
        names = dict.fromkeys(whole if whole is not None else (name for name, _ in candidates))
        new = [name for name in names if name not in self._ready]
        if new and self._prepare is None:
            raise self._refused(f"asks for the configuration '{new[0]}', which is not explored")
        if new and self._prepare is not None:
            self._prepare(new)
            self._ready.update(new)

    def _take(self, candidates: Sequence[Candidate]) -> range:
        """Give numbers to *candidates*; those that are new. DseError if there are rows of them that are other runs."""
        first = self.requests.end
        if isinstance(candidates, Everywhere) and self._is_fresh:
            self._check(candidates.points)
            for name in candidates.configurations:
                self.requests.append(name, once_each(self._settled(name, candidates.points)), self._has(name))
            self.asked = range(first, self.requests.end)
            return self.asked
        asked = []
        for name, points in _together(candidates, len(self._study.variables), self._refused):
            self._check(points)
            fresh: list[Point] = []
            for point in map(tuple, self._settled(name, points).tolist()):
                number = self._numbers.setdefault((name, point), self.requests.end + len(fresh))
                if number == self.requests.end + len(fresh):
                    fresh.append(point)
                asked.append(number)
            if fresh:
                self.requests.append(name, np.array(fresh).reshape(len(fresh), -1), self._has(name))
        self.asked = asked
        self._wanted.update(asked)
        for number in range(first, self.requests.end):
            if number in self._stored and self._stored[number] != self.requests[number]:
                what = f"the sampler asks for another run {number} than it did before"
                raise fail(what, Location(str(self._folder.path)), "explore into another folder, or use --fresh")
        return range(first, self.requests.end)

    def _has(self, configuration: str) -> NDArray[np.bool_]:
        """Which variables the configuration has."""
        return self._folder.header.has(configuration)

    def _settled(self, configuration: str, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """*points* with variables that the configuration does not have at their nominal values."""
        has = self._has(configuration)
        return points if has.all() else np.where(has, points, self._nominal)

    def _check(self, points: NDArray[np.float64]) -> None:
        for variable, values in zip(self._study.variables, points.T, strict=True):
            within = (values >= variable.low) & (values <= variable.high)
            if variable.values:
                within &= np.isin(values, variable.values)
            if not within.all():
                value = values[~within][0]
                among = "values" if variable.values else f"range {variable.low} … {variable.high}"
                raise self._refused(f"asks for {variable.name} = {value}, outside of its {among}")

    def _refused(self, what: str) -> DseError:
        return fail(f"the sampler '{self._study.sampler.name}' {what}", self._study.where)


def _together(
    candidates: Sequence[Candidate], variables: int, refused: Callable[[str], DseError]
) -> Iterator[tuple[str, NDArray[np.float64]]]:
    """*candidates* that follow each other with the same configuration."""
    for name, group in groupby(candidates, key=lambda candidate: candidate.configuration):
        points = [candidate.point for candidate in group]
        for point in points:
            if len(point) != variables:
                raise refused(f"asks for a point of {len(point)} values for {variables} variables")
        yield name, np.array(points, dtype=np.float64).reshape(len(points), variables)


# The runs that a study was asked for, by their numbers.


class Requests(Mapping[int, RunRequest]):
    """Runs with the variables *names* by number: *earlier* ones, and those from *base* on, as they are asked for.

    As nouns, a million of them would take half a gigabyte.
    """

    def __init__(self, names: tuple[str, ...], base: int, earlier: Mapping[int, RunRequest]) -> None:
        self.end = base
        """The number of the next one."""
        self._names = names
        self._base = base
        self._earlier = earlier
        self._firsts: list[int] = []
        self._blocks: list[tuple[str, NDArray[np.float64], tuple[tuple[int, str], ...]]] = []

    def __getitem__(self, number: int) -> RunRequest:
        if number < self._base:
            return self._earlier[number]
        if number >= self.end:
            raise KeyError(number)
        index = bisect_right(self._firsts, number) - 1
        configuration, points, columns = self._blocks[index]
        values = points[number - self._firsts[index]].tolist()
        return RunRequest(number, configuration, {name: values[column] for column, name in columns})

    def __iter__(self) -> Iterator[int]:
        return chain(self._earlier, range(self._base, self.end))

    def __len__(self) -> int:
        return len(self._earlier) + self.end - self._base

    def append(self, configuration: str, points: NDArray[np.float64], has: NDArray[np.bool_]) -> None:
        """Have *points*, (n, variables), on *configuration*, which *has* these of the variables, as the next runs."""
        columns = tuple((column, name) for column, name in enumerate(self._names) if has[column])
        self._firsts.append(self.end)
        self._blocks.append((configuration, points, columns))
        self.end += len(points)
