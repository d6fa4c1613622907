"""Which of two designs is ahead, by which rule, and what would have to change for the other one to be.

The design that misses fewer verdicts is ahead: those on a requirement in a case. Of as many, the one that is better in
an objective of the study and worse in none; without objectives, the one with the lower price.

What if a bound were another one? A margin moves as the bound does: with margins of 3 and -1 m in two cases a design
misses one verdict; with a bound that is 1 m looser it misses none, and with one that is more than 3 m tighter, both. So
the order can change only at margins that designs have, which are tried one after the other, from the bound on.

The report's page has the same (`decision.ts`); both are tested with `tests/pair_cases.json`.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dse.analysis.data import MET, Floats
from dse.analysis.design_ranking import objectives_of, unit_of_objective
from dse.analysis.paired import NORMAL, PairedDraws, design_points, paired_draws, rows_of_design
from dse.analysis.probability import Interval
from dse.analysis.slack import FAILING
from dse.domain.bench import VERDICTS, Verdict
from dse.domain.definition import DefinedVariable, StudyDefinition
from dse.domain.rates import rate_interval
from dse.domain.sampler import Objective, Role
from dse.exploration import design_variable, designs_of
from dse.storage import RunTable, over_draws
from dse.testbench import with_composites
from dse.units import UnitError, parse_unit

_BROKEN = VERDICTS.index(Verdict.FAILED_TO_RUN)
_MOST_LEVELS = 12
"""With more values than that a straight line is fitted through the differences."""
_ROUNDING = 1e-9

FIRST, NEITHER, SECOND = 1, 0, -1
"""Which design is ahead."""


@dataclass(frozen=True, slots=True)
class Side:
    """One of the two designs: a *configuration*, the numbers of its *runs*, *missed* verdicts of *judged* ones.

    *objectives* (SI) are as `Decision.objectives` has them. *margins* (SI) are those of the draw that decides, by
    requirement and case, NaN where a metric is undefined; *rates* with their intervals where points have several draws.
    """

    configuration: str
    runs: tuple[int, ...]
    missed: int
    judged: int
    objectives: tuple[float, ...]
    margins: Mapping[str, Mapping[tuple[float, ...], float]]
    rates: Mapping[str, Mapping[tuple[float, ...], Interval]]


@dataclass(frozen=True, slots=True)
class BoundChange:
    """With the bound of *requirement* moved by *shift* (SI), tighter if positive, the design *ahead* is another one.

    A tighter bound must be moved by more than that.
    """

    requirement: str
    shift: float
    ahead: int


@dataclass(frozen=True, slots=True)
class ObjectiveChange:
    """The design *ahead* is another one once the *objective* of one design changes by more than *change* (SI).

    The first one's by *change*, or the second one's by *change* the other way.
    """

    objective: str
    change: float
    ahead: int


@dataclass(frozen=True, slots=True)
class Effect:
    """The mean difference of the margins of *requirement* (SI), first less second, by values of the *variable* (SI).

    *levels* are with 95 %, with NaN as ends of single draws. With *is_line* they are those of a straight line at the
    ends of the variable's values. *change* is the largest less the smallest of them; of a line, last less first.
    """

    variable: str
    requirement: str
    values: tuple[float, ...]
    levels: tuple[Interval, ...]
    change: Interval
    is_line: bool = False
    is_assumed: bool = False

    @property
    def reverses(self) -> bool:
        """Whether each design has the larger margin somewhere, for certain."""
        return any(level.low > 0 for level in self.levels) and any(level.high < 0 for level in self.levels)


@dataclass(frozen=True, slots=True)
class Decision:
    """The *first* design against the *second*, of which *ahead* is `FIRST`, `SECOND` or `NEITHER`.

    It follows from verdicts, and where both miss as many from the *objectives*, with their *units*: those of the study,
    else the prices of its configurations. *leading* is, by requirement, the share of the random draws in which only one
    design meets it that the first one meets. *assumed* are the parameters of either design's parts that are marked so,
    None if that is not known. The runs *are_random* if a verdict depends on the draw.
    """

    first: Side
    second: Side
    ahead: int
    objectives: tuple[Objective, ...]
    units: tuple[str, ...]
    pairs: tuple[PairedDraws, ...]
    leading: Mapping[str, Interval]
    bounds: tuple[BoundChange, ...]
    changes: tuple[ObjectiveChange, ...]
    effects: tuple[Effect, ...]
    assumed: tuple[str, ...] | None
    are_random: bool


def decide_between(table: RunTable, one: str, other: str, assumed: Iterable[str] | None = None) -> Decision:
    """Designs named as for `rows_of_design`; *table* has every draw.

    *assumed* are the numbers that components mark as such, ``component.parameter``; None if that is not known.
    DseError for what is no design of the study.
    """
    definition = table.header.definition
    rows = rows_of_design(table, one), rows_of_design(table, other)
    merged, objectives = over_draws(table), objectives_of(definition, (), ()) or [*_prices(definition)]
    first, second = (_side(table, merged, each, objectives) for each in rows)
    signed = [
        (-a, -b) if each.maximize else (a, b)
        for each, a, b in zip(objectives, first.objectives, second.objectives, strict=True)
    ]
    tie = better_in_all(signed)
    ahead = by_verdicts(first.missed, second.missed, tie)
    pairs = tuple(paired_draws(table, *rows))
    bounds = (
        BoundChange(each.name, *change)
        for each in definition.requirements
        for change in bound_changes(
            [*first.margins[each.name].values()],
            [*second.margins[each.name].values()],
            (first.missed, second.missed),
            tie,
        )
    )
    marks = None if assumed is None else _marked(definition, (first, second), assumed)
    changes = objective_changes(signed) if first.missed == second.missed else ()
    random = {each.requirement for each in pairs if each.low < each.high}
    return Decision(
        first,
        second,
        ahead,
        tuple(objectives),
        tuple(unit_of_objective(definition, each) for each in objectives),
        pairs,
        {name: leading([each for each in pairs if each.requirement == name]) for name in random},
        tuple(bounds),
        tuple(
            ObjectiveChange(objectives[n].name, -change if objectives[n].maximize else change, then)
            for n, change, then in changes
        ),
        tuple(_effects(table, rows, pairs, marks or ())),
        marks,
        bool(random),
    )


def by_verdicts(first: int, second: int, tie: int) -> int:
    """Who is ahead with so many missed verdicts; *tie* if these are as many."""
    return tie if first == second else FIRST if first < second else SECOND


def better_in_all(values: Sequence[tuple[float, float]]) -> int:
    """Who is better in one of the *values* of both, to be small, and worse in none."""
    signs = {int(np.sign(b - a)) for a, b in values if not math.isnan(b - a)} - {0}
    return signs.pop() if len(signs) == 1 else NEITHER


def bound_changes(
    first: Sequence[float], second: Sequence[float], missed: tuple[int, int], tie: int
) -> Iterator[tuple[float, int]]:
    """By how much a bound must be moved for another design to be ahead, and which; the looser one first.

    A bound that neither meets anywhere is no answer. The designs have margins *first* and *second* in the cases in
    which they are judged, and miss so many verdicts in all, on other requirements, too.
    """
    margins = [np.nan_to_num(np.array(each, dtype=np.float64), nan=-np.inf) for each in (first, second)]
    others = [all_ - int((own < 0).sum()) for all_, own in zip(missed, margins, strict=True)]
    now = by_verdicts(*missed, tie)
    at = np.unique(np.concatenate(margins))
    for shifts, fails in ((at[at < 0][::-1], np.less), (at[at >= 0], np.less_equal)):
        for shift in shifts[np.isfinite(shifts)].tolist():
            a, b = (n + int(fails(own, shift).sum()) for n, own in zip(others, margins, strict=True))
            then = by_verdicts(a, b, tie)
            if all(fails(own, shift).all() for own in margins):
                break
            if then != now:
                yield shift, then
                break


def objective_changes(values: Sequence[tuple[float, float]]) -> Iterator[tuple[int, float, int]]:
    """Which of the *values* of both, to be small, alone alters who is ahead: its number, by how much the first one has
    to change, or the second one the other way, and who is ahead then."""
    now = better_in_all(values)
    for n, (a, b) in enumerate(values):
        others = [*values[:n], *values[n + 1 :]]
        if math.isnan(b - a) or a == b:
            continue
        if all(one == other for one, other in others):
            yield n, b - a, -now
        elif rest := better_in_all(others):
            yield n, b - a, NEITHER if now else rest


def leading(pairs: Sequence[PairedDraws]) -> Interval:
    """The share of the random draws which only one design meets that the first one meets; NaN of none, then 0 … 1.

    If designs are alike, each such draw is the first one's with a probability of a half, in whatever case it is
    (McNemar, Psychometrika 12, 1947); the interval is Clopper and Pearson's.
    """
    b, c = (sum(getattr(each, what) for each in pairs if each.low < each.high) for what in ("first", "second"))
    low, high = rate_interval(np.array([b]), np.array([b + c]))
    return Interval(b / (b + c) if b + c else math.nan, float(low[0]), float(high[0]))


def _side(table: RunTable, merged: RunTable, rows: NDArray[np.intp], objectives: Sequence[Objective]) -> Side:
    definition, name = merged.header.definition, table.configurations[rows[0]]
    here = (np.array(merged.configurations, dtype=np.str_) == name) & (
        design_points(merged) == design_points(table)[:, rows[:1]]
    ).all(axis=0)
    own = np.flatnonzero(here)
    numbers = merged.numbers[own].tolist()
    totals = [total for each in objectives for total in each.totals]
    outcomes = with_composites(merged.outcomes(numbers, totals), objectives, definition)
    values = designs_of(outcomes, tuple(map(design_variable, definition.variables)), objectives).objectives[0]
    given = [v.name for v in definition.variables if v.role in (Role.CONDITION, Role.UNCERTAIN)]
    columns = [np.asarray(merged.points[v], dtype=np.float64)[own] for v in given]
    cases = [tuple(float(column[k]) for column in columns) for k in range(len(own))]
    missed, margins, rates = 0, {}, {}
    judged = 0
    for number, requirement in enumerate(merged.header.requirements):
        codes, values_here = merged.verdicts(requirement)[own], merged.margins(requirement)[own]
        counts = [int(np.isin(codes, each).sum()) for each in ([MET], [FAILING, _BROKEN])]
        # What no run exercises is not met.
        missed += counts[1] or int(not counts[0])
        judged += sum(counts) or 1
        counted = np.flatnonzero(np.isin(codes, [MET, FAILING])).tolist()
        margins[requirement] = {cases[k]: float(values_here[k]) for k in counted}
        if merged.rates is not None:
            met, of = merged.rates.met[own, number], np.maximum(merged.rates.judged[own, number], 1)
            low, high = (ends[own] for ends in merged.rates.interval(number))
            rates[requirement] = {
                cases[k]: Interval(float(met[k] / of[k]), float(low[k]), float(high[k])) for k in counted
            }
    return Side(name, tuple(table.numbers[rows].tolist()), missed, judged, tuple(values.tolist()), margins, rates)


def _prices(definition: StudyDefinition) -> Iterator[Objective]:
    """Sums of properties in a currency."""
    totals = {name: total for each in definition.configurations for name, total in each.totals.items()}
    for name, total in totals.items():
        if is_price(total.unit):
            yield Objective(name, is_total=True)


def is_price(unit: str) -> bool:
    """Whether *unit* is a currency; one that is not known is none."""
    try:
        return parse_unit(unit).dimension == parse_unit("EUR").dimension
    except UnitError:
        return False


def _effects(
    table: RunTable,
    rows: tuple[NDArray[np.intp], NDArray[np.intp]],
    pairs: Sequence[PairedDraws],
    assumed: Iterable[str],
) -> Iterator[Effect]:
    definition, marked = table.header.definition, {*assumed}
    given = [v for v in definition.variables if v.role in (Role.CONDITION, Role.UNCERTAIN)]
    found = [(v, [(each.case[n], each) for each in pairs]) for n, v in enumerate(given)]
    found += [(v, [*_siblings(table, rows, v)]) for v in definition.variables if v.role == Role.DESIGN]
    for variable, there in found:
        for requirement in table.header.requirements:
            own = [(value, each) for value, each in there if each.requirement == requirement]
            effect = effect_of(own)
            if effect is not None:
                values, levels, change, is_line = effect
                yield Effect(variable.name, requirement, values, levels, change, is_line, variable.name in marked)


def effect_of(
    pairs: Sequence[tuple[float, PairedDraws]],
) -> tuple[tuple[float, ...], tuple[Interval, ...], Interval, bool] | None:
    """Values, what `Effect` has of them, and whether it is a line; None of fewer than two values."""
    sound = [(value, each) for value, each in pairs if math.isfinite(each.margin)]
    x = np.array([value for value, _ in sound], dtype=np.float64)
    y, errors = (np.array([getattr(each, what) for _, each in sound], dtype=np.float64) for what in ("margin", "error"))
    values = np.unique(x)
    if len(values) < 2:
        return None
    if len(values) > _MOST_LEVELS:
        return _line(x, y)
    means = np.array([y[x == value].mean() for value in values])
    spreads = np.array([math.sqrt((errors[x == v] ** 2).sum()) / int((x == v).sum()) for v in values])
    largest, least = int(means.argmax()), int(means.argmin())
    reach = means[largest] - means[least]
    reach *= reach > _ROUNDING * np.abs(means).max()
    change = _interval(reach, math.hypot(spreads[largest], spreads[least]), NORMAL)
    levels = (_interval(*each, NORMAL) for each in zip(means.tolist(), spreads.tolist(), strict=True))
    return tuple(values.tolist()), tuple(levels), change, False


def _line(x: Floats, y: Floats) -> tuple[tuple[float, ...], tuple[Interval, ...], Interval, bool]:
    """Least squares; what the line leaves is taken for noise."""
    n, middle, width = len(x), x.mean(), ((x - x.mean()) ** 2).sum()
    slope = ((x - middle) * (y - y.mean())).sum() / width
    rest = y - y.mean() - slope * (x - middle)
    deviation = math.sqrt((rest**2).sum() / (n - 2))
    ends, factor = np.array([x.min(), x.max()]), student(n - 2)
    levels = tuple(
        _interval(y.mean() + slope * (at - middle), deviation * math.sqrt(1 / n + (at - middle) ** 2 / width), factor)
        for at in ends.tolist()
    )
    reach = float(ends[1] - ends[0])
    return tuple(ends.tolist()), levels, _interval(slope * reach, deviation * reach / math.sqrt(width), factor), True


def student(freedom: int) -> float:
    """The 97.5 % quantile of Student's t, to 0.2 % from 10 degrees on (Abramowitz and Stegun 26.7.5)."""
    z = NORMAL
    return z + (z**3 + z) / (4 * freedom) + (5 * z**5 + 16 * z**3 + 3 * z) / (96 * freedom**2)


def _interval(value: float, error: float, factor: float) -> Interval:
    return Interval(float(value), float(value - factor * error), float(value + factor * error))


def _siblings(
    table: RunTable, rows: tuple[NDArray[np.intp], NDArray[np.intp]], variable: DefinedVariable
) -> Iterator[tuple[float, PairedDraws]]:
    """Both designs with other values of a design *variable*, if both have the same one: their pairs, by its value."""
    names = [v.name for v in table.header.definition.variables if v.role == Role.DESIGN]
    points, ids = design_points(table), np.array(table.configurations, dtype=np.str_)
    at = names.index(variable.name)
    firsts = [int(each[0]) for each in rows]
    if points[at, firsts[0]] != points[at, firsts[1]] or not np.isfinite(points[at, firsts[0]]):
        return
    near = [
        (ids == ids[first]) & (np.delete(points, at, axis=0) == np.delete(points, at, axis=0)[:, [first]]).all(axis=0)
        for first in firsts
    ]
    for value in np.intersect1d(points[at, near[0]], points[at, near[1]]).tolist():
        both = (np.flatnonzero(each & (points[at] == value)) for each in near)
        yield from ((value, each) for each in paired_draws(table, *both))


def _marked(definition: StudyDefinition, sides: tuple[Side, Side], assumed: Iterable[str]) -> tuple[str, ...]:
    """The parameters of parts of either design that are assumed, as ``part.parameter``."""
    by_component: dict[str, list[str]] = {}
    for each in assumed:
        component, _, parameter = each.partition(".")
        by_component.setdefault(component, []).append(parameter)
    parts = {
        (part, component)
        for side in sides
        for part, component in definition.configuration(side.configuration).components.items()
    }
    return tuple(sorted({f"{part}.{name}" for part, component in parts for name in by_component.get(component, ())}))
