"""An objective over folds or weights has the value of its expression."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings, strategies as st
from random_spaces import bare_space, folded, number, rows_of

from dse.domain.component import Component, Interface
from dse.domain.design import Alternative, Compound, DesignSpace, Optional, Part
from dse.errors import DseError
from dse.expression.parse import parse_expression
from dse.space.flat import FlatSpace, Rows
from dse.space.language.evaluate import compile_value
from dse.space.lowering import flatten
from dse.space.lowering.objective import FoldedObjective, LinearObjective, objective
from dse.units import parse_quantity

ANY = Interface("any", ())


def part(name, cost, mass):
    return Part(Component(name, ANY, properties={"cost": parse_quantity(cost), "mass": parse_quantity(mass)}))


SMALL, LARGE = part("small", "1.5 EUR", "2 kg"), part("large", "4 EUR", "9 kg")
CAR = DesignSpace("car", Compound("car", {"a": Alternative((SMALL, LARGE)), "b": Optional(LARGE), "c": SMALL}))


def weighed(found: LinearObjective, row: np.ndarray) -> Fraction:
    return found.value(sum(int(values[row[variable]]) for variable, values in found.weights.items()))


def test_a_sum_has_whole_weights_in_its_coarsest_unit():
    found = objective(CAR, parse_expression("2 * cost + a.cost"))
    assert isinstance(found, LinearObjective)
    assert {at: values.tolist() for at, values in found.weights.items()} == {0: [0, 15, 0], 1: [16, 0, 0]}
    assert (found.constant, found.scale) == (Fraction("7.5"), Fraction(1, 2))
    assert found.dimension == (("currency", 1),)
    assert weighed(found, np.array([1, 0])) == 2 * (4 + 4 + Fraction("1.5")) + 4


@pytest.mark.parametrize(
    "text", ["cost / mass", "max(cost)", "b.cost", "cost * cost", "if b is absent then cost else mean(cost)"]
)
def test_what_is_no_sum_is_worked_out_from_folds(text):
    assert isinstance(objective(CAR, parse_expression(text)), FoldedObjective)


@pytest.mark.parametrize(
    ("text", "what"), [("cost <= 3 EUR", "expected a number"), ("cost + mass", "cannot add"), ("size", "unknown name")]
)
def test_an_objective_that_is_no_number_is_refused(text, what):
    with pytest.raises(DseError, match=what):
        objective(CAR, parse_expression(text))


def values(space: DesignSpace, flat: FlatSpace, rows: Rows, text: str) -> list[Fraction | str | None]:
    evaluate = compile_value(parse_expression(text), space)
    found: list[Fraction | str | None] = []
    for row in rows:
        try:
            value = evaluate(flat.choices(row))
        except DseError:
            found.append("fails")
            continue
        found.append(None if value is None or isinstance(value, str) else Fraction(value))
    return found


@settings(deadline=None, max_examples=60, suppress_health_check=list(HealthCheck))
@given(st.data())
def test_an_objective_has_the_value_of_its_expression_and_lies_within_its_bounds(data):
    space = bare_space(data.draw, most=200)
    text = number(data.draw, space)
    try:
        found = objective(space, parse_expression(text))
    except DseError:
        assume(False)
        raise
    flat = flatten(space)
    rows = rows_of(flat)
    expected = values(space, flat, rows, text)
    if isinstance(found, LinearObjective):
        assert [weighed(found, row) for row in rows] == expected
        return
    folds = [np.array(folded(fold, rows), np.int64) for fold in found.folds]
    group = data.draw(st.lists(st.integers(0, len(rows) - 1), min_size=1, max_size=5))
    assume(folds)
    low, high = found.bounds(
        [np.array([fold[group].min()]) for fold in folds], [np.array([fold[group].max()]) for fold in folds]
    )
    for row in group:
        value = expected[row]
        if value == "fails":
            with pytest.raises(DseError):
                found.value([int(fold[row]) for fold in folds])
            continue
        assert found.value([int(fold[row]) for fold in folds]) == value
        assert not isinstance(value, Fraction) or low[0] <= value <= high[0]
