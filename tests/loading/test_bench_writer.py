"""Test benches written as YAML."""

from __future__ import annotations

from hypothesis import given, strategies as st
from ruamel.yaml import YAML

from dse.domain.bench import Simulation
from dse.domain.component import Kind, Type
from dse.errors import Location
from dse.loading.values import read_value
from dse.loading.writing.bench import write_bench
from dse.units import parse_unit


@given(st.floats(-1e9, 1e9), st.sampled_from(["%", "km/h", "degC", "kWh", "m"]))
def test_any_number_is_written_to_the_last_bit(si, unit):
    type_ = Type(Kind.REAL, parse_unit(unit))
    text = write_bench("b", "", "d", {"a.p": (si, type_)}, Simulation(1.0, 0.1, (), 0.1), {})
    written = YAML(typ="safe").load(text)["parameters"]["a.p"]
    assert read_value(written, type_, Location("here")) == si


def test_a_number_that_the_unit_does_not_have_has_more_digits():
    # 33.3 times the double nearest to 1/100: no decimal of 17 digits in % is that.
    type_ = Type(Kind.REAL, parse_unit("%"))
    text = write_bench("b", "", "d", {"a.p": (0.33299999999999996, type_)}, Simulation(1.0, 0.1, (), 0.1), {})
    assert 'a.p: "33.29999999999999' in text
