"""The best, the Pareto set and the nearest configuration, against brute force."""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import assume, given, strategies as st
from question_spaces import EXAMPLES, asked, without_diagram
from random_spaces import ANY, number

from dse.domain.component import Component
from dse.domain.design import Alternative, Compound, DesignSpace, Part
from dse.errors import DseError
from dse.expression.parse import parse_expression
from dse.space.language.evaluate import compile_value
from dse.space.methods.engine import Engine
from dse.space.questions.nearest import nearest
from dse.space.questions.optimum import Aim, best_configurations, pareto_set
from dse.units import parse_quantity

SUMS = st.sampled_from(["sum(mass)", "sum(cost)", "sum(factor)", "sum(rate)", "2 * sum(mass) - 3 kg", "sum(rate) * 2"])


def values(found, expression):
    """The value of every valid row, None where it is undefined."""
    try:
        evaluate = compile_value(expression, found.space)
        kept = [choices for choices, holds in zip(found.choices, found.valid(), strict=True) if holds]
        return [None if (value := evaluate(choices)) is None else Fraction(value) for choices in kept], kept
    except DseError:
        assume(False)
        raise


def check_best(found, text, largest, most):
    aim = Aim(parse_expression(text), largest)
    worth, kept = values(found, aim.expression)
    ranked = [place for place, value in enumerate(worth) if value is not None]
    ranked.sort(key=lambda place: -worth[place] if largest else worth[place])
    best = best_configurations(found.space, found.engine, aim, most)
    assert [(dict(entry.choices), *entry.values) for entry in best] == [
        (kept[place], worth[place]) for place in ranked[:most]
    ]


@EXAMPLES
@given(asked(2), SUMS, st.booleans(), st.integers(1, 6))
def test_the_best_under_a_sum_are_the_first_of_the_sorted_list(found, text, largest, most):
    check_best(found, text, largest, most)


@EXAMPLES
@given(asked(2), SUMS, st.booleans(), st.integers(1, 6))
def test_without_a_diagram_the_best_are_as_good(found, text, largest, most):
    aim = Aim(parse_expression(text), largest)
    worth, kept = values(found, aim.expression)
    wide = without_diagram(found.engine)
    assume(wide.clausal.graph is not None)
    best = best_configurations(found.space, wide, aim, most)
    assert [entry.values[0] for entry in best] == sorted(worth, reverse=largest)[:most]
    reached = [dict(entry.choices) for entry in best]
    assert all(worth[kept.index(choices)] == entry.values[0] for choices, entry in zip(reached, best, strict=True))
    assert len({tuple(sorted(choices.items())) for choices in reached}) == len(reached)


@EXAMPLES
@given(asked(2), SUMS, SUMS, st.booleans(), st.integers(1, 6))
def test_the_best_under_a_quotient_are_the_first_of_the_sorted_list(found, above, below, largest, most):
    check_best(found, f"({above}) / ({below})", largest, most)


@EXAMPLES
@given(asked(2), st.data(), st.booleans(), st.integers(1, 6))
def test_the_best_under_anything_are_the_first_of_the_sorted_list(found, data, largest, most):
    check_best(found, number(data.draw, found.space), largest, most)


@EXAMPLES
@given(asked(2), st.lists(st.tuples(SUMS, st.booleans()), min_size=2, max_size=3))
def test_no_configuration_beats_a_point_of_the_pareto_set_and_none_is_missing(found, wanted):
    aims = [Aim(parse_expression(text), largest) for text, largest in wanted]
    columns = [values(found, aim.expression)[0] for aim in aims]
    signs = [-1 if aim.largest else 1 for aim in aims]
    assume(all(None not in column for column in columns))
    points = {tuple(s * v for s, v in zip(signs, row, strict=True)) for row in zip(*columns, strict=True)}
    best = {p for p in points if not any(q != p and all(a <= b for a, b in zip(q, p, strict=True)) for q in points)}
    front = pareto_set(found.space, found.engine, aims)
    reached = [tuple(s * v for s, v in zip(signs, entry.values, strict=True)) for entry in front]
    assert reached == sorted(best)


def distance(given_choices, other):
    """How many of the choices given are lost."""
    return sum(other.get(path) != choice for path, choice in given_choices.items())


@EXAMPLES
@given(asked(3), st.integers(0, 1_000_000))
def test_the_nearest_configuration_is_valid_and_loses_as_little_as_can_be(found, place):
    choices = found.choices[place % len(found.rows)]
    kept = [other for other, holds in zip(found.choices, found.valid(), strict=True) if holds]
    if not kept:
        with pytest.raises(DseError, match="no valid configuration"):
            nearest(found.engine, choices)
        return
    near = nearest(found.engine, choices)
    assert_is_nearest(found, choices, kept, near)
    wide = without_diagram(found.engine)
    if wide.clausal.graph is not None:
        assert_is_nearest(found, choices, kept, nearest(wide, choices))


def assert_is_nearest(found, choices, kept, near):
    assert dict(near.choices) in kept
    assert {c.path: (c.before, c.after) for c in near.changes} == {
        path: (choices.get(path), near.choices.get(path))
        for path in {*choices, *near.choices}
        if choices.get(path) != near.choices.get(path)
    }
    if choices in kept:
        assert dict(near.choices) == choices
    left_out = {v.path for v in found.engine.flat.variables if None in v.values} - set(choices)
    if not left_out:
        assert distance(choices, near.choices) == min(distance(choices, other) for other in kept)


def test_under_a_constant_the_first_of_the_list_are_the_best():
    parts = tuple(Part(Component(name, ANY, properties={"mass": parse_quantity("1 kg")})) for name in "abc")
    space = DesignSpace("flat", Compound("flat", {"p": Alternative(parts)}))
    found = best_configurations(space, Engine.of(space), Aim(parse_expression("abs(2 kg)")), 2)
    assert [(entry.choices["p"], *entry.values) for entry in found] == [("a", 2), ("b", 2)]


def test_the_only_design_of_a_space_without_choices_is_nearest_best_and_pareto_optimal():
    part = Part(Component("a", ANY, properties={"mass": parse_quantity("2 kg")}))
    space = DesignSpace("one", Compound("one", {"p": part}))
    engine = Engine.of(space)
    aims = [Aim(parse_expression("sum(mass)")), Aim(parse_expression("count(mass)"), True)]
    assert nearest(engine, {}).choices == {}
    assert [entry.values for entry in best_configurations(space, engine, aims[0], 2)] == [(2,)]
    assert [entry.values for entry in pareto_set(space, engine, aims)] == [(2, 1)]


def test_a_quotient_of_sums_is_ranked_where_no_list_could_be():
    names = [[f"c{place}{option}" for option in range(6)] for place in range(24)]
    parts = {
        f"p{place}": Alternative(
            tuple(
                Part(
                    Component(
                        name,
                        ANY,
                        properties={
                            "mass": parse_quantity(f"{1 + (7 * place + 3 * option) % 11} kg"),
                            "power": parse_quantity(f"{(5 * place + option * option) % 13} W"),
                        },
                    )
                )
                for option, name in enumerate(options)
            )
        )
        for place, options in enumerate(names)
    }
    space = DesignSpace("wide", Compound("wide", parts))
    engine = Engine.of(space)
    aim = Aim(parse_expression("sum(power) / sum(mass)"), largest=True)
    best = best_configurations(space, engine, aim, 3)
    # No single exchange makes the best one better.
    evaluate = compile_value(aim.expression, space)
    for place, options in enumerate(names):
        for other in options:
            assert evaluate({**best[0].choices, f"p{place}": other}) <= best[0].values[0]
    assert [entry.values[0] for entry in best] == sorted((entry.values[0] for entry in best), reverse=True)
