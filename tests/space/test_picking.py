"""Choosing step by step, against the list of configurations that the picks leave."""

from __future__ import annotations

from hypothesis import given, settings, strategies as st

from dse.domain.component import Component, Interface
from dse.domain.design import Alternative, Compound, Constraint, DesignSpace, Optional, Part
from dse.expression.parse import parse_expression
from dse.space.lowering import flatten
from dse.space.methods import engine as engines
from dse.space.methods.engine import Engine
from dse.space.methods.mdd.growth import TooWideError
from dse.space.methods.tally import Tally
from dse.space.output.sums import property_sums
from dse.space.questions.picking import Picking
from dse.units import parse_quantity


def part(name, cost):
    return Part(Component(name, Interface("any", ()), properties={"cost": parse_quantity(f"{cost} EUR")}))


HYBRID = Compound(
    "hybrid",
    {"engine": Alternative((part("d", 4), part("e", 5))), "motor": Optional(part("m", 2)), "box": part("f", 1)},
)
PARTS = {
    "s": Alternative((part("a", 1), part("b", 2), part("c", 3))),
    "p": Alternative((part("bev", 7), HYBRID)),
    "o": Optional(part("w", 1)),
}
S, P, ENGINE, MOTOR, O = range(5)  # noqa: E741  # the places are called so


def space(*rules):
    constraints = tuple(Constraint(rule, parse_expression(rule)) for rule in rules)
    return DesignSpace("car", Compound("car", PARTS), constraints)


def picking(*rules):
    return Picking(Engine.of(space(*rules)))


def forced(picked):
    """What follows by itself, by decision."""
    return {number: picked.settled(number) for number in {*picked.decisions} - {*picked.open} - {*dict(picked.picks)}}


def left(picked):
    rows = picked.engine.rows(1000)
    for variable, value in picked.picks:
        rows = rows[rows[:, variable] == value]
    return rows


def test_counts_are_what_would_be_left():
    free = picking()
    assert free.left == Tally(3 * 5 * 2)
    assert [(o.name, o.tally.value) for o in free.options(P)] == [("bev", 6), ("hybrid", 24)]
    assert [(o.name, o.tally.value) for o in free.pick(P, 0).options(O)] == [("w", 3), (None, 3)]


def test_nested_decisions_appear_when_their_architecture_is_chosen():
    assert picking().decisions == (S, P, O)
    assert picking().pick(P, 1).decisions == (S, P, ENGINE, MOTOR, O)


def test_what_follows_is_filled_in_and_marked_as_forced():
    chosen = picking("s is a implies p is hybrid", "p is hybrid implies o is absent").pick(S, 0)
    assert forced(chosen) == {P: 1, O: 1}
    assert chosen.open == (ENGINE, MOTOR)
    assert not chosen.options(P)[0].is_possible
    assert chosen.options(P)[0].tally == Tally(0)


def test_another_pick_takes_the_place_of_the_first_and_drops_what_hung_below_it():
    chosen = picking().pick(P, 1).pick(ENGINE, 0).pick(S, 2)
    assert chosen.pick(P, 0).picks == ((S, 2), (P, 0))
    assert chosen.unpick(ENGINE).picks == ((P, 1), (S, 2))
    assert chosen.unpick(P).picks == ((S, 2),)
    # The options of a decision that is picked are counted as if it were open.
    assert [o.tally.value for o in chosen.options(S)] == [4, 4, 4]
    assert [o.tally.value for o in chosen.options(P)] == [2, 4]


def test_when_all_is_settled_a_single_configuration_is_left():
    chosen = picking("sum(cost) <= 8 EUR", "p is bev").pick(S, 0)
    assert chosen.is_complete
    assert chosen.first().choices == {"s": "a", "p": "bev"}


def test_sums_range_over_what_is_left():
    a_space = space("sum(cost) <= 9 EUR")
    chosen = Picking(Engine.of(a_space), property_sums(a_space)).pick(P, 1)
    (found,) = chosen.ranges()
    assert (found.low, found.high, found.exact) == (6.0, 9.0, True)


def test_where_the_sums_do_not_fit_into_the_layers_counts_and_ranges_say_that_they_are_estimates(monkeypatch):
    def too_wide(*_):
        raise TooWideError

    monkeypatch.setattr("dse.space.methods.mdd.expand.expand", too_wide)
    monkeypatch.setattr(engines.Engine, "count", lambda self, **_: Tally(15, False, 13, 16))
    a_space = space("sum(cost) <= 9 EUR", "sum(cost) >= 7 EUR")
    # Tables of one cell at most: the sum stays a sum.
    chosen = Picking(Engine(flatten(a_space, 1)), property_sums(a_space)).pick(P, 1)
    rows = left(chosen)
    assert len(rows) == 14
    for option in chosen.options(S):
        number = int((rows[:, S] == option.value).sum())
        assert option.is_possible is (number > 0)
        assert option.tally.exact or option.tally.low <= number <= option.tally.high
    (found,) = chosen.ranges()
    assert not found.exact
    assert (found.low, found.high) == (7.0, 9.0)


@settings(max_examples=60, deadline=None)
@given(st.data())
def test_any_walk_agrees_with_the_list(data):
    rules = [
        "sum(cost) <= 10 EUR",
        "s is a implies p is hybrid",
        "p.motor is m implies o is w",
        "s is c or o is absent",
    ]
    chosen = picking(*data.draw(st.lists(st.sampled_from(rules), unique=True)))
    for _ in range(4):
        variable = data.draw(st.sampled_from(chosen.decisions))
        options = [option for option in chosen.options(variable) if option.is_possible]
        assert options
        option = data.draw(st.sampled_from(options))
        chosen = chosen.pick(variable, option.value)
        assert chosen.left == option.tally == Tally(len(left(chosen)))
        for number, value in forced(chosen).items():
            assert set(left(chosen)[:, number].tolist()) == {value}
        for number in chosen.open:
            assert len(set(left(chosen)[:, number].tolist())) > 1
