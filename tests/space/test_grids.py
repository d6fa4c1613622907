"""Exact counts by grids of partial sums, against brute force and against numbers known in closed form."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from math import comb, isfinite
from random import Random
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from dse.space.flat import ABSENT, FlatSpace, Fold, Gather, Ints, Linear, Rule, Table, Variable, Wide
from dse.space.methods.budget import Cost, TooMuchError
from dse.space.methods.grid.exact import exact_count
from dse.space.methods.grid.halves import pairs, summed
from dse.space.methods.grid.split import Counting, Execution, counting, execute, heights, split
from dse.space.methods.grid.sweep import backward, forward
from dse.space.methods.mdd.diagram import DecisionDiagram, compile_diagram, count


def ints(*numbers: int) -> Ints:
    return np.array(numbers, np.int64)


def free(sizes: Sequence[int], rules: Sequence[Rule]) -> FlatSpace:
    """Variables of these sizes that always exist."""
    variables = [Variable(f"v{i}", tuple(f"a{a}" for a in range(n))) for i, n in enumerate(sizes)]
    return FlatSpace("space", tuple(variables), (), tuple(rules))


def rows(space: FlatSpace) -> Iterator[tuple[int, ...]]:
    for row in product(*([ABSENT, *range(len(v.values))] for v in space.variables)):
        exists = [v.parent is None or row[v.parent[0]] == v.parent[1] for v in space.variables]
        if all((value != ABSENT) == there for value, there in zip(row, exists, strict=True)):
            yield row


def brute_force(space: FlatSpace) -> int:
    def meets(row: tuple[int, ...]) -> bool:
        for table in space.tables():
            if not table.allowed[tuple(row[i] for i in table.scope)]:
                return False
        for rule in space.linears():
            total = sum(int(weights[row[i]]) for i, weights in rule.weights.items())
            if (rule.low is not None and total < rule.low) or (rule.high is not None and total > rule.high):
                return False
        return True

    return sum(meets(row) for row in rows(space))


@st.composite
def spaces(draw: st.DrawFn) -> FlatSpace:
    variables: list[Variable] = []
    for number in range(draw(st.integers(0, 6))):
        size = draw(st.integers(1, 4))
        parent = None
        if number and draw(st.booleans()):
            above = draw(st.integers(0, number - 1))
            parent = (above, draw(st.integers(0, len(variables[above].values) - 1)))
        variables.append(Variable(f"v{number}", tuple(f"a{a}" for a in range(size)), parent))
    rules: list[Rule] = []
    bits = st.lists(st.booleans(), min_size=25, max_size=25)
    for _ in range(draw(st.integers(0, 2))):
        if len(variables) < 2:
            break
        one, other = sorted(draw(st.lists(st.integers(0, len(variables) - 1), min_size=2, max_size=2, unique=True)))
        shape = (len(variables[one].values) + 1, len(variables[other].values) + 1)
        allowed = np.array(draw(bits)).reshape(5, 5)[: shape[0], : shape[1]] | (draw(st.booleans()))
        rules.append(Table((one, other), allowed))
    scale = draw(st.sampled_from([1, 1, 5, 1000]))
    for _ in range(draw(st.integers(0, 4))):
        weights = {
            number: np.array([scale * draw(st.integers(-4, 6)) for _ in variable.values] + [0], np.int64)
            for number, variable in enumerate(variables)
            if draw(st.integers(0, 5))
        }
        low = draw(st.none() | st.integers(-12 * scale, 20 * scale))
        high = draw(st.none() | st.integers(-12 * scale, 20 * scale))
        rules.append(Linear(weights, low, high))
    return FlatSpace("space", tuple(variables), (), tuple(rules))


@pytest.mark.thorough
@settings(max_examples=400, deadline=None)
@given(spaces())
def test_the_count_is_that_of_brute_force(space: FlatSpace) -> None:
    assert exact_count(compile_diagram(space)) == brute_force(space)


@settings(max_examples=100, deadline=None)
@given(spaces(), st.randoms(use_true_random=False))
def test_the_order_of_the_layers_does_not_matter(space: FlatSpace, random: Random) -> None:
    order: list[int] = []
    while len(order) < len(space.variables):
        left = [i for i, v in enumerate(space.variables) if i not in order and (not v.parent or v.parent[0] in order)]
        order.append(random.choice(left))
    assert exact_count(compile_diagram(space, order)) == brute_force(space)


def cost(diagram: DecisionDiagram) -> Cost:
    """What the count would take at least work."""
    found = counting(diagram)
    assert isinstance(found, Counting)
    return split(found, float("inf"), float("inf")).cost


def counts_at_all_cuts(space: FlatSpace) -> list[int]:
    """Whatever the cost."""
    found = counting(compile_diagram(space))
    if not isinstance(found, Counting):
        return [count(found)]
    counts = []
    for cut in range(len(space.variables) + 1):
        sweeps = (
            forward(found.layers, found.sums, found.before, cut),
            backward(found.layers, found.sums, found.after, cut),
        )
        ours, theirs = (execute(sweep, Execution(None, 0)).grids for sweep in sweeps)
        own, other, paths = found.ahead(cut), found.behind(cut), sweeps[1].paths[-1]
        counts.append(
            sum(
                pairs(
                    found.sums,
                    ours[node].digits,
                    own,
                    summed(theirs[node].digits, other, int(paths[node])),
                    other,
                )
                for node in ours.keys() & theirs.keys()
            )
        )
    return counts


@pytest.mark.thorough
@settings(max_examples=300, deadline=None)
@given(spaces())
def test_the_halves_may_meet_anywhere(space: FlatSpace) -> None:
    assert set(counts_at_all_cuts(space)) == {brute_force(space)}


def test_a_gathered_sum_may_pass_the_greatest_that_was_there() -> None:
    """After *a*, 0 counts as 70, for 1260 may follow after *b*; with 1000 it is then more than any sum there is."""
    only_with_a = np.array([[False, True, False], [True, False, False], [False, False, False]])
    only_with_b = np.array([[True, False, False], [True, True, False], [False, False, False]])
    weights = {0: ints(0, 101, 0), 1: ints(0, 1000, 0), 2: ints(0, 1200, 0), 3: ints(0, 60, 0)}
    rules: list[Rule] = [Table((0, 1), only_with_a), Table((0, 2), only_with_b), Linear(weights, None, 1330)]
    space = free([2, 2, 2, 2], rules)
    assert brute_force(space) == 5
    assert counts_at_all_cuts(space) == [5] * 5


@pytest.mark.parametrize("high", [-1, 0, 1, 37, 299, 300, 601])
def test_places_of_two_values_count_as_binomial_coefficients(high: int) -> None:
    """Sums of 300 zeros and ones, far beyond 64 bits."""
    rule = Linear({i: ints(0, 1, 0) for i in range(300)}, None, high)
    expected = sum(comb(300, k) for k in range(min(high, 300) + 1))
    assert exact_count(compile_diagram(free([2] * 300, [rule]))) == expected


def test_two_sums_beyond_64_bits_in_every_cell_count_as_products() -> None:
    """Even places carry one sum, odd places the other, sixty places without a weight multiply by eight each."""
    ones = Linear({i: ints(0, 1, 0) for i in range(0, 40, 2)}, 3, 11)
    others = Linear({i: ints(0, -1, 0) for i in range(1, 40, 2)}, -9, None)
    expected = sum(comb(20, k) for k in range(3, 12)) * sum(comb(20, k) for k in range(10)) * 8**60
    sizes = [2] * 20 + [8] * 60 + [2] * 20
    places = [*range(20), *range(80, 100)]
    moved = [
        Linear({places[i]: weights for i, weights in rule.weights.items()}, rule.low, rule.high)
        for rule in (ones, others)
    ]
    assert exact_count(compile_diagram(free(sizes, moved))) == expected


def test_a_loose_bound_gathers_what_is_sure_beyond_64_bits() -> None:
    """All but the greatest few sums are allowed: complement of a short tail, in each of two sums."""
    sizes = [8] * 60
    weights = ints(*range(8), 0)
    one = Linear(dict.fromkeys(range(30), weights), None, 30 * 7 - 3)
    other = Linear(dict.fromkeys(range(30, 60), weights), None, 30 * 7 - 2)
    tail = [comb(29 + k, k) for k in range(3)]
    expected = (8**30 - sum(tail)) * (8**30 - sum(tail[:2]))
    assert exact_count(compile_diagram(free(sizes, [one, other]))) == expected


def test_weights_that_are_all_equal_multiply_the_ways() -> None:
    rule = Linear({i: ints(*[1] * 50, 2, 0) for i in range(40)}, None, 43)
    expected = sum(comb(40, k) * 50 ** (40 - k) for k in range(4))
    assert exact_count(compile_diagram(free([51] * 40, [rule]))) == expected


def test_a_bound_from_below_and_one_from_above_on_one_sum_leave_what_lies_between() -> None:
    weights: Mapping[int, Ints] = {i: ints(*range(6), 0) for i in range(8)}
    both = [Linear(weights, 15, None), Linear(weights, None, 22)]
    together = [Linear(weights, 15, 22)]
    apart = compile_diagram(free([6] * 8, both))
    assert exact_count(apart) == exact_count(compile_diagram(free([6] * 8, together)))
    assert cost(apart).work == cost(compile_diagram(free([6] * 8, together))).work


def test_a_unit_in_which_all_weights_are_whole_multiples_costs_nothing() -> None:
    def space(unit: int) -> FlatSpace:
        return free([5] * 10, [Linear({i: unit * ints(3, 1, 4, 1, 6, 0) for i in range(10)}, None, unit * 30)])

    fine, coarse = compile_diagram(space(10**12)), compile_diagram(space(1))
    assert exact_count(fine) == exact_count(coarse)
    assert cost(fine) == cost(coarse)


@pytest.mark.parametrize(("low", "high"), [(None, -1), (61, None), (20, 10), (1000, 1001)])
def test_bounds_that_nothing_meets_leave_nothing(low: int | None, high: int | None) -> None:
    rule = Linear({i: ints(0, 3, 6, 0) for i in range(10)}, low, high)
    assert exact_count(compile_diagram(free([3] * 10, [rule]))) == 0


def test_rules_that_never_meet_leave_nothing_though_each_alone_can_hold() -> None:
    """No row of ten places has both an even number of ones by count and the same number by another sum."""
    few = Linear({i: ints(0, 1, 0) for i in range(10)}, None, 2)
    many = Linear({i: ints(0, 2 + i % 2, 0) for i in range(10)}, 9, None)
    assert exact_count(compile_diagram(free([2] * 10, [few, many]))) == 0


def test_without_variables_there_is_one_row_if_the_rules_allow_it() -> None:
    assert exact_count(compile_diagram(free([], []))) == 1
    assert exact_count(compile_diagram(free([], [Linear({}, None, 0)]))) == 1
    assert exact_count(compile_diagram(free([], [Linear({}, 1, None)]))) == 0


def test_without_sums_the_count_is_the_diagrams() -> None:
    diagram = compile_diagram(free([3] * 40, []))
    assert exact_count(diagram) == count(diagram) == 3**40


def test_a_count_beyond_the_budget_is_refused_before_it_is_begun() -> None:
    rules = [Linear({i: ints(0, i * step % 101, 0) for i in range(30)}, None, 700) for step in (37, 41)]
    diagram = compile_diagram(free([2] * 30, rules))
    needed = cost(diagram)
    with pytest.raises(TooMuchError, match="additions"):
        exact_count(diagram, most_work=needed.work / 2)
    with pytest.raises(TooMuchError, match="bytes"):
        exact_count(diagram, most_memory=1e4)


def test_a_sum_too_fine_for_any_grid_is_refused() -> None:
    rule = Linear({i: ints(0, 2**60 + i, 0) for i in range(3)}, None, 2**61)
    with pytest.raises(TooMuchError, match="fine"):
        exact_count(compile_diagram(free([2] * 3, [rule])))


def test_a_rule_that_is_no_sum_is_refused() -> None:
    class Anything:
        def bounds(self, low: Any, high: Any) -> tuple[Any, Any]:
            return np.ones(1, np.bool_), np.zeros(1, np.bool_)

        def holds(self, folds: Sequence[int]) -> bool:
            return True

    rule = Wide((Fold(Gather.MAX, {0: ints(1, 2, 0)}, 0),), Anything())
    with pytest.raises(TooMuchError, match="no sum"):
        exact_count(compile_diagram(free([2, 2], [rule])))


@pytest.mark.thorough
@settings(max_examples=30, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(1, 3))
def test_several_sums_over_many_places_count_as_their_generating_function(seed: int, sums: int) -> None:
    """A dictionary from sums to ways, in Python integers, over more rows than any list could hold."""
    rng = np.random.default_rng(seed)
    places = 10
    weights = rng.integers(-3, 4, (places, 4, sums))
    ways: dict[tuple[int, ...], int] = {(0,) * sums: 1}
    for place in weights.tolist():
        after: dict[tuple[int, ...], int] = {}
        for total, number in ways.items():
            for step in place:
                key = tuple(a + b for a, b in zip(total, step, strict=True))
                after[key] = after.get(key, 0) + number
        ways = after
    bounds = [sorted(rng.integers(-11, 12, 2).tolist()) for _ in range(sums)]
    open_ = rng.integers(0, 3, sums)
    rules = []
    for axis, (low, high) in enumerate(bounds):
        table = {i: np.append(weights[i, :, axis], 0).astype(np.int64) for i in range(places)}
        rules.append(Linear(table, None if open_[axis] == 0 else low, None if open_[axis] == 1 else high))
    expected = sum(
        number
        for total, number in ways.items()
        if all(
            (rule.low is None or rule.low <= value) and (rule.high is None or value <= rule.high)
            for value, rule in zip(total, rules, strict=True)
        )
    )
    assert exact_count(compile_diagram(free([4] * places, rules))) == expected


@pytest.mark.thorough
@pytest.mark.parametrize("sums", [40, 200])
def test_so_many_sums_that_no_number_holds_their_cells_are_too_much(sums: int) -> None:
    rules = [
        Linear({n: ints(0, 7919 * (n + 1) * (k + 1) % 10**6 + 1, 0) for n in range(20)}, None, 6 * 10**6)
        for k in range(sums)
    ]
    diagram = compile_diagram(free([2] * 20, rules))
    with pytest.raises(TooMuchError):
        cost(diagram)
    with pytest.raises(TooMuchError):
        exact_count(diagram)


def test_the_height_of_many_sums_is_finite() -> None:
    rules = [Linear({n: ints(0, 10**6 + k, 0) for n in range(20)}, None, 10**7) for k in range(100)]
    to_count = counting(compile_diagram(free([2] * 20, rules)))
    assert isinstance(to_count, Counting)
    before, after = heights(to_count.layers, to_count.sums)
    assert all(isfinite(height) for height in (*before, *after))
