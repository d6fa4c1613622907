"""Replicates: each run that a sampler asks for is made with several draws, and the sampler is told what they come to.

With `at_least` draws fewer than `at_most`, more are made for those runs of which a verdict is open: that a requirement
is met in the share of the draws that it must be met in can be neither said nor denied with the study's confidence
(`dse.domain.rates`). Of 5 draws that all met a requirement of 50 %, none more is made; of a requirement of
95 %, half as many again at a time, until 100 or so tell.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from dse.domain.bench import VERDICTS, Verdict
from dse.domain.definition import StudyDefinition
from dse.domain.noise import DRAW, draw_of
from dse.domain.rates import settled
from dse.domain.sampler import Brief, Candidate, Everywhere, Outcomes, Role, Search
from dse.domain.study import Replicates, Study
from dse.exploration.designs import joined
from dse.storage import groups_of, outcomes_over_draws, shares_of

Points = NDArray[np.float64]


def start_search(study: Study, brief: Brief, definition: StudyDefinition) -> Search:
    """The sampling of *study*, with its replicates if it has some; *brief* is of all its variables, the draw last."""
    if study.replicates is None:
        return study.sampler.start(brief)
    asked = replace(brief, variables=brief.variables[:-1], earlier=_earlier(brief.earlier, definition))
    return ReplicatedSearch(study, study.replicates, asked, definition)


def _earlier(outcomes: Outcomes, definition: StudyDefinition) -> Outcomes:
    names = np.unique(np.array(outcomes.configurations, dtype=np.str_), return_inverse=True)[1].reshape(-1)
    points = [values for name, values in outcomes.points.items() if name != DRAW]
    return outcomes_over_draws(outcomes, groups_of(np.column_stack([names, *points])), definition)


class ReplicatedSearch:
    """What the sampler of *study* asks for, each with several draws; *brief* is the one it is started with."""

    def __init__(self, study: Study, replicates: Replicates, brief: Brief, definition: StudyDefinition) -> None:
        self._inner = study.sampler.start(brief)
        self._replicates = replicates
        self._is_told = not study.once
        self._seed = brief.seed
        self._given = [k for k, variable in enumerate(brief.variables) if variable.role is not Role.DESIGN]
        self._definition = definition
        self._shares = np.array(shares_of(definition))
        self._asked: dict[Candidate, int] = {}
        self._order: list[int] = []
        self._counts: list[int] = []
        self._cells: NDArray[np.intp] = np.zeros(0, dtype=np.intp)
        self._made: list[tuple[NDArray[np.intp], Outcomes]] = []
        self._left: list[int] = []

    def ask(self) -> Sequence[Candidate]:
        """More draws of what is open; what the sampler asks for when nothing is."""
        if self._left:
            return self._more()
        candidates = self._inner.ask()
        first = self._replicates.at_least
        if isinstance(candidates, Everywhere) and not self._is_told:
            return Everywhere(self._drawn(candidates.points, 0, first), candidates.configurations)
        self._asked, self._order, self._made = {}, [], []
        for candidate in candidates:
            self._order.append(self._asked.setdefault(candidate, len(self._asked)))
        self._counts = [first] * len(self._asked)
        return self._with_draws([*self._asked], [(0, first)] * len(self._asked), range(len(self._asked)))

    def tell(self, outcomes: Outcomes) -> None:
        """The sampler is told when no verdict is open any more."""
        self._made.append((self._cells, outcomes))
        cells = np.concatenate([cells for cells, _ in self._made])
        whole = joined([made for _, made in self._made])
        self._left = self._open(whole, cells) if self._replicates.is_sequential else []
        if not self._left:
            merged = outcomes_over_draws(whole, cells, self._definition)
            self._inner.tell(_rows(merged, np.array(self._order, dtype=np.intp)))

    def _more(self) -> Sequence[Candidate]:
        least, most = self._replicates.at_least, self._replicates.at_most
        candidates, ranges = [*self._asked], []
        for cell in self._left:
            count = self._counts[cell]
            self._counts[cell] = min(most, count + max(least, count // 2))
            ranges.append((count, self._counts[cell]))
        return self._with_draws([candidates[cell] for cell in self._left], ranges, self._left)

    def _with_draws(
        self, candidates: Sequence[Candidate], ranges: Sequence[tuple[int, int]], cells: Sequence[int]
    ) -> list[Candidate]:
        asked: list[Candidate] = []
        numbers: list[int] = []
        for candidate, (first, end), cell in zip(candidates, ranges, cells, strict=True):
            points = self._drawn(np.array([candidate.point], dtype=np.float64), first, end)
            asked += [Candidate(candidate.configuration, tuple(point)) for point in points.tolist()]
            numbers += [cell] * (end - first)
        self._cells = np.array(numbers, dtype=np.intp)
        return asked

    def _drawn(self, points: Points, first: int, end: int) -> Points:
        """Each of *points*, (n, k), with the draws of the replicates *first* up to *end*, (n (end - first), k + 1)."""
        cases = points[:, self._given]
        group = groups_of(cases) if cases.shape[1] else np.zeros(len(points), dtype=np.intp)
        starts = np.unique(group, return_index=True)[1]
        base = np.array([draw_of(self._seed, cases[row].tolist(), 0) for row in starts.tolist()])
        draws = (base[group][:, None] + np.arange(first, end)).reshape(-1, 1)
        return np.column_stack([np.repeat(points, end - first, axis=0), draws])

    def _open(self, outcomes: Outcomes, cells: NDArray[np.intp]) -> list[int]:
        """The cells that need more draws, and may have them."""
        # What does not depend on the draw was made once, and stands here several times.
        count, random = len(self._asked), outcomes.points[DRAW] > 0
        is_open = np.zeros(count, dtype=np.bool_)
        for share, verdicts in zip(self._shares, outcomes.verdicts.values(), strict=True):
            codes = np.array([VERDICTS.index(verdict) for verdict in verdicts])
            met = np.bincount(cells, (codes == VERDICTS.index(Verdict.PASS)) & random, count)
            missed = np.bincount(cells, (codes == VERDICTS.index(Verdict.FAIL)) & random, count)
            judged = (met + missed).astype(np.int64)
            certain = settled(met.astype(np.int64), judged, share, self._replicates.confidence, sequential=True)
            is_open |= (judged > 0) & ~certain
        return [cell for cell in np.flatnonzero(is_open).tolist() if self._counts[cell] < self._replicates.at_most]


def _rows(outcomes: Outcomes, rows: NDArray[np.intp]) -> Outcomes:
    return Outcomes(
        tuple(outcomes.configurations[row] for row in rows.tolist()),
        {name: values[rows] for name, values in outcomes.points.items()},
        outcomes.done[rows],
        {name: values[rows] for name, values in outcomes.metrics.items()},
        {name: values[rows] for name, values in outcomes.margins.items()},
        {name: tuple(verdicts[row] for row in rows.tolist()) for name, verdicts in outcomes.verdicts.items()},
        {name: values[rows] for name, values in outcomes.totals.items()},
    )
