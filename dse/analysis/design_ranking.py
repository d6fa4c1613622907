"""Which designs of a study are best, and what would have to change for another one to win."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from dse.analysis.data import Floats, Rows
from dse.analysis.order import DesignOrder, design_order, significant
from dse.domain.definition import DefinedRequirement, StudyDefinition
from dse.domain.sampler import Objective, Outcomes, Role
from dse.errors import closest, fail
from dse.exploration import Designs, design_variable, designs_of, equal_rows, front_of, knee
from dse.storage import CERTAINTIES, Certainty, RunTable
from dse.testbench import compile_objective, with_composites

_ROUNDED = 1e-3
"""The largest relative change of a bound when it is rounded outwards for a sentence."""


@dataclass(frozen=True, slots=True)
class Missed:
    """A *requirement* that a design does not meet: *worst* is its metric's value (SI) in the worst run, which would be
    the bound to meet; None if no run exercised it."""

    requirement: str
    worst: float | None = None


@dataclass(frozen=True, slots=True)
class Standing:
    """A design: a configuration with values (SI) for the design variables that it has.

    *values* are its objectives (SI) at the condition where they are worst, *margins* (SI) by requirement those of its
    worst run that exercised it; *runs* are the numbers of its runs, of which *failed* failed to run. It *is_whole* if
    it was run at all conditions. Verdicts on the requirements *doubtful* may be others with finer
    numerics, in some run. *slack* is the least of the margins as a share of its scale (`dse.analysis.slack`): infinite
    where no requirement was exercised. *at* are, for each objective, the conditions (SI) where it is worst; none of a
    sum of properties, and where all are alike.
    """

    configuration: str
    point: Mapping[str, float]
    values: tuple[float, ...]
    margins: Mapping[str, float]
    runs: tuple[int, ...]
    missed: tuple[Missed, ...] = ()
    failed: int = 0
    is_whole: bool = True
    doubtful: tuple[str, ...] = ()
    slack: float = np.inf
    at: tuple[Mapping[str, float], ...] = ()


@dataclass(frozen=True, slots=True)
class Ranking:
    """Designs under *objectives*, of *designs* in all that were run.

    *best* are feasible ones, in the order of `dse.analysis.order`; of several objectives those that no other one beats
    in all, by the first objective, with the place of the *knee*. *better* are such as would be among the best if
    requirements were others, in the same order. *feasible* is how many are; *open* were not run at all conditions, and
    failed nothing so far.
    """

    objectives: tuple[Objective, ...]
    best: tuple[Standing, ...]
    better: tuple[Standing, ...]
    designs: int
    feasible: int
    open: int
    knee: int | None = None


def objectives_of(definition: StudyDefinition, minimize: Sequence[str], maximize: Sequence[str]) -> list[Objective]:
    """The objectives that are asked for, else those of the study. Raises DseError for what the study does not know."""
    wanted = [*((text, False) for text in minimize), *((text, True) for text in maximize)]
    if not wanted:
        return [Objective(each.name, each.maximize, each.is_total, each.is_composite) for each in definition.objectives]
    metrics = [metric.name for metric in definition.metrics if not metric.error_of]
    totals = list(dict.fromkeys(name for each in definition.configurations for name in each.totals))
    found = []
    for text, largest in wanted:
        inner = text.strip().removeprefix("sum(").removesuffix(")").strip()
        composite = Objective(text.strip(), largest, is_composite=True)
        if text.strip().startswith("sum(") and inner in totals:
            found.append(Objective(inner, largest, is_total=True))
        elif text.strip() in metrics:
            found.append(Objective(text.strip(), largest))
        elif not composite.is_expected and text.strip().replace("(", "").replace(")", "").isidentifier():
            known = [*metrics, *(f"sum({name})" for name in totals)]
            raise fail(f"the study has neither a metric nor a sum '{text.strip()}'", None, closest(text, known))
        else:
            found.append(composite)
            compile_objective(composite, definition)
    return found


def ranked(table: RunTable, objectives: Sequence[Objective], number: int) -> Ranking:
    """The *number* best designs of *table* under one objective or none, or the front of several."""
    outcomes, designs, values, order = ordered(table, objectives)
    signs = np.array([-1.0 if each.maximize else 1.0 for each in objectives])
    is_open = ~order.is_whole & (designs.failed == 0) & ~designs.failing.any(axis=1)
    feasible = designs.feasible & ~is_open & ~np.isnan(values).any(axis=1)
    in_order = order.first_to_last
    first = list(islice((row for row in in_order if feasible[row]), number))
    chosen = _front(values, feasible) if len(objectives) > 1 else first
    variables = table.header.definition.variables
    standing = _Reader(table, designs, [v.name for v in variables if v.role == Role.DESIGN])
    standing.measured = [
        None if each.is_total else sign * np.asarray(outcomes.metrics[each.name])
        for sign, each in zip(signs.tolist(), objectives, strict=True)
    ]
    best = tuple(replace(standing.of(row), slack=float(order.slack[row])) for row in chosen)
    ahead = chosen if objectives else []
    rivals = ~is_open & (designs.failed == 0) & ~np.isnan(values).any(axis=1)
    behind = {*_better(values, designs, ahead, rivals)}
    better = (
        (n, replace(standing.of(n), is_whole=bool(order.is_whole[n]), slack=float(order.slack[n])))
        for n in in_order
        if n in behind
    )
    winning = (one for n, one in better if standing.is_one_sided(n) and _wins(values, designs, n, one, rivals))
    return Ranking(
        tuple(objectives),
        best,
        tuple(islice(winning, number)),
        len(designs),
        int(feasible.sum()),
        int(is_open.sum()),
        knee([(signs * one.values).tolist() for one in best]) if len(objectives) > 1 else None,
    )


def ordered(table: RunTable, objectives: Sequence[Objective]) -> tuple[Outcomes, Designs, Floats, DesignOrder]:
    """What came of the runs of *table*; its designs, their objectives, (n, m), to be small, and their order."""
    definition = table.header.definition
    totals = [name for each in objectives for name in each.totals]
    outcomes = with_composites(table.outcomes(table.numbers.tolist(), totals), objectives, definition)
    designs = designs_of(outcomes, tuple(map(design_variable, definition.variables)), objectives)
    signs = np.array([-1.0 if each.maximize else 1.0 for each in objectives])
    values = significant(signs * designs.objectives)
    return outcomes, designs, values, design_order(table, designs.rows, values)


class _Reader:
    """Reads designs of *table* one by one."""

    def __init__(self, table: RunTable, designs: Designs, decided: Sequence[str]) -> None:
        self._table, self._designs, self._decided = table, designs, decided
        self._requirements = {entry.name: entry for entry in table.header.definition.requirements}
        variables = table.header.definition.variables
        self._conditions = [n for n, variable in enumerate(variables) if variable.role == Role.CONDITION]
        self.measured: list[NDArray[np.float64] | None] = []
        """Each objective of every run, to be minimized; None for a sum of properties."""
        unsure = CERTAINTIES.index(Certainty.DOUBTFUL)
        self._doubtful = {
            name: table.certainties(name) == unsure for name in self._requirements if table.has_certainties
        }

    def of(self, row: int) -> Standing:
        """Design number *row*."""
        designs, header = self._designs, self._table.header
        configuration = designs.configurations[row]
        has = dict(zip(header.variables, header.has(configuration).tolist(), strict=True))
        point = zip(self._decided, designs.points[row].tolist(), strict=True)
        return Standing(
            configuration,
            {name: value for name, value in point if has[name]},
            tuple(designs.objectives[row].tolist()),
            dict(zip(header.requirements, designs.margins[row].tolist(), strict=True)),
            tuple(self._table.numbers[designs.rows[row]].tolist()),
            tuple(self._missed(row)),
            int(designs.failed[row]),
            doubtful=tuple(name for name, unsure in self._doubtful.items() if unsure[designs.rows[row]].any()),
            at=tuple({} if each is None else self._worst_conditions(each, designs.rows[row]) for each in self.measured),
        )

    def _worst_conditions(self, values: NDArray[np.float64], rows: NDArray[np.intp]) -> dict[str, float]:
        """Where the mean of *values*, over what is uncertain, is largest."""
        places = self._table.coordinates()[rows][:, self._conditions]
        groups = equal_rows(places)
        means = [float(values[rows[group]].mean()) for group in groups]
        if min(means) == max(means):
            return {}
        worst = groups[int(np.argmax(means))]
        names = [self._table.header.variables[n] for n in self._conditions]
        return dict(zip(names, places[worst[0]].tolist(), strict=True))

    def _missed(self, row: int) -> Iterator[Missed]:
        designs = self._designs
        for column, (name, requirement) in enumerate(self._requirements.items()):
            if designs.failing[row, column]:
                yield Missed(name, self._worst(requirement, designs.rows[row]))
            elif not designs.shown[row, column]:
                yield Missed(name)

    def is_one_sided(self, row: int) -> bool:
        """Whether each requirement is missed at one of its bounds only, so that one changed bound is enough."""
        for requirement in self._requirements.values():
            rows = self._designs.rows[row]
            missing = self._table.metric(requirement.metric)[rows][self._table.margins(requirement.name)[rows] < 0]
            low, high = requirement.at_least, requirement.at_most
            if low is not None and high is not None and (missing < low).any() and (missing > high).any():
                return False
        return True

    def _worst(self, requirement: DefinedRequirement, rows: NDArray[np.intp]) -> float:
        margins = self._table.margins(requirement.name)[rows]
        worst = rows[int(np.nanargmin(np.where(np.isnan(margins), np.inf, margins)))]
        return float(self._table.metric(requirement.metric)[worst])


def unit_of_objective(definition: StudyDefinition, objective: Objective) -> str:
    """The unit an objective is shown in."""
    if objective.is_composite:
        return compile_objective(objective, definition)[1].symbol
    if not objective.is_total:
        return next(metric.unit for metric in definition.metrics if metric.name == objective.name)
    found = (each.totals[objective.name].unit for each in definition.configurations if objective.name in each.totals)
    return next(found, "")


def _front(values: NDArray[np.float64], feasible: NDArray[np.bool_]) -> list[int]:
    rows = np.flatnonzero(feasible)
    on_it: dict[tuple[float, ...], int] = {}
    for row in rows[front_of(values[rows])].tolist():
        on_it.setdefault(tuple(values[row].tolist()), row)  # of equal ones the first
    return [on_it[point] for point in sorted(on_it)]


def _better(values: NDArray[np.float64], designs: Designs, best: Sequence[int], rivals: Rows) -> list[int]:
    """Of *rivals* those that miss a requirement and that none of the best is as good as."""
    rest = np.flatnonzero(~designs.feasible & rivals)
    ahead = values[list(best[: 1 if values.shape[1] == 1 else len(best)])]
    return [int(row) for row in rest if not (ahead <= values[row]).all(axis=1).any()]


def _wins(values: NDArray[np.float64], designs: Designs, row: int, design: Standing, rivals: Rows) -> bool:
    """Whether none of *rivals* beats design number *row* where bounds are as far out as it needs them.

    They let other designs through as well; also those that only the rounding of the bounds lets through count.
    """
    near = {missed.requirement: _ROUNDED * abs(missed.worst or 0.0) for missed in design.missed}
    needs = designs.margins[row] - [near.get(name, 0.0) for name in design.margins]
    through = np.where(designs.failing, designs.failing[row] & (designs.margins >= needs), designs.shown)
    ahead = values[rivals & through.all(axis=1)]
    return not ((ahead <= values[row]).all(axis=1) & (ahead < values[row]).any(axis=1)).any()
