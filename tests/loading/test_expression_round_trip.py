"""Printing a tree and reading it again gives the same tree."""

from __future__ import annotations

import contextlib
from dataclasses import replace
from fractions import Fraction

import pytest
from hypothesis import given, settings, strategies as st

from dse.domain.expression import Between, Binary, Call, Chosen, Conditional, Name, Number, Truth, Unary
from dse.errors import DseError
from dse.expression.parse import parse_expression
from dse.expression.tokens import KEYWORDS
from dse.units import parse_unit

NOWHERE = (0, 0)
STRENGTH = {"if": 0, "iff": 1, "implies": 2, "or": 3, "xor": 4, "and": 5, "not": 6, "compare": 7, "+": 8, "*": 9}
STRENGTH |= {"-": 8, "/": 9, "negative": 10, "^": 11, "atom": 12}
COMPARISONS = ("<", "<=", ">", ">=", "==", "!=")

words = st.from_regex(r"[a-z_][a-z0-9_]{0,5}", fullmatch=True).filter(lambda word: word not in KEYWORDS)
paths = st.lists(words, min_size=1, max_size=3).map(".".join)
units = st.sampled_from(["", "m", "km/h", "%", "EUR", "TOPS", "1/s", "m/s2", "N.m", "kg.m^2", "min", "g"]).map(
    parse_unit
)
numbers = st.builds(
    lambda mantissa, digits, unit: Number(Fraction(mantissa, 10**digits) * unit.factor, unit, NOWHERE),
    st.integers(0, 10**6),
    st.integers(0, 4),
    units,
)
leaves = st.one_of(
    numbers,
    st.builds(Truth, st.booleans(), st.just(NOWHERE)),
    st.builds(Name, paths, st.just(NOWHERE)),
    st.builds(Chosen, paths, st.lists(words, min_size=1, max_size=3).map(tuple), st.just(NOWHERE)),
)


def composites(inner):
    operators = st.sampled_from(["+", "-", "*", "/", "^", *COMPARISONS, "and", "or", "xor", "implies", "iff"])
    options = st.dictionaries(words, inner, max_size=2).map(lambda given: tuple(given.items()))
    return st.one_of(
        st.builds(Unary, st.sampled_from(["-", "not"]), inner, st.just(NOWHERE)),
        st.builds(Binary, operators, inner, inner, st.just(NOWHERE)),
        st.builds(Conditional, inner, inner, inner, st.just(NOWHERE)),
        st.builds(Between, inner, inner, inner, st.just(NOWHERE)),
        st.builds(Call, words, st.lists(inner, max_size=3).map(tuple), options, st.just(NOWHERE)),
    )


trees = st.recursive(leaves, composites, max_leaves=12)


def strength(node):
    match node:
        case Binary():
            return STRENGTH["compare" if node.operator in COMPARISONS else node.operator]
        case Unary():
            return STRENGTH["not" if node.operator == "not" else "negative"]
        case Between() | Chosen():
            return STRENGTH["compare"]
        case Conditional():
            return STRENGTH["if"]
    return STRENGTH["atom"]


def text(node):
    """*node* with no more brackets than needed, but for a prefix as an operand, which always has them."""

    def within(inner, least):
        bare = strength(inner) >= least and (least == 0 or not isinstance(inner, Unary | Conditional))
        return text(inner) if bare else f"({text(inner)})"

    match node:
        case Number():
            value = f"{float(node.si / node.unit.factor):.4f}"
            return f"{value} {node.unit}".strip()
        case Truth():
            return str(node.value).lower()
        case Name():
            return node.path
        case Chosen():
            return f"{node.place} in [{', '.join(node.options)}]"
        case Call():
            named = [f"{name} = {text(value)}" for name, value in node.options]
            return f"{node.function}({', '.join([*map(text, node.arguments), *named])})"
        case Unary():
            return f"{node.operator} {within(node.operand, strength(node))}"
        case Between():
            return " ".join(
                [within(node.value, 8), "between", within(node.low, 8), "and", within(node.high, 8)],
            )
        case Conditional():
            return f"if {text(node.condition)} then {text(node.yes)} else {text(node.no)}"
        case Binary():
            own = strength(node)
            from_the_right = node.operator in ("implies", "^")
            left = own + 1 if from_the_right or own == STRENGTH["compare"] else own
            right = own if from_the_right else own + 1
            return f"{within(node.left, left)} {node.operator} {within(node.right, right)}"


def without_spans(node):
    match node:
        case Unary():
            return replace(node, operand=without_spans(node.operand), span=NOWHERE)
        case Binary():
            return replace(node, left=without_spans(node.left), right=without_spans(node.right), span=NOWHERE)
        case Between():
            ends = {name: without_spans(getattr(node, name)) for name in ("value", "low", "high")}
            return replace(node, **ends, span=NOWHERE)
        case Conditional():
            parts = {name: without_spans(getattr(node, name)) for name in ("condition", "yes", "no")}
            return replace(node, **parts, span=NOWHERE)
        case Call():
            options = tuple((name, without_spans(value)) for name, value in node.options)
            arguments = tuple(map(without_spans, node.arguments))
            return replace(node, arguments=arguments, options=options, span=NOWHERE)
    return replace(node, span=NOWHERE)


@pytest.mark.thorough
@settings(max_examples=300, deadline=None)
@given(trees)
def test_a_printed_tree_is_read_back_unchanged(tree):
    assert without_spans(parse_expression(text(tree)).root) == tree


@settings(max_examples=300, deadline=None)
@given(st.text(alphabet="ab.m/s 12()[]<>=+-*^,%\n'ifthenls", max_size=40))
def test_any_text_is_read_or_refused_but_never_breaks_the_reader(source):
    with contextlib.suppress(DseError):
        assert parse_expression(source).text == source
