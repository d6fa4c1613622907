"""An expression written as text reads back as the same tree."""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given, settings, strategies as st

from dse.domain.expression import Between, Binary, Call, Chosen, Conditional, Expression, Name, Number, Truth, Unary
from dse.expression.parse import parse_expression
from dse.expression.text import decimal, show_expression, text_of
from dse.expression.tree import same
from dse.units import DIMENSIONLESS, parse_unit

SPAN = (0, 0)
words = st.sampled_from(["a", "b", "cost", "x_1", "iffy"])
paths = st.lists(words, min_size=1, max_size=3).map(".".join)
units = st.sampled_from(["", "m", "km/h", "%", "EUR", "1/s", "kg.m^2", "min"]).map(parse_unit)
leaves = st.one_of(
    st.builds(
        lambda n, d, unit: Number(Fraction(n, 10**d) * unit.factor, unit, SPAN),
        st.integers(0, 10**6),
        st.integers(0, 4),
        units,
    ),
    st.builds(Truth, st.booleans(), st.just(SPAN)),
    st.builds(Name, paths, st.just(SPAN)),
    st.builds(Chosen, paths, st.lists(words, min_size=1, max_size=3).map(tuple), st.just(SPAN)),
)


def composites(inner):
    operators = ["+", "-", "*", "/", "^", "<", "<=", ">", ">=", "==", "!=", "and", "or", "xor", "implies", "iff"]
    return st.one_of(
        st.builds(Unary, st.sampled_from(["-", "not"]), inner, st.just(SPAN)),
        st.builds(Binary, st.sampled_from(operators), inner, inner, st.just(SPAN)),
        st.builds(Conditional, inner, inner, inner, st.just(SPAN)),
        st.builds(Between, inner, inner, inner, st.just(SPAN)),
        st.builds(Call, words, st.lists(inner, max_size=3).map(tuple), st.just(()), st.just(SPAN)),
    )


@pytest.mark.thorough
@settings(max_examples=500, deadline=None)
@given(st.recursive(leaves, composites, max_leaves=12))
def test_any_tree_reads_back_as_itself(tree):
    assert same(parse_expression(show_expression(tree)).root, tree)


@pytest.mark.parametrize(
    "text",
    [
        "a is b implies c in [d, absent]",
        "not a is b and (c or d) xor e",
        "sum(cost, a.b) - (x - y) - z <= 5 EUR",
        "-x ^ 2 * -(y + z)",
        "a between 1 m and 2.5 km",
        "(if a is b then 1 else 2) < 3",
        "at_least(2, a is b, c is d, not e is f)",
        "3 m / (2 s) * x",
        "-5 °C < t",
    ],
)
def test_there_are_few_brackets(text):
    tree = parse_expression(text).root
    assert same(parse_expression(show_expression(tree)).root, tree)
    assert len(show_expression(tree)) <= len(text) + 4


def test_the_users_spelling_stays_if_it_is_ours():
    ours = parse_expression("a  is b   and(c)")
    assert text_of(ours) == "a  is b   and(c)"
    foreign = Expression("A & C", ours.root)
    assert text_of(foreign) == "a is b and c"


def test_trees_are_the_same_wherever_they_stand():
    assert same(parse_expression("a  +  b").root, parse_expression("a + b").root)
    assert not same(parse_expression("a + b").root, parse_expression("b + a").root)
    assert not same(parse_expression("f(a)").root, parse_expression("f(a, a)").root)


@pytest.mark.parametrize(
    ("value", "text"),
    [(Fraction(0), "0"), (Fraction(-5, 2), "-2.5"), (Fraction(1, 1000), "0.001"), (Fraction(1, 3), None), (Fraction(7), "7")],
)  # fmt: skip
def test_decimals_are_exact_or_refused(value, text):
    assert decimal(value) == text


def test_a_number_without_end_is_a_quotient():
    assert show_expression(Number(Fraction(1, 3), DIMENSIONLESS, SPAN)) == "(1 / 3)"
