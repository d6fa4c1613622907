"""Listing, searching and ranking against brute force, on random spaces with every kind of rule."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import partial, reduce
from itertools import product
from operator import mul

import numpy as np
from hypothesis import given, settings, strategies as st

from dse.space.flat import (
    ABSENT,
    NO_VALUE,
    Bools,
    Clause,
    FlatSpace,
    Fold,
    Gather,
    Ints,
    Linear,
    Rule,
    Table,
    Variable,
    Wide,
)
from dse.space.methods.listing.blocks import blocks, first
from dse.space.methods.listing.recheck import valid
from dse.space.methods.mdd.diagram import compile_diagram
from dse.space.methods.mdd.expand import expand
from dse.space.methods.optimum.optimizer import Optimizer, best
from dse.space.methods.optimum.pareto import pareto
from dse.space.methods.optimum.regions import best_valued
from dse.space.methods.solver import answers
from dse.space.methods.solver.answers import SolverOptimizer

MANY = settings(max_examples=60, deadline=None)
Row = tuple[int, ...]


@dataclass(frozen=True)
class AtMostTogether:
    """The folds that are something add up to at most *limit*; vague whenever its interval is wide."""

    limit: int

    def bounds(self, low: Sequence[Ints], high: Sequence[Ints]) -> tuple[Bools, Bools]:
        least = np.zeros(len(low[0]), np.int64)
        most = np.zeros(len(low[0]), np.int64)
        for below, above in zip(low, high, strict=True):
            assert (below <= above).all()
            least += np.where(above == NO_VALUE, np.minimum(np.where(below == NO_VALUE, 0, below), 0), below)
            most = np.where((most == NO_VALUE) | ((above == NO_VALUE) & (below != NO_VALUE)), NO_VALUE, most)
            most = np.where((most == NO_VALUE) | (above == NO_VALUE), most, most + above)
        vague = most - least > 40
        return (least <= self.limit) | vague, (most > self.limit) | vague

    def holds(self, folds: Sequence[int]) -> bool:
        return sum(fold for fold in folds if fold != NO_VALUE) <= self.limit


def folded(fold: Fold, row: Row) -> int:
    parts = [] if fold.start == NO_VALUE and fold.gather is not Gather.SUM else [fold.start]
    found = [int(values[row[variable]]) for variable, values in fold.values.items()]
    parts += found if fold.gather is Gather.SUM else [value for value in found if value != NO_VALUE]
    if not parts:
        return NO_VALUE
    match fold.gather:
        case Gather.SUM:
            return sum(parts)
        case Gather.MIN:
            return min(parts)
        case Gather.MAX:
            return max(parts)
        case Gather.PRODUCT:
            return reduce(mul, parts)


def meets(rule: Rule, row: Row) -> bool:
    match rule:
        case Table():
            return bool(rule.allowed[tuple(row[number] for number in rule.scope)])
        case Clause():
            return any(mask[row[number]] for number, mask in rule.literals)
        case Linear():
            total = sum(int(weights[row[number]]) for number, weights in rule.weights.items())
            return (rule.low is None or rule.low <= total) and (rule.high is None or total <= rule.high)
        case Wide():
            return rule.judge.holds([folded(fold, row) for fold in rule.folds])


def brute_force(space: FlatSpace, order: Sequence[int] | None = None) -> list[Row]:
    """The valid rows in lexicographic order of value numbers along *order*, absent last."""
    rows = []
    for row in product(*(range(-1, len(variable.values)) for variable in space.variables)):
        exists = [v.parent is None or row[v.parent[0]] == v.parent[1] for v in space.variables]
        there = all(here == (value != ABSENT) for here, value in zip(exists, row, strict=True))
        if there and all(meets(rule, row) for rule in space.rules):
            rows.append(row)
    return sorted(rows, key=lambda row: [row[n] % 1000 for n in (order or range(len(row)))])


def weights(draw: st.DrawFn, sizes: Sequence[int]) -> dict[int, Ints]:
    scope = draw(st.sets(st.integers(0, len(sizes) - 1), min_size=1))
    unit = draw(st.sampled_from([1, 1, 1, 10**6, 10**14]))
    return {
        number: unit * np.array([*draw(st.lists(st.integers(-3, 9), min_size=size, max_size=size)), 0], np.int64)
        for number, size in enumerate(sizes)
        if number in scope
    }


def linear(draw: st.DrawFn, sizes: Sequence[int]) -> Linear:
    of = weights(draw, sizes)
    most = sum(int(values.max()) for values in of.values())
    low = draw(st.none() | st.integers(0, max(most // 2, 0)))
    high = draw(st.none() | st.integers(0, max(most, 0)))
    return Linear(of, low, high)


def fold(draw: st.DrawFn, sizes: Sequence[int]) -> Fold:
    gather = draw(st.sampled_from(Gather))
    spread = 10**9 if draw(st.integers(0, 5)) == 0 and gather is Gather.PRODUCT else 5
    # Eight contributions of 10^9 are more than 64 bits hold.
    entry = st.integers(-spread, spread)
    if gather is not Gather.SUM:
        entry = entry | st.just(NO_VALUE)
    values = {}
    for number in draw(st.sets(st.integers(0, len(sizes) - 1), min_size=1)):
        last = 0 if gather is Gather.SUM else NO_VALUE
        listed = draw(st.lists(entry, min_size=sizes[number], max_size=sizes[number]))
        values[number] = np.array([*listed, last], np.int64)
    start = draw(st.integers(-2, 2)) if gather is Gather.SUM or draw(st.booleans()) else NO_VALUE
    return Fold(gather, values, start)


@st.composite
def spaces(draw: st.DrawFn) -> FlatSpace:
    variables: list[Variable] = []
    for number in range(draw(st.integers(1, 6))):
        parent = None
        above = draw(st.integers(0, len(variables) - 1)) if variables else 0
        if variables and variables[above].values and draw(st.integers(0, 2)) == 0:
            parent = above, draw(st.integers(0, len(variables[above].values) - 1))
        variables.append(Variable(f"x{number}", tuple("abc"[: draw(st.integers(0 if parent else 1, 3))]), parent))
    sizes = [len(variable.values) for variable in variables]
    rules: list[Rule] = []
    for _ in range(draw(st.integers(0, 5))):
        kind = draw(st.sampled_from(["table", "clause", "linear", "linear", "wide"]))
        scope = sorted(draw(st.sets(st.integers(0, len(sizes) - 1), min_size=1, max_size=3)))
        if kind == "linear":
            rules.append(linear(draw, sizes))
        elif kind == "wide":
            folds = tuple(fold(draw, sizes) for _ in range(draw(st.integers(1, 2))))
            rules.append(Wide(folds, AtMostTogether(draw(st.integers(-6, 12)))))
        elif kind == "clause":
            masks = [
                np.array(draw(st.lists(st.booleans(), min_size=sizes[n] + 1, max_size=sizes[n] + 1))) for n in scope
            ]
            rules.append(Clause(tuple(zip(scope, masks, strict=True))))
        else:
            allowed = np.ones([sizes[n] + 1 for n in scope], np.bool_)
            for entry in draw(st.lists(st.tuples(*(st.integers(0, sizes[n]) for n in scope)), max_size=4)):
                allowed[entry] = False
            rules.append(Table(tuple(scope), allowed))
    return FlatSpace("random", tuple(variables), (), tuple(rules))


def listed(found: Sequence[np.ndarray]) -> list[Row]:
    return [tuple(row) for block in found for row in block.tolist()]


@MANY
@given(spaces(), st.sampled_from([1, 3, 1 << 15]))
def test_the_list_is_every_valid_row_in_order(space: FlatSpace, block: int) -> None:
    found = list(blocks(compile_diagram(space), block))
    assert all(1 <= len(rows) <= block and rows.dtype == np.int16 for rows in found)
    assert listed(found) == brute_force(space)


@MANY
@given(spaces(), st.data())
def test_another_order_of_decisions_lists_the_same_rows_in_that_order(space: FlatSpace, data: st.DataObject) -> None:
    order: list[int] = []
    for number in data.draw(st.permutations(range(len(space.variables)))):
        chain = [number]
        while (parent := space.variables[chain[-1]].parent) is not None:
            chain.append(parent[0])
        order += [above for above in reversed(chain) if above not in order]
    diagram = compile_diagram(space, order)
    assert listed(list(blocks(diagram))) == brute_force(space, diagram.order)


@settings(max_examples=60, deadline=None)
@given(spaces())
def test_rules_inside_the_layers_change_nothing(space: FlatSpace) -> None:
    assert listed(list(blocks(expand(compile_diagram(space))))) == brute_force(space)


@MANY
@given(spaces())
def test_the_first_row_leads_the_list_and_only_an_empty_list_has_none(space: FlatSpace) -> None:
    expected = brute_force(space)
    diagram = compile_diagram(space)
    row = first(diagram)
    assert (None if row is None else tuple(row.tolist())) == (expected[0] if expected else None)


@settings(max_examples=25, deadline=None)
@given(spaces(), st.data())
def test_the_solver_finds_the_best_rows(space: FlatSpace, data: st.DataObject) -> None:
    aim = weights(data.draw, [len(variable.values) for variable in space.variables])
    number = data.draw(st.integers(0, 6))
    rows = brute_force(space)
    found = listed([answers.least(space, aim, number)])
    assert [total(aim, row) for row in found] == sorted(total(aim, row) for row in rows)[:number]
    assert len(set(found)) == len(found)
    assert set(found) <= set(rows)


@settings(max_examples=50, deadline=None)
@given(spaces())
def test_the_solver_blames_rules_that_conflict_and_none_too_many(space: FlatSpace) -> None:
    blamed = answers.conflict(space)
    assert (blamed is None) == bool(brute_force(space))
    if blamed is not None:
        assert not brute_force(space.only(blamed))
        assert all(brute_force(space.only([one for one in blamed if one != other])) for other in blamed)


@settings(max_examples=25, deadline=None)
@given(spaces())
def test_the_solver_lists_the_same_rows(space: FlatSpace) -> None:
    assert sorted(tuple(row.tolist()) for block in answers.blocks(space) for row in block) == brute_force(space)


@MANY
@given(spaces())
def test_the_recheck_accepts_exactly_the_valid_rows(space: FlatSpace) -> None:
    every = list(product(*(range(-1, len(variable.values)) for variable in space.variables)))
    answer = valid(space, np.array(every, np.int16))
    assert {row for row, good in zip(every, answer.tolist(), strict=True) if good} == set(brute_force(space))


def total(of: dict[int, Ints], row: Row) -> int:
    return sum(int(values[row[number]]) for number, values in of.items())


@MANY
@given(spaces(), st.data())
def test_the_best_rows_are_those_of_the_sorted_list(space: FlatSpace, data: st.DataObject) -> None:
    aim = weights(data.draw, [len(variable.values) for variable in space.variables])
    number, largest = data.draw(st.integers(0, 12)), data.draw(st.booleans())
    # Sorting is stable: rows of equal value stay in the order of the list.
    expected = sorted(brute_force(space), key=lambda row: -total(aim, row) if largest else total(aim, row))[:number]
    found = best(compile_diagram(space), aim, number, largest=largest)
    assert listed([found.rows]) == expected
    assert list(found.values) == [total(aim, row) for row in expected]


@dataclass(frozen=True)
class Ratio:
    """The first fold by the second; undefined for a divisor of nothing or zero."""

    folds: tuple[Fold, ...]

    def bounds(self, low: Sequence[Ints], high: Sequence[Ints]) -> tuple[np.ndarray, np.ndarray]:
        known = (low[1] > 0) & (low[0] >= 0)
        ends = [np.where(known, a / np.maximum(b, 1), np.inf) for a, b in ((low[0], high[1]), (high[0], low[1]))]
        low, high = np.nextafter(ends[0], -np.inf), np.nextafter(ends[1], np.inf)
        return np.where(known, low, -np.inf), np.where(known, high, np.inf)

    def value(self, folds: Sequence[int]) -> Fraction | None:
        return None if folds[1] in (0, NO_VALUE) else Fraction(folds[0], folds[1])


@MANY
@given(spaces(), st.data())
def test_the_best_rows_of_a_ratio_are_those_of_the_sorted_list(space: FlatSpace, data: st.DataObject) -> None:
    sizes = [len(variable.values) for variable in space.variables]
    above = Fold(Gather.SUM, weights(data.draw, sizes), data.draw(st.integers(0, 30)))
    ratio = Ratio((above, fold(data.draw, sizes)))
    number, largest = data.draw(st.integers(0, 12)), data.draw(st.booleans())
    values = {row: ratio.value([folded(part, row) for part in ratio.folds]) for row in brute_force(space)}
    ranked = [(value, row) for row, value in values.items() if value is not None]
    expected = sorted(ranked, key=lambda pair: -pair[0] if largest else pair[0])[:number]
    found = best_valued(compile_diagram(space), ratio, number, largest=largest)
    assert listed([found.rows]) == [row for _, row in expected]
    assert list(found.values) == [value for value, _ in expected]


@settings(max_examples=25, deadline=None)
@given(spaces(), st.data())
def test_the_pareto_set_is_what_no_row_improves_on(space: FlatSpace, data: st.DataObject) -> None:
    aims = [
        weights(data.draw, [len(variable.values) for variable in space.variables])
        for _ in range(data.draw(st.integers(1, 4)))
    ]
    largest = data.draw(st.lists(st.booleans(), min_size=len(aims), max_size=len(aims)))
    leading: dict[Row, Row] = {}
    for row in brute_force(space):
        point = tuple(-total(aim, row) if most else total(aim, row) for aim, most in zip(aims, largest, strict=True))
        leading.setdefault(point, row)
    expected = [
        leading[point]
        for point in sorted(leading)
        if not any(other != point and all(a <= b for a, b in zip(other, point, strict=True)) for other in leading)
    ]
    found = pareto(partial(Optimizer, compile_diagram(space)), aims, largest)
    assert listed([found.rows]) == expected
    assert list(found.values) == [tuple(total(aim, row) for aim in aims) for row in expected]
    solved = pareto(partial(SolverOptimizer, space), aims, largest)
    assert solved.values == found.values
    assert [tuple(total(aim, row) for aim in aims) for row in listed([solved.rows])] == list(found.values)
