"""What a dealership offers, against the list of all configurations."""

from __future__ import annotations

import pytest
from hypothesis import assume, given, strategies as st
from question_spaces import EXAMPLES, answers
from random_spaces import design_spaces

from dse.domain.component import Component, Interface
from dse.domain.design import Alternative, Compound, Constraint, DesignSpace, Optional, Part
from dse.errors import DseError
from dse.expression.parse import parse_expression
from dse.space import Dealership, open_space
from dse.space.methods.engine import Engine
from dse.space.methods.mdd.growth import TooWideError
from dse.units import parse_quantity


def part(name, cost=1):
    return Part(Component(name, Interface("any", ()), properties={"cost": parse_quantity(f"{cost} EUR")}))


def of(*rules, parts=None):
    constraints = tuple(Constraint(f"c{n}", parse_expression(rule), f"so {n}") for n, rule in enumerate(rules))
    parts = parts or {
        "s": Alternative((part("a", 1), part("b", 2), part("c", 3))),
        "p": Alternative((part("bev", 7), Compound("hybrid", {"box": Alternative((part("d", 4), part("e", 5)))}))),
        "o": Optional(part("w", 1)),
    }
    space = DesignSpace("car", Compound("car", parts), constraints)
    return open_space(space).dealership()


def names(offer, path):
    return {choice.name: choice.is_possible for choice in offer.point(path).choices}


@st.composite
def spaces_and_choices(draw):
    space = draw(design_spaces(most=200))
    known = answers(space)
    pairs = sorted({(v.path, name or "absent") for v in known.engine.flat.variables for name in v.values})
    picked = draw(st.lists(st.sampled_from(pairs), max_size=3)) if pairs else []
    return known, dict(picked)


@EXAMPLES
@given(spaces_and_choices())
def test_an_offer_says_what_the_list_of_configurations_says(case):
    known, chosen = case
    valid = [choices for choices, is_valid in zip(known.choices, known.valid(), strict=True) if is_valid]
    existing = [
        {v.path for v, value in zip(known.engine.flat.variables, row, strict=True) if value >= 0}
        for row, is_valid in zip(known.rows, known.valid(), strict=True)
        if is_valid
    ]
    lines = list(zip(valid, existing, strict=True))
    try:
        offer = open_space(known.space).dealership().offer(chosen)
    except DseError as error:
        assume("different places" in str(error))
        return

    def having(wanted):
        return [line for line in lines if all(line[0].get(path, "absent") == name for path, name in wanted.items())]

    def makes(line, path, name):
        """The decision exists and is made so."""
        return path in line[1] and line[0].get(path, "absent") == name

    def elsewhere(path):
        return {place: name for place, name in chosen.items() if not f"{place}.".startswith(f"{path}.")}

    left = having(chosen)
    assert (offer.left, offer.total) == (len(left), len(valid))
    assert bool(offer.configuration) == (len(left) == 1)
    if len(left) == 1:
        assert offer.choices == left[0][0]
    if left:
        assert {point.path for point in offer.points} == {*chosen} | {path for line in left for path in line[1]}
    for point in offer.points:
        seen = {line[0].get(point.path, "absent") for line in left if point.path in line[1]}
        assert point.is_certain == all(point.path in line[1] for line in left)
        if point.path in chosen:
            assert (point.chosen, point.implied) == (chosen[point.path], "")
        elif left:
            assert point.implied == (next(iter(seen)) if point.is_certain and len(seen) == 1 else "")
        for choice in point.choices:
            would = [line for line in having(elsewhere(point.path)) if makes(line, point.path, choice.name)]
            assert choice.is_possible == bool(would)
            assert bool(choice.texts()) != choice.is_possible
            told = would and choice.name not in (point.chosen, point.implied)
            gone = {
                (other.path, each.name)
                for other in offer.points
                for each in other.choices
                if told and other.path != point.path and other.path not in chosen
                if any(makes(line, other.path, each.name) for line in left)
                if not any(makes(line, other.path, each.name) for line in would)
            }
            assert {*choice.rules_out} == gone


@EXAMPLES
@given(spaces_and_choices())
def test_reasons_exclude_together_and_none_of_them_alone_is_too_many(case):
    known, chosen = case
    try:
        offer = open_space(known.space).dealership().offer(chosen)
    except DseError:
        return
    paths = {v.path for v in known.engine.flat.variables}
    numbers = {constraint.name: n for n, constraint in enumerate(known.space.constraints)}
    rows = [
        (
            {p: c.get(p, "absent") for p in paths},
            {v.path for v, x in zip(known.engine.flat.variables, r, strict=True) if x >= 0},
            h,
        )
        for c, r, h in zip(known.choices, known.rows, known.holds, strict=True)
    ]

    def is_left(wanted, path, name, owners):
        return any(
            all(c[p] == n for p, n in wanted.items()) and path in e and c[path] == name and h[list(owners)].all()
            for c, e, h in rows
        )

    for point in offer.points:
        others = {p: n for p, n in chosen.items() if not f"{p}.".startswith(f"{point.path}.")}
        for choice in point.choices:
            if not choice.is_possible:
                owners = [numbers[each.name] for each in choice.because]
                assert not is_left(others, point.path, choice.name, owners)
                for each in owners:
                    assert is_left(others, point.path, choice.name, [o for o in owners if o != each])


@EXAMPLES
@given(spaces_and_choices())
def test_totals_are_the_least_and_the_greatest_of_what_is_left(case):
    known, chosen = case
    try:
        offer = open_space(known.space).dealership().offer(chosen)
        listed = [*open_space(known.space, [f"{p}={n}" for p, n in chosen.items()]).configurations()]
    except DseError:
        return
    for total in offer.totals:
        sums = [configuration.total(total.name) for configuration in listed]
        assert (total.low, total.high) == pytest.approx((min(sums), max(sums)), abs=1e-9)


def test_a_choice_can_be_changed_and_takes_what_is_inside_with_it():
    offer = of("s is a implies p is bev").offer({"p": "hybrid", "p.box": "d"})
    assert names(offer, "p") == {"bev": True, "hybrid": True}
    assert names(offer, "s") == {"a": False, "b": True, "c": True}
    assert offer.point("s").choices[0].texts() == ("so 0",)


def test_what_follows_by_itself_is_told():
    offer = of("s is a implies o is absent").offer({"s": "a"})
    assert offer.point("o").implied == "absent"
    assert not offer.point("p").implied


def test_where_nothing_is_left_the_way_out_is_possible():
    offer = of("s is a implies p is bev").offer({"s": "a", "p": "hybrid"})
    assert (offer.left, offer.texts(), offer.totals) == (0, ("so 0",), ())
    assert names(offer, "s") == {"a": False, "b": True, "c": True}


def test_choices_that_exclude_each_other_without_a_constraint_say_so():
    offer = of().offer({"p": "bev", "p.box": "d"})
    assert offer.texts() == ("the other choices leave no place for it",)


def test_an_unknown_choice_is_refused_by_name():
    with pytest.raises(DseError, match="'s' cannot be 'x'"):
        of().offer({"s": "x"})
    with pytest.raises(DseError, match="no decision 'q'"):
        of().offer({"q": "x"})


def test_a_space_that_is_too_large_is_refused_by_name(monkeypatch):
    def too_wide(*_):
        raise TooWideError

    space = of().space
    monkeypatch.setattr("dse.space.methods.mdd.expand.expand", too_wide)
    with pytest.raises(DseError, match="'car' is too large"):
        Dealership(space, Engine.of(space))


def test_an_offer_is_plain_data():
    data = of("s is a implies o is absent").offer({"s": "a", "p": "bev"}).data()
    assert (data["left"], data["configuration"], data["choices"]) == (
        "1",
        data["configuration"],
        {"s": "a", "p": "bev"},
    )
    assert data["points"][2]["implied"] == "absent"
    assert data["totals"] == [{"name": "cost", "title": "cost", "unit": "EUR", "low": 8.0, "high": 8.0}]
