"""The engine and OR-tools CP-SAT must find the same optima; neither knows of the other."""

from __future__ import annotations

import random
from dataclasses import replace

import numpy as np
from cpsat import optimum, satisfiable
from hypothesis import given, settings, strategies as st
from random_spaces import design_spaces

from dse.space.flat import Clause, FlatSpace, Ints, Linear, Rule, Table, Variable, Wide
from dse.space.lowering import flatten
from dse.space.methods.listing.blocks import first
from dse.space.methods.mdd.diagram import compile_diagram
from dse.space.methods.optimum.optimizer import best, sums


@settings(max_examples=50, deadline=None)
@given(space=design_spaces(), numbers=st.data())
def test_cpsat_agrees_with_the_engine_on_random_spaces(space: object, numbers: st.DataObject) -> None:
    flat = flatten(space)
    flat = replace(flat, rules=tuple(rule for rule in flat.rules if not isinstance(rule, Wide)))
    entry = st.integers(-5, 9)
    weights = {
        number: np.array([*numbers.draw(st.lists(entry, min_size=len(v.values), max_size=len(v.values))), 0], np.int64)
        for number, v in enumerate(flat.variables)
    }
    diagram = compile_diagram(flat)
    for largest in (False, True):
        expected = best(diagram, weights, 1, largest=largest)
        found = optimum(flat, weights, largest=largest)
        assert (found and found[1],) == (expected.values or (None,))
        assert found is None or sums(weights, found[0][None]).tolist() == [found[1]]
    assert satisfiable(flat) is (first(diagram) is not None)


def middling() -> tuple[FlatSpace, list[dict[int, Ints]]]:
    """24 places of 6, of which every third exists under a choice of the one before; neighbours fit, two sums."""
    draw = random.Random(7)  # noqa: S311  # reproducible, not secret
    names = tuple("abcdef")
    variables = tuple(Variable(f"p{n}", names, (n - 1, 2) if n % 3 == 2 else None) for n in range(24))
    weigh = [{n: np.array([*draw.choices(range(1, 30), k=6), 0], np.int64) for n in range(24)} for _ in range(3)]
    rules: list[Rule] = [Linear(weigh[0], None, 200), Linear(weigh[1], 260, None)]
    for n in range(23):
        allowed = np.array([[draw.random() < 0.7 for _ in range(7)] for _ in range(7)])
        allowed[-1] = allowed[:, -1] = True
        rules.append(Table((n, n + 1), allowed))
    masks = [np.array([draw.random() < 0.3 for _ in range(6)] + [False]) for _ in range(12)]
    rules += [Clause(tuple((n, masks[(n + m) % 12]) for n in range(m, m + 8))) for m in range(0, 16, 4)]
    return FlatSpace("middling", variables, (), tuple(rules)), weigh


def test_cpsat_agrees_with_the_engine_on_a_space_of_ten_to_the_fourteen() -> None:
    flat, weigh = middling()
    diagram = compile_diagram(flat)
    for weights in weigh:
        for largest in (False, True):
            found = optimum(flat, weights, largest=largest)
            assert found
            assert best(diagram, weights, 1, largest=largest).values == (found[1],)


def test_a_space_without_any_decision_has_one_row_or_none() -> None:
    nothing = FlatSpace("nothing", (), (), ())
    assert satisfiable(nothing)
    assert not satisfiable(nothing.having(Table((), np.array(False))))
    assert not satisfiable(nothing.having(Linear({}, 1, None)))
