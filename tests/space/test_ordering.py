from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from dse.space.flat import Clause, FlatSpace, Rule, Table, Variable
from dse.space.methods.mdd.diagram import compile_diagram, count
from dse.space.methods.mdd.growth import TooWideError
from dse.space.methods.mdd.ordering import compile_best, proposed


def shuffled_chain(length: int, seed: int) -> FlatSpace:
    """Neighbours of a chain must differ; the file names its places in any order."""
    place = np.random.default_rng(seed).permutation(length).tolist()
    values = ("a", "b", "c")
    differ = ~np.eye(4, dtype=np.bool_)
    rules: list[Rule] = []
    for one, other in pairwise(place):
        rules.append(Table((min(one, other), max(one, other)), differ))
    return FlatSpace("chain", tuple(Variable(f"x{n}", values) for n in range(length)), (), tuple(rules))


@pytest.mark.parametrize("seed", range(5))
def test_a_chain_named_in_any_order_is_compiled(seed: int) -> None:
    space = shuffled_chain(60, seed)
    with pytest.raises(TooWideError):
        compile_diagram(space, most_nodes=20_000)
    assert count(compile_best(space, most_nodes=20_000)) == 3 * 2**59


def test_the_order_of_the_file_is_kept_where_it_fits() -> None:
    space = shuffled_chain(8, 0)
    assert compile_best(space).order == tuple(range(8))


def test_what_no_order_makes_narrow_is_given_up() -> None:
    # A random graph of degree 6 has no small cut.
    draw = np.random.default_rng(1)
    pairs = {tuple(sorted(draw.choice(60, 2, replace=False).tolist())) for _ in range(180)}
    not_both = np.array([[True, True, False], [True, False, False], [False, False, False]])
    rules = tuple(Table((one, other), not_both) for one, other in sorted(pairs))
    space = FlatSpace("tangle", tuple(Variable(f"x{n}", ("a", "b")) for n in range(60)), (), rules)
    with pytest.raises(TooWideError):
        compile_best(space, most_nodes=2_000)


@settings(max_examples=100, deadline=None)
@given(st.data())
def test_proposed_orders_name_all_variables_and_parents_first(data: st.DataObject) -> None:
    variables: list[Variable] = []
    for number in range(data.draw(st.integers(0, 9))):
        parent = (data.draw(st.integers(0, number - 1)), 0) if number and data.draw(st.booleans()) else None
        variables.append(Variable(f"x{number}", ("a", "b"), parent))
    rules: list[Rule] = []
    for _ in range(data.draw(st.integers(0, 6)) if variables else 0):
        scope = sorted(data.draw(st.sets(st.sampled_from(range(len(variables))), min_size=1, max_size=4)))
        rules.append(Clause(tuple((number, np.array([True, False, False])) for number in scope)))
    space = FlatSpace("any", tuple(variables), (), tuple(rules))
    expected = count(compile_diagram(space))
    for order in proposed(space):
        place = {number: layer for layer, number in enumerate(order)}
        assert sorted(order) == list(range(len(variables)))
        assert all(v.parent is None or place[v.parent[0]] < place[n] for n, v in enumerate(variables))
        # compile_diagram gives the same rows in any order.
        assert count(compile_diagram(space, order)) == expected
