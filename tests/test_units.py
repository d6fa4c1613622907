"""Numbers in other units than SI, as they are written and read back."""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import example, given, strategies as st

from dse.units import parse_unit, shown

UNITS = ("km/h", "%", "kWh/km", "g/km", "degC", "rpm", "deg")


@given(st.floats(-1e12, 1e12), st.sampled_from(UNITS))
@example(1.9 + 1e-15, "km/h")  # no double in km/h is read back as it
@example(1e-300, "%")
@example(0.0, "degC")
def test_a_number_is_written_so_that_it_is_read_back_as_it_was(si: float, symbol: str) -> None:
    unit = parse_unit(symbol)
    if symbol == "degC" and abs(si) < 1e-3 and si:
        return  # next to absolute zero more digits are needed than anybody writes
    assert unit.to_si(Fraction(unit.written(si))) == si


@pytest.mark.parametrize(
    ("si", "symbol", "text"),
    [
        (70 / 3.6, "km/h", "70"),
        (0.1, "km/h", "0.36"),
        (293.15, "degC", "20"),
        (273.25, "degC", "0.1"),
        (0.07, "%", "7"),
        (0.0, "degC", "-273.15"),
    ],
)
def test_what_a_person_wrote_is_written_so_again(si: float, symbol: str, text: str) -> None:
    assert str(parse_unit(symbol).written(si)) == text


@pytest.mark.parametrize(
    ("value", "digits", "text"),
    [
        (99.6, 2, "100"),
        (1234.5, 3, "1234"),
        (16258.4, 4, "16258"),
        (9999.7, 4, "10000"),
        (1e7, 4, "1e+07"),
        (0.00001234, 3, "1.23e-05"),
        (-123456.0, 4, "-123456"),
        (12.345, 4, "12.35"),
    ],
)
def test_whole_numbers_of_seven_digits_are_shown_in_full(value: float, digits: int, text: str) -> None:
    assert shown(value, digits) == text
