"""Which of two designs is ahead, by which rule, and what would have to change for the other one to be.

The order is that of `dse.analysis.order`.

What if a bound were another one? A margin moves as the bound does: with margins of 3 and -1 m in two cases a design
misses one verdict; with a bound that is 1 m looser it misses none, and with one that is more than 3 m tighter, both. So
the order can change only at margins that designs have, which are tried one after the other, from the bound on. What is
missed with the other bound only counts as certain, and a tie is decided as with the present bound.

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
from dse.analysis.order import (
    FIRST,
    MISSED,
    SECOND,
    Key,
    ahead_by,
    design_order,
    severities_of,
    severity_levels,
    unsure_of,
)
from dse.analysis.paired import NORMAL, PairedDraws, design_points, paired_draws, rows_of_design
from dse.analysis.probability import Interval
from dse.analysis.slack import FAILING
from dse.domain.definition import DefinedVariable, StudyDefinition
from dse.domain.rates import rate_interval
from dse.domain.sampler import Objective, Role
from dse.exploration import design_variable, designs_of
from dse.storage import RunTable, over_draws
from dse.testbench import with_composites
from dse.units import UnitError, is_currency, parse_unit

_MOST_LEVELS = 12
"""With more values than that a straight line is fitted through the differences."""
_ROUNDING = 1e-9


@dataclass(frozen=True, slots=True)
class ClassCount:
    """Of *judged* verdicts on requirements of a *severity* ("" for none), so many are missed for *certain*, and so many
    missed ones are *doubtful*."""

    severity: str
    judged: int
    certain: int
    doubtful: int

    @property
    def missed(self) -> int:
        """Certain and doubtful ones."""
        return self.certain + self.doubtful


@dataclass(frozen=True, slots=True)
class Side:
    """One of the two designs: a *configuration*, values (SI) of the design variables that it has, the numbers of its
    *runs*; *missed* verdicts of *judged* ones, also as *counts* of each class of severity.

    *objectives* (SI) are as `Decision.objectives` has them. *margins* (SI) are those of the draw that decides, by
    requirement and case, NaN where a metric is undefined; *rates* with their intervals where points have several draws.
    *misses* has the cases in which a requirement is missed, and whether that is doubtful; *unsure* is how many of all
    verdicts are. *slack* is the least margin as a share; *key* is the place in the order.
    """

    configuration: str
    point: Mapping[str, float]
    runs: tuple[int, ...]
    missed: int
    judged: int
    counts: tuple[ClassCount, ...]
    objectives: tuple[float, ...]
    margins: Mapping[str, Mapping[tuple[float, ...], float]]
    rates: Mapping[str, Mapping[tuple[float, ...], Interval]]
    misses: Mapping[str, Mapping[tuple[float, ...], bool]]
    unsure: int
    slack: float
    key: Key


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

    It follows from column *by* of their keys, -1 if these are equal. *objectives* are those of the study, with their
    *units*. *leading* is, by requirement, the share of the random draws in which only one design meets it that the
    first one meets. *assumed* are the parameters of either design's parts that are marked so, None if that is not
    known. The runs *are_random* if a verdict depends on the draw.
    """

    first: Side
    second: Side
    ahead: int
    by: int
    objectives: tuple[Objective, ...]
    units: tuple[str, ...]
    pairs: tuple[PairedDraws, ...]
    leading: Mapping[str, Interval]
    bounds: tuple[BoundChange, ...]
    changes: tuple[ObjectiveChange, ...]
    effects: tuple[Effect, ...]
    assumed: tuple[str, ...] | None
    are_random: bool


def decide_between(
    table: RunTable,
    one: str,
    other: str,
    assumed: Iterable[str] | None = None,
    objectives: Sequence[Objective] | None = None,
) -> Decision:
    """Designs named as for `rows_of_design`; *table* has every draw.

    *assumed* are the numbers that components mark as such, ``component.parameter``; None if that is not known.
    *objectives* are those of the study unless they are given. DseError for what is no design of the study.
    """
    definition = table.header.definition
    rows = rows_of_design(table, one), rows_of_design(table, other)
    merged, wanted = over_draws(table), objectives_of(definition, (), ()) if objectives is None else objectives
    first, second = sides = _sides(table, merged, rows, wanted)
    ahead, by = ahead_by(first.key, second.key)
    pairs = tuple(paired_draws(table, *rows))
    bounds = (
        BoundChange(each.name, *change)
        for each, level in zip(definition.requirements, severity_levels(definition), strict=True)
        for change in bound_changes(_own(first, each.name), _own(second, each.name), (first.key, second.key), level)
    )
    marks = None if assumed is None else _marked(definition, sides, assumed)
    last = 1 + 2 * len(first.counts)
    signed = [*zip(first.key[last:-1], second.key[last:-1], strict=True)] if not ahead or by >= last else []
    random = {each.requirement for each in pairs if each.low < each.high}
    return Decision(
        first,
        second,
        ahead,
        by,
        tuple(wanted),
        tuple(unit_of_objective(definition, each) for each in wanted),
        pairs,
        {name: leading([each for each in pairs if each.requirement == name]) for name in random},
        tuple(bounds),
        tuple(
            ObjectiveChange(wanted[n].name, -change if wanted[n].maximize else change, then)
            for n, change, then in objective_changes(signed)
        ),
        tuple(_effects(table, rows, pairs, marks or ())),
        marks,
        bool(random),
    )


def _own(side: Side, requirement: str) -> list[tuple[float, bool]]:
    misses = side.misses[requirement]
    return [(margin, misses.get(case, False)) for case, margin in side.margins[requirement].items()]


def bound_changes(
    first: Sequence[tuple[float, bool]], second: Sequence[tuple[float, bool]], keys: tuple[Key, Key], level: int
) -> Iterator[tuple[float, int]]:
    """By how much a bound must be moved for another design to be ahead, and which; the looser one first.

    A bound that neither meets anywhere is no answer. The designs have these margins in the cases in which they are
    judged, and whether they are missed but doubtful. *level* is the requirement's class of severity.
    """
    margins = [np.nan_to_num(np.array([m for m, _ in own], dtype=np.float64), nan=-np.inf) for own in (first, second)]
    unsure = [np.array([is_doubtful for _, is_doubtful in own], dtype=np.bool_) for own in (first, second)]
    column = 1 + 2 * level

    def moved(key: Key, own: Floats, is_doubtful: NDArray[np.bool_], fails: NDArray[np.bool_]) -> Key:
        kinds = ~is_doubtful, is_doubtful
        counts = (
            key[column + n] + int((fails & kind).sum()) - int(((own < 0) & kind).sum()) for n, kind in enumerate(kinds)
        )
        return *key[:column], *counts, *key[column + 2 :]

    now, _ = ahead_by(*keys)
    at = np.unique(np.concatenate(margins))
    for shifts, compare in ((at[at < 0][::-1], np.less), (at[at >= 0], np.less_equal)):
        for shift in shifts[np.isfinite(shifts)].tolist():
            fails = [compare(own, shift) for own in margins]
            if all(each.all() for each in fails):
                break
            then, _ = ahead_by(*map(moved, keys, margins, unsure, fails))
            if then != now:
                yield shift, then
                break


def objective_changes(values: Sequence[tuple[float, float]]) -> Iterator[tuple[int, float, int]]:
    """Which of the *values* of both, to be small, alters who is ahead: its number, by how much the first one has to
    change, or the second one the other way, and who is ahead then. Only the first in which they differ does."""
    for n, (a, b) in enumerate(values):
        if a != b:
            if math.isfinite(b - a):
                yield n, b - a, SECOND if a < b else FIRST
            return


def leading(pairs: Sequence[PairedDraws]) -> Interval:
    """The share of the random draws which only one design meets that the first one meets; NaN of none, then 0 … 1.

    If designs are alike, each such draw is the first one's with a probability of a half, in whatever case it is
    (McNemar, Psychometrika 12, 1947); the interval is Clopper and Pearson's.
    """
    b, c = (sum(getattr(each, what) for each in pairs if each.low < each.high) for what in ("first", "second"))
    low, high = rate_interval(np.array([b]), np.array([b + c]))
    return Interval(b / (b + c) if b + c else math.nan, float(low[0]), float(high[0]))


def point_of(table: RunTable, row: int) -> dict[str, float]:
    """Values (SI) of the design variables that the design of *row* has."""
    has = table.header.has(table.configurations[row]).tolist()
    variables = zip(table.header.definition.variables, has, strict=True)
    return {v.name: float(table.points[v.name][row]) for v, own in variables if own and v.role == Role.DESIGN}


def _sides(
    table: RunTable, merged: RunTable, rows: tuple[NDArray[np.intp], NDArray[np.intp]], objectives: Sequence[Objective]
) -> tuple[Side, Side]:
    definition, points = merged.header.definition, design_points(merged)
    ids = np.array(merged.configurations, dtype=np.str_)
    own = [
        np.flatnonzero(
            (ids == table.configurations[each[0]]) & (points == design_points(table)[:, each[:1]]).all(axis=0)
        )
        for each in rows
    ]
    totals = [total for each in objectives for total in each.totals]
    values = []
    for each in own:
        outcomes = merged.outcomes(merged.numbers[each].tolist(), totals)
        outcomes = with_composites(outcomes, objectives, definition)
        variables = tuple(map(design_variable, definition.variables))
        values.append(designs_of(outcomes, variables, objectives).objectives[0])
    signs = np.array([-1.0 if each.maximize else 1.0 for each in objectives])
    order = design_order(merged, own, signs * np.array(values))
    classes = severities_of(definition)

    def side(place: int) -> Side:
        here, margins, rates, misses = own[place], {}, {}, {}
        given = [v.name for v in definition.variables if v.role in (Role.CONDITION, Role.UNCERTAIN)]
        columns = [np.asarray(merged.points[v], dtype=np.float64)[here] for v in given]
        cases = [tuple(float(column[k]) for column in columns) for k in range(len(here))]
        unsure = 0
        for number, requirement in enumerate(definition.requirements):
            name = requirement.name
            codes, by = merged.verdicts(name)[here], merged.margins(name)[here]
            doubtful = unsure_of(merged, name)[here]
            unsure += int(doubtful.sum())
            counted = np.flatnonzero(np.isin(codes, [MET, FAILING])).tolist()
            margins[name] = {cases[k]: float(by[k]) for k in counted}
            misses[name] = {cases[k]: bool(doubtful[k]) for k in np.flatnonzero(np.isin(codes, MISSED)).tolist()}
            if merged.rates is not None:
                met, of = merged.rates.met[here, number], np.maximum(merged.rates.judged[here, number], 1)
                low, high = (ends[here] for ends in merged.rates.interval(number))
                rates[name] = {
                    cases[k]: Interval(float(met[k] / of[k]), float(low[k]), float(high[k])) for k in counted
                }
        counts = tuple(
            ClassCount(word, *(int(each[place, level]) for each in (order.judged, order.certain, order.doubtful)))
            for level, word in enumerate(classes)
        )
        return Side(
            table.configurations[rows[place][0]],
            point_of(merged, int(here[0])),
            tuple(table.numbers[rows[place]].tolist()),
            sum(each.missed for each in counts),
            sum(each.judged for each in counts),
            counts,
            tuple(values[place].tolist()),
            margins,
            rates,
            misses,
            unsure,
            float(order.slack[place]),
            tuple(order.keys[place].tolist()),
        )

    return side(0), side(1)


def is_price(unit: str) -> bool:
    """Whether *unit* is a currency; one that is not known is none."""
    try:
        return is_currency(parse_unit(unit).dimension)
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
