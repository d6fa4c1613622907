from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from math import prod

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from paths import contains

from dse.space.flat import (
    ABSENT,
    NO_VALUE,
    Bools,
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
from dse.space.methods.mdd.diagram import compile_diagram, count
from dse.space.methods.mdd.expand import expand
from dse.space.methods.mdd.growth import TooWideError

THOROUGH = settings(max_examples=150, deadline=None)


@dataclass(frozen=True)
class AtLeast:
    """The first fold is at least the second (or *limit*); a fold of nothing fails. Bounds as vague as asked for."""

    limit: int
    vague: bool

    def bounds(self, low: Sequence[Ints], high: Sequence[Ints]) -> tuple[Bools, Bools]:
        if self.vague or len(low) == 0:
            shape = low[0].shape if low else (1,)
            return np.ones(shape, np.bool_), np.ones(shape, np.bool_)
        other_low, other_high = (low[1], high[1]) if len(low) > 1 else (np.int64(self.limit), np.int64(self.limit))
        some_nothing = (high[0] == NO_VALUE) | (other_high == NO_VALUE)
        all_nothing = (low[0] == NO_VALUE) | (other_low == NO_VALUE)
        return (high[0] >= other_low) & ~all_nothing, (low[0] < other_high) | some_nothing

    def holds(self, folds: Sequence[int]) -> bool:
        if not folds:
            return self.limit > 0
        other = folds[1] if len(folds) > 1 else self.limit
        return folds[0] != NO_VALUE and other != NO_VALUE and folds[0] >= other


def folded(fold: Fold, row: Sequence[int]) -> int:
    found = [int(values[row[variable]]) for variable, values in fold.values.items()]
    if fold.gather is Gather.SUM:
        return fold.start + sum(found)
    found = [value for value in (fold.start, *found) if value != NO_VALUE]
    if not found:
        return NO_VALUE
    return {Gather.MIN: min, Gather.MAX: max, Gather.PRODUCT: prod}[fold.gather](found)  # type: ignore[operator]


def holds(rule: Rule, row: Sequence[int]) -> bool:
    match rule:
        case Table():
            return bool(rule.allowed[tuple(row[number] for number in rule.scope)])
        case Linear():
            total = sum(int(weights[row[number]]) for number, weights in rule.weights.items())
            return (rule.low is None or total >= rule.low) and (rule.high is None or total <= rule.high)
        case Wide():
            return rule.judge.holds([folded(fold, row) for fold in rule.folds])
    raise AssertionError


def brute_force(space: FlatSpace) -> set[tuple[int, ...]]:
    rows = set()
    for row in product(*(range(-1, len(variable.values)) for variable in space.variables)):
        exists = [v.parent is None or row[v.parent[0]] == v.parent[1] for v in space.variables]
        if all(there == (value != ABSENT) for there, value in zip(exists, row, strict=True)) and all(
            holds(rule, row) for rule in space.rules
        ):
            rows.add(row)
    return rows


@st.composite
def spaces(draw: st.DrawFn) -> FlatSpace:
    variables: list[Variable] = []
    for number in range(draw(st.integers(0, 5))):
        parent = None
        if variables and draw(st.booleans()):
            above = draw(st.integers(0, len(variables) - 1))
            parent = above, draw(st.integers(0, len(variables[above].values) - 1))
        size = draw(st.integers(1, 4))
        variables.append(Variable(f"x{number}", tuple(f"v{value}" for value in range(size)), parent))
    rules: list[Rule] = []
    numbers = range(len(variables))
    for _ in range(draw(st.integers(0, 2))):
        scope = tuple(sorted(draw(st.sets(st.sampled_from(numbers), max_size=3)))) if variables else ()
        allowed = np.ones([len(variables[number].values) + 1 for number in scope], np.bool_)
        for entry in draw(st.lists(st.tuples(*(st.integers(0, size - 1) for size in allowed.shape)), max_size=3)):
            allowed[entry] = False
        rules.append(Table(scope, allowed))
    for _ in range(draw(st.integers(0, 3))):
        sizes = draw(st.sampled_from((3, 20, 10**15)))
        weights = {n: draw(entries(len(v.values), sizes)) for n, v in enumerate(variables) if draw(st.booleans())}
        ends = [draw(st.none() | st.integers(-3 * sizes, 3 * sizes)) for _ in range(2)]
        if draw(st.booleans()) and weights:
            # A bound that some row meets exactly.
            ends[draw(st.integers(0, 1))] = sum(int(draw(st.sampled_from(w.tolist()))) for w in weights.values())
        rules.append(Linear(weights, ends[0], ends[1]))
    for _ in range(draw(st.integers(0, 2))):
        folds = tuple(draw(some_fold(variables)) for _ in range(draw(st.integers(0, 2))))
        rules.append(Wide(folds, AtLeast(draw(st.integers(-9, 9)), draw(st.booleans()))))
    return FlatSpace("random", tuple(variables), (), tuple(rules))


@st.composite
def entries(draw: st.DrawFn, values: int, largest: int) -> Ints:
    found = draw(st.lists(st.integers(-largest, largest), min_size=values, max_size=values))
    return np.array([*found, 0], np.int64)


@st.composite
def some_fold(draw: st.DrawFn, variables: Sequence[Variable]) -> Fold:
    gather = draw(st.sampled_from(list(Gather)))
    # Products of these leave 64 bits.
    largest = 10**17 if gather is Gather.PRODUCT and draw(st.booleans()) else 6
    values = {}
    for number, variable in enumerate(variables):
        if draw(st.booleans()):
            of_variable = draw(entries(len(variable.values), largest))
            if gather is not Gather.SUM:
                of_variable[-1] = NO_VALUE
                of_variable[draw(st.integers(0, len(variable.values)))] = NO_VALUE
            values[number] = of_variable
    start = draw(st.integers(-3, 3))
    if gather is not Gather.SUM and draw(st.booleans()):
        start = NO_VALUE
    return Fold(gather, values, start)


@THOROUGH
@given(spaces())
def test_the_paths_are_the_rows_that_meet_every_rule(space: FlatSpace) -> None:
    rows = brute_force(space)
    expanded = expand(compile_diagram(space))
    assert expanded.expanded
    assert expanded.empty == (not rows)
    assert count(expanded) == len(rows)
    for row in product(*(range(-1, len(variable.values)) for variable in space.variables)):
        assert contains(expanded, row) == (row in rows)


@THOROUGH
@given(spaces())
def test_expanding_gives_the_diagram_of_the_rows(space: FlatSpace) -> None:
    everything = np.zeros([len(variable.values) + 1 for variable in space.variables], np.bool_)
    for row in brute_force(space):
        everything[row] = True
    table = Table(tuple(range(len(space.variables))), everything)
    expanded = expand(compile_diagram(space))
    same = compile_diagram(FlatSpace("rows", space.variables, (), (table,)))
    assert all(np.array_equal(a, b) for a, b in zip(expanded.layers, same.layers, strict=True))


@THOROUGH
@given(spaces())
def test_a_rule_never_adds_a_row(space: FlatSpace) -> None:
    numbers = [
        count(expand(compile_diagram(FlatSpace("some", space.variables, (), space.rules[:most]))))
        for most in range(len(space.rules) + 1)
    ]
    assert numbers == sorted(numbers, reverse=True)


def test_sums_near_the_end_of_machine_integers_are_exact() -> None:
    large = 2**57
    variables = tuple(Variable(f"x{n}", ("a", "b")) for n in range(16))
    weights = {n: np.array([large, -large + n, 0]) for n in range(16)}
    for low, high in ((0, None), (None, 0), (1, 10**30), (-(10**30), 10**30), (10**30, None)):
        space = FlatSpace("large", variables, (), (Linear(weights, low, high),))
        assert count(expand(compile_diagram(space))) == len(brute_force_sums(weights, low, high))


def brute_force_sums(weights: dict[int, Ints], low: int | None, high: int | None) -> list[int]:
    totals = [0]
    for of_variable in weights.values():
        totals = [total + int(weight) for total in totals for weight in of_variable[:-1]]
    return [total for total in totals if (low is None or total >= low) and (high is None or total <= high)]


def test_sums_that_behave_alike_are_one_node() -> None:
    # Multiples of 100 and one unit: only the hundreds matter for the bound.
    variables = tuple(Variable(f"x{n}", ("a", "b")) for n in range(60))
    weights = {n: np.array([0, 100 if n else 1, 0]) for n in range(60)}
    expanded = expand(compile_diagram(FlatSpace("half", variables, (), (Linear(weights, None, 2950),))))
    assert len(expanded.layers[1]) == 1
    # Of the other 59, at most 29 take b: half of all rows.
    assert count(expanded) == 2**59


def test_an_expansion_that_grows_too_wide_is_given_up() -> None:
    variables = tuple(Variable(f"x{n}", ("a", "b")) for n in range(40))
    weights = {n: np.array([0, 3**n, 0]) for n in range(36)}
    space = FlatSpace("distinct", variables, (), (Linear(weights, 3**35, 3**35 + 3**20),))
    with pytest.raises(TooWideError):
        expand(compile_diagram(space), most_nodes=5)


def test_rules_over_nothing_are_judged_too() -> None:
    empty = FlatSpace("none", (), (), ())
    assert count(expand(compile_diagram(empty.having(Linear({}, 0, 0))))) == 1
    assert count(expand(compile_diagram(empty.having(Linear({}, 1, None))))) == 0
    assert count(expand(compile_diagram(empty.having(Wide((), AtLeast(1, False)))))) == 1
    assert count(expand(compile_diagram(empty.having(Wide((), AtLeast(0, False)))))) == 0


def test_a_layer_expanded_in_many_blocks_is_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    draw = np.random.default_rng(5)
    variables = tuple(Variable(f"x{n}", ("a", "b", "c")) for n in range(8))
    weights = {n: np.array([*draw.integers(-9, 9, 3), 0]) for n in range(8)}
    factors = {n: np.array([*draw.integers(-(10**9), 10**9, 3), NO_VALUE]) for n in range(8)}
    rules = (Linear(weights, -5, 9), Wide((Fold(Gather.PRODUCT, factors, NO_VALUE),), AtLeast(10**60, False)))
    space = FlatSpace("blocks", variables, (), rules)
    at_once = expand(compile_diagram(space))
    monkeypatch.setattr("dse.space.methods.mdd.growth._BLOCK", 40)
    in_blocks = expand(compile_diagram(space))
    assert max(len(layer) for layer in at_once.layers) > 10
    assert all(np.array_equal(a, b) for a, b in zip(at_once.layers, in_blocks.layers, strict=True))
