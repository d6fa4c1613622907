"""Counts as text: of any size, and never by way of a float."""

from __future__ import annotations

import pytest
from hypothesis import given, strategies as st

from dse.cli.spaces import number_text, tally_cell, tally_text
from dse.space.methods.tally import Tally, significant


@given(st.integers(0, 10**40), st.integers(1, 6))
def test_figures_are_those_of_the_decimal_notation(number, figures):
    shown = significant(number, figures)
    assert len(shown.partition("e")[0].replace(".", "")) <= figures
    unit = 10 ** max(len(str(number)) - figures, 0)
    digits, _, exponent = shown.partition("e")
    whole, _, decimals = digits.partition(".")
    read = int(whole + decimals) * 10 ** (int(exponent or 0) - len(decimals))
    assert 2 * abs(read - number) <= unit


@pytest.mark.parametrize(
    ("number", "shown"),
    [(0, "0"), (9999, "9999"), (10_000, "1e4"), (99_995, "1e5"), (12_345, "1.234e4"), (12_355, "1.236e4")],
)
def test_figures_are_rounded_half_to_even(number, shown):
    assert significant(number, 4) == shown


@pytest.mark.parametrize("power", [15, 22, 23, 308, 309, 1000, 6000])
def test_powers_of_ten_are_told_from_their_neighbours(power):
    assert significant(10**power, 4) == f"1e{power}"
    assert significant(10**power * 9999 // 10_000 - 1, 4) == f"9.999e{power - 1}"


def test_an_estimate_beyond_every_float_is_shown():
    tally = Tally(1234 * 10**400, False, 1200 * 10**400, 1300 * 10**400)
    assert str(tally) == "≈ 1.234e403 ± 5e401 (95 %)"
    assert tally_text(tally) == str(tally)
    assert tally_cell(tally) == "≈ 1.234e403 ± 5e401"


def test_a_count_of_more_digits_than_python_writes_is_shown():
    assert str(Tally(3 * 10**6000)) == tally_text(Tally(3 * 10**6000)) == number_text(3 * 10**6000) == "3e6000"


def test_a_narrow_interval_keeps_its_half():
    assert str(Tally(100, False, 99, 102)) == "≈ 100 ± 1.5 (95 %)"
