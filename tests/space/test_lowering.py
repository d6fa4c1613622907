"""Which rules a constraint becomes: tables, clauses and sums where that is exact, else a rule with a judge."""

from __future__ import annotations

from fractions import Fraction
from unittest.mock import patch

import numpy as np
import pytest
from random_spaces import folded, holding, rows_of

from dse.domain.component import Component, Interface
from dse.domain.design import Alternative, Compound, Constraint, DesignSpace, Optional, Part
from dse.domain.expression import Binary, Chosen, Expression
from dse.errors import DseError, Location
from dse.expression.parse import parse_expression
from dse.space.flat import Clause, Linear, Table, Variable, Wide
from dse.space.language.evaluate import compile_in
from dse.space.language.places import Places
from dse.space.lowering import clauses, flatten
from dse.units import parse_quantity

ANY = Interface("any", ())
HERE = Location("designs/car.yaml", 3, 10)


def part(name, **properties):
    return Part(Component(name, ANY, properties={key: parse_quantity(text) for key, text in properties.items()}))


def space(parts, *texts):
    constraints = tuple(Constraint(f"c{n}", parse_expression(text, HERE)) for n, text in enumerate(texts))
    return DesignSpace("test", Compound("test", parts), constraints)


def options(*numbers):
    return Alternative(tuple(part(f"n{number}", cost=f"{number} EUR", load=number) for number in numbers))


def places(text, count=4):
    """Places a, b, … of four alternatives each, and an optional z, under one constraint."""
    parts = {name: options("1", "2", "3.5", "4") for name in "abcdefgh"[:count]}
    return space({**parts, "z": Optional(part("n9", cost="9 EUR", load="9"))}, text)


def kinds(text, count=4):
    flat = flatten(places(text, count), most_cells=0)
    agree(flat, places(text, count))
    return [type(rule) for rule in flat.rules]


def agree(flat, made):
    rows = rows_of(flat)
    for number, constraint in enumerate(made.constraints):
        rule = compile_in(constraint.rule, Places(made))
        expected = [rule.outcome(flat.choices(row)) is not False for row in rows]
        holds = np.ones(len(rows), bool)
        for own in flat.only([number]).rules:
            holds &= holding(own, rows)
        assert holds.tolist() == expected


def test_variables_are_the_decisions_and_know_what_they_hang_below():
    inner = {"x": Alternative((part("p"), part("q")))}
    made = space(
        {
            "drive": Alternative((Compound("h", inner, (), ANY), Compound("i", inner, (), ANY), part("p"))),
            "rear": Optional(part("p")),
        }
    )
    assert flatten(made).variables == (
        Variable("drive", ("h", "i", "p")),
        Variable("drive.x", ("p", "q"), (0, 0)),
        Variable("drive.x", ("p", "q"), (0, 1)),
        Variable("rear", ("p", None)),
    )


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("true", []),
        ("sum(cost) >= 0 EUR", []),
        ("sum(cost) <= 1 EUR", [Table]),
        ("a is n1", [Table]),
        ("a is n1 implies b is n2", [Table]),
        ("a is n1 and b is n2", [Table, Table]),
        ("not (a is n1 or b is n2)", [Table, Table]),
        ("a is n1 implies b is n2 or z is present", [Clause]),
        ("a is n1 iff (b is n2 and c is n2)", [Table, Table, Clause]),
        ("same_choice(a, b)", [Table]),
        ("sum(cost) <= 10 EUR", [Linear]),
        ("sum(cost) between 8 EUR and 10 EUR", [Linear]),
        ("sum(cost) == 8 EUR", [Linear]),
        ("sum(cost) != 8 EUR", [Wide]),
        ("2 * sum(cost) - 3 * a.cost / 2 < sum(cost, b) + 20 EUR", [Linear]),
        ("count(cost) == 4", [Table]),
        ("mean(cost) <= 3 EUR", [Linear]),
        ("mean(cost) > 3 EUR", [Linear]),
        ("sum(cost) / sum(load) <= 1.5 EUR", []),
        ("sum(cost) / (1 + sum(load)) <= 0.9 EUR", [Linear]),
        ("sum(cost, a) / max(load, a) <= 0.9 EUR", [Table]),
        ("max(cost) <= 4 EUR", [Table]),
        ("max(cost) >= 4 EUR", [Clause]),
        ("min(cost) >= 2 EUR", [Table] * 4),
        ("min(cost) <= 1 EUR", [Clause]),
        ("max(cost, z) <= 4 EUR", [Table]),
        ("at_least(2, a is n1, b is n1, c is n1, d is n1)", [Linear]),
        ("at_most(1, a is n1, b is n1, c is n1, z is absent)", [Linear]),
        ("exactly(2, a is n1, b is n1, c is n1)", [Linear]),
        ("at_least(1, a is n1, b is n1, c is n1)", [Clause]),
        ("a is n1 implies sum(cost) <= 9 EUR", [Wide]),
        ("a.cost * b.cost <= 9 EUR^2", [Table]),
        ("sum(cost) * sum(load) <= 99 EUR", [Wide]),
        ("product(load) <= 50", [Wide]),
        ("if z is present then sum(cost) <= 20 EUR else sum(cost) <= 9 EUR", [Wide, Wide]),
    ],
)
def test_a_constraint_becomes_the_simplest_rules_that_are_exact(text, expected):
    assert kinds(text) == expected


def test_sums_are_whole_numbers_in_the_coarsest_unit_that_fits():
    (rule,) = flatten(places("sum(cost) < 10.2 EUR"), most_cells=0).rules
    assert isinstance(rule, Linear)
    assert rule.scale == Fraction(1, 2)
    assert rule.weights[0].tolist() == [0, 2, 5, 6, 0]
    assert rule.weights[4].tolist() == [18, 0, 0]
    assert (rule.low, rule.high) == (None, 12)


def test_a_narrow_rule_is_one_table_whatever_it_says():
    (rule,) = flatten(places("a.cost * b.cost <= 4 EUR^2 and (a is n1 xor sum(cost, b) == 2 EUR)")).rules
    assert isinstance(rule, Table)
    assert rule.scope == (0, 1)
    assert rule.allowed[:-1, :-1].tolist() == [
        [True, False, True, True],
        [False, True, False, False],
        [False, False, False, False],
        [False, False, False, False],
    ]


def test_what_cannot_hold_allows_nothing():
    (rule,) = flatten(places("sum(cost) <= 0.5 EUR")).rules
    assert isinstance(rule, Table)
    assert rule.scope == ()
    assert not rule.allowed


def test_two_architectures_with_parts_of_the_same_name_are_told_apart():
    inner = {"x": Alternative((part("p", cost="1 EUR"), part("q", cost="2 EUR")))}
    drive = Alternative(
        (Compound("h", inner, (), ANY), Compound("i", {**inner, "y": part("p", cost="5 EUR")}, (), ANY))
    )
    made = space(
        {"drive": drive, "rear": options("1", "2")},
        "sum(cost) == 7 EUR",
        "drive.x.cost < rear.cost",
        "same_choice(drive.x, drive.y)",
        "drive.x is q implies rear is n1",
    )
    for most_cells in (4096, 0):
        agree(flatten(made, most_cells), made)


def test_numbers_of_more_digits_than_a_machine_word_has_are_still_exact():
    one, two, five = (f"{number}.{'0' * 30}{end}" for number, end in ((1, 1), (2, 3), (5, 8)))
    made = space(
        {name: Alternative(tuple(part(f"n{text[0]}", load=text) for text in (one, two, five))) for name in "abc"},
        f"sum(load) <= {one} + {two} + {five}",
        f"sum(load) + a.load < {one} + {two} + {five}",
        f"max(load) - min(load) >= {five} - {two}",
        f"product(load) > {one} * {two} * {five}",
        f"product(load) >= {one} * {two} * {five}",
    )
    with patch.object(clauses, "MOST_CLAUSES", 1):
        flat = flatten(made, most_cells=0)
    assert all(isinstance(rule, Wide) for rule in flat.rules)
    agree(flat, made)
    rows = rows_of(flat)
    for rule in flat.wides():
        holds = holding(rule, rows)
        folds = [np.array(folded(fold, rows), np.int64) for fold in rule.folds]
        for end in range(1, len(rows) + 1):
            some = slice(max(0, end - 5), end)
            (may_hold,), (may_fail,) = rule.judge.bounds(
                [fold[some].min(keepdims=True) for fold in folds], [fold[some].max(keepdims=True) for fold in folds]
            )
            assert may_hold or not holds[some].any()
            assert may_fail or holds[some].all()


def test_a_division_by_zero_is_refused_only_by_those_who_meet_it():
    made = places("1 EUR / (a.cost - 2 EUR) < sum(load)")
    (rule,) = flatten(made).rules
    assert isinstance(rule, Wide)
    rows = rows_of(flatten(made))
    for row, folds in zip(rows, zip(*(folded(fold, rows) for fold in rule.folds), strict=True), strict=True):
        if row[0] == 1:
            with pytest.raises(DseError, match="division by zero") as refused:
                rule.judge.holds(folds)
            assert refused.value.problems[0].where == HERE
        else:
            rule.judge.holds(folds)


def test_a_division_by_zero_that_nothing_avoids_is_refused_at_once():
    with pytest.raises(DseError, match="division by zero"):
        flatten(places("1 / 0 > 1"))


def test_every_constraint_that_makes_no_sense_is_reported():
    with pytest.raises(DseError) as refused:
        flatten(space({"a": options("1", "2")}, "a is n7", "true", "sum(cost) < 1 kg"))
    assert len(refused.value.problems) == 2


def test_a_long_chain_of_alternatives_is_one_clause():
    parts = {f"p{number}": Optional(part("n")) for number in range(3000)}
    text = "p0 is present"
    chain = parse_expression(text).root
    for number in range(1, 3000):
        chain = Binary("or", chain, Chosen(f"p{number}", ("present",), (0, 1)), (0, 1))
    made = DesignSpace("long", Compound("long", parts), (Constraint("any", Expression(text, chain)),))
    (rule,) = flatten(made).rules
    assert isinstance(rule, Clause)
    assert [variable for variable, _ in rule.literals] == list(range(3000))


@pytest.mark.thorough
def test_a_decision_of_more_values_than_a_row_can_hold_is_refused_by_name():
    option = part("option")
    space = DesignSpace("wide", Compound("wide", {"shelf": Alternative((option,) * 32_767)}), where=HERE)
    with pytest.raises(DseError, match=r"car.yaml:3:10: 'shelf' has 32,767 alternatives.*at most 32,766"):
        flatten(space)
    fitting = DesignSpace("wide", Compound("wide", {"shelf": Alternative((option,) * 32_766)}), where=HERE)
    assert len(flatten(fitting).variables[0].values) == 32_766
