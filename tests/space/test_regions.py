"""The best under nonlinear objectives, with regions parted as far as they can be, against brute force."""

from __future__ import annotations

import random
from fractions import Fraction
from functools import partial

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings, strategies as st
from random_spaces import design_spaces, folded, holding, number, rows_of

from dse.domain.component import NO_INTERFACE, Component
from dse.domain.design import Alternative, Compound, DesignSpace, Part
from dse.errors import DseError
from dse.expression.parse import parse_expression
from dse.space.flat import FlatSpace, Ints, Linear, Variable
from dse.space.lowering import flatten
from dse.space.lowering.objective import FoldedObjective, objective
from dse.space.methods.budget import TooMuchError
from dse.space.methods.listing.blocks import first
from dse.space.methods.listing.walk import Rounds
from dse.space.methods.mdd.diagram import compile_diagram
from dse.space.methods.optimum import regions
from dse.space.methods.optimum.optimizer import Optimizer
from dse.space.methods.optimum.pareto import pareto
from dse.space.methods.optimum.regions import best_valued

QUIET = settings(max_examples=80, deadline=None, suppress_health_check=[HealthCheck.filter_too_much])


def valid_rows(flat: FlatSpace) -> np.ndarray:
    rows = rows_of(flat)
    keep = np.ones(len(rows), bool)
    for rule in flat.rules:
        keep &= holding(rule, rows)
    rows = rows[keep]
    return rows[np.lexsort((rows % 1000).T[::-1])] if rows.size else rows


def expected(flat: FlatSpace, lowered: FoldedObjective, most: int, largest: bool) -> list[tuple[Fraction, list[int]]]:
    rows = valid_rows(flat)
    folds = zip(*(folded(fold, rows) for fold in lowered.folds), strict=True) if lowered.folds else [()] * len(rows)
    values = [lowered.value(row) for row in folds]
    ranked = [(value, row) for value, row in zip(values, rows.tolist(), strict=True) if value is not None]
    return sorted(ranked, key=lambda pair: -pair[0] if largest else pair[0])[:most]


@QUIET
@given(
    design_spaces(most_constraints=2, most=400),
    st.data(),
    st.booleans(),
    st.integers(1, 6),
    st.sampled_from([0, 1, regions._TRIAL]),
)
@pytest.mark.thorough
def test_however_far_regions_are_parted_the_best_are_those_of_the_sorted_list(
    space: DesignSpace, data: st.DataObject, largest: bool, most: int, trial: int
) -> None:
    try:
        lowered = objective(space, parse_expression(number(data.draw, space)))
        assume(isinstance(lowered, FoldedObjective))
        flat = flatten(space)
        wanted = expected(flat, lowered, most, largest)
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(regions, "_TRIAL", trial)
            found = best_valued(compile_diagram(flat), lowered, most, largest=largest)
    except DseError:
        assume(False)
        raise
    assert list(zip(found.values, found.rows.tolist(), strict=True)) == wanted


def weigh(draw: random.Random, places: int, values: int) -> dict[int, Ints]:
    return {n: np.array([*draw.choices(range(1, 20), k=values), 0], np.int64) for n in range(places)}


def places(number: int, values: int) -> FlatSpace:
    return FlatSpace("places", tuple(Variable(f"p{n}", tuple("abcdefgh"[:values])) for n in range(number)), (), ())


@pytest.mark.parametrize("tightness", [0, 1, 2, 3])
def test_a_space_just_inside_its_bounds_is_found_not_to_be_empty(tightness: int) -> None:
    draw = random.Random(5)  # noqa: S311  # reproducible, not secret
    flat = places(40, 8)
    sums = [weigh(draw, 40, 8) for _ in range(3)]
    row = np.array([draw.randrange(8) if draw.random() < 0.1 * tightness else _lightest(sums, n) for n in range(40)])
    # The bounds are what one row comes to: it just keeps them all.
    rules = [Linear(w, None, sum(int(w[n][row[n]]) for n in range(40))) for w in sums]
    flat = flat.having(*rules)
    assert first(compile_diagram(flat), most_rounds=3000) is not None


def _lightest(sums: list[dict[int, Ints]], number: int) -> int:
    return min(range(8), key=lambda value: sum(int(weights[number][value]) for weights in sums))


def market_split() -> FlatSpace:
    """Four sums of 30 that must come to exactly half, as none do: no bound sees it (Cornuéjols and Dawande, 1998)."""
    draw = random.Random(3)  # noqa: S311  # reproducible, not secret
    sums = [{n: np.array([0, draw.randrange(100), 0], np.int64) for n in range(30)} for _ in range(4)]
    halves = [sum(int(values[1]) for values in weights.values()) // 2 for weights in sums]
    return places(30, 2).having(*(Linear(w, half, half) for w, half in zip(sums, halves, strict=True)))


def test_an_undecided_search_is_refused_not_guessed() -> None:
    diagram = compile_diagram(market_split())
    with pytest.raises(TooMuchError):
        first(diagram, most_rounds=5)


def test_a_pareto_set_beyond_its_budget_is_refused() -> None:
    draw = random.Random(1)  # noqa: S311  # reproducible, not secret
    flat = places(40, 8)
    objectives = [weigh(draw, 40, 8) for _ in range(3)]
    with pytest.raises(TooMuchError):
        pareto(partial(Optimizer, compile_diagram(flat), rounds=Rounds(60)), objectives)


def test_an_optimizer_gives_the_same_whatever_it_was_asked_before() -> None:
    draw = random.Random(2)  # noqa: S311  # reproducible, not secret
    sums = [weigh(draw, 20, 6) for _ in range(3)]
    diagram = compile_diagram(places(20, 6).having(Linear(sums[0], 150, 190)))
    asked = Optimizer(diagram, sums)
    for highs in ([None, 150, None], [170, None, 160], [None, 120, 300]):
        for factors in ([0, 1, 2], [1, 1, 1], [0, -1, 3]):
            fresh = Optimizer(diagram, sums).best(factors, 4, highs)
            again = asked.best(factors, 4, highs)
            assert again.values == fresh.values
            assert again.rows.tolist() == fresh.rows.tolist()


def test_where_the_objective_is_the_same_everywhere_the_best_come_as_in_the_list() -> None:
    space = DesignSpace(
        "two", Compound("two", {"p": Alternative(tuple(Part(Component(name, NO_INTERFACE)) for name in ("a", "b")))})
    )
    lowered = objective(space, parse_expression("sqrt(2)"))
    assert isinstance(lowered, FoldedObjective)
    found = best_valued(compile_diagram(flatten(space)), lowered, 2)
    assert found.rows.tolist() == [[0], [1]]
