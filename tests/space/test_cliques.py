"""Choices that exclude each other in pairs, whatever they are called: the same rows with sums in place of the pairs."""

from __future__ import annotations

import math
from itertools import combinations, product

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from dse.space.flat import FlatSpace, Linear, Table, Variable
from dse.space.lowering.cliques import with_cliques
from dse.space.methods.dnnf.order import decision_order
from dse.space.methods.engine import Engine
from dse.space.methods.listing.recheck import recheck
from dse.space.methods.mdd.growth import TooWideError


def forbidding(a: int, b: int, values: int, cells: list[tuple[int, int]]) -> Table:
    allowed = np.ones((values + 1, values + 1), np.bool_)
    for one, other in cells:
        allowed[one, other] = False
    return Table((a, b), allowed)


def places(number: int, values: int) -> tuple[Variable, ...]:
    """No two values of all places have the same name."""
    return tuple(Variable(f"p{n}", tuple(f"p{n}_{value}" for value in range(values))) for n in range(number))


def permuted(number: int, values: int) -> FlatSpace:
    """Places that are all different, where value v of place n is what (v + n) mod *values* is for the first one."""
    rules = tuple(
        forbidding(a, b, values, [((v - a) % values, (v - b) % values) for v in range(values)])
        for a, b in combinations(range(number), 2)
    )
    return FlatSpace("permuted", places(number, values), (), rules)


def test_places_whose_parts_have_other_names_are_all_different_by_sums() -> None:
    flat = permuted(12, 12)
    merged = with_cliques(flat)
    assert [type(rule) for rule in merged.rules] == [Linear] * 12
    assert Engine(flat).exact_count() == math.factorial(12)


@settings(max_examples=30, deadline=None)
@given(st.data())
def test_the_rows_stay_the_same_whatever_pairs_are_left_out_or_join_two_values_of_a_place(data: st.DataObject) -> None:
    number, values = 6, 6
    whole = permuted(number, values)
    left_out = data.draw(st.sets(st.integers(0, len(whole.rules) - 1), max_size=3))
    rules = [rule for at, rule in enumerate(whole.rules) if at not in left_out]
    cell = st.tuples(st.integers(0, values - 1), st.integers(0, values - 1))
    for _ in range(data.draw(st.integers(0, 3))):
        a, b = sorted(data.draw(st.sets(st.integers(0, number - 1), min_size=2, max_size=2)))
        rules.append(forbidding(a, b, values, data.draw(st.lists(cell, min_size=1, max_size=2))))
    flat = FlatSpace("some", whole.variables, (), tuple(rules))
    rows = np.array([*product(range(values), repeat=number)], np.int16)
    assert (recheck(with_cliques(flat)).valid(rows) == recheck(flat).valid(rows)).all()


def test_what_is_joined_too_closely_for_a_graph_is_refused_before_hours_are_spent() -> None:
    with pytest.raises(TooWideError):
        decision_order(301, [tuple(2 * boolean for boolean in range(1, 301))])
    assert sorted(decision_order(31, [tuple(2 * boolean for boolean in range(1, 31))])) == [*range(1, 31)]
