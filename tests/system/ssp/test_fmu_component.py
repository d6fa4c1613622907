"""What an existing FMU offers to a workspace, and which interface it implements."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from hypothesis import given, strategies as st

from dse.domain.component import Causality, Interface, Kind, Port, Type
from dse.domain.fmu import FmuModel, UnitDefinition, Variable
from dse.errors import Location
from dse.formats.yaml_text import write_value
from dse.interchange.importing.fmu_component import Offer, implementing, offer
from dse.kinds.fmu import FmuSource
from dse.loading.values import read_value
from dse.units import parse_unit

REAL = Type(Kind.REAL)


def offered(*variables: Variable, units: dict[str, UnitDefinition] | None = None) -> Offer:
    nowhere = Path("nowhere")
    named = {variable.name: variable for variable in variables}
    return offer(
        "x", FmuModel(nowhere, nowhere, nowhere, 2, "x", "{}", named, units=units or {}), FmuSource(Path("x.fmu"))
    )


def real(name: str, causality: str, **fields: object) -> Variable:
    return Variable(name, 1, "Real", causality, Kind.REAL, **fields)


def interface(name: str, **ports: Causality) -> Interface:
    return Interface(name, tuple(Port(port, causality, REAL) for port, causality in ports.items()))


U, V, Y = real("u", "input", start=("2",)), real("v", "input"), real("y", "output")
IN, OUT = Causality.INPUT, Causality.OUTPUT


@pytest.mark.parametrize(("number", "unit"), [("120", "km/h"), ("20", "degC"), ("33.3", "%"), ("0.1", "kWh")])
def test_a_start_is_written_as_the_number_that_stands_in_the_fmu(number, unit):
    (parameter,) = offered(real("p", "parameter", unit=unit, start=(number,))).component.parameters
    assert float(write_value(parameter.start, parameter.type.unit, None)) == float(number)
    assert len(write_value(parameter.start, parameter.type.unit, None)) <= len(f"{number}.0")


@given(st.floats(-1e6, 1e6), st.sampled_from(["km/h", "degC", "deg", "kWh", "m", "1/min"]))
def test_what_is_written_reads_back_as_the_same_si_number(number, unit):
    type_ = Type(Kind.REAL, parse_unit(unit))
    (parameter,) = offered(real("p", "parameter", unit=unit, start=(repr(number),))).component.parameters
    written = float(write_value(parameter.start, type_.unit, None))
    assert read_value(written, type_, Location("here")) == parameter.start


def test_a_start_in_a_unit_of_the_fmus_own_is_converted_to_si():
    warp = UnitDefinition(100.0, 0.0, {"m": 1, "s": -1})
    made = offered(
        real("p", "parameter", unit="warp", start=("2",), maximum=3.0),
        real("u", "input", unit="warp", start=("4",)),
        units={"warp": warp},
    )
    (parameter,) = made.component.parameters
    assert (parameter.start, parameter.maximum, str(parameter.type)) == (200.0, 300.0, "m/s")
    assert made.starts == {"u": 400.0}


def test_a_difference_of_temperatures_keeps_no_offset():
    (parameter,) = offered(real("p", "parameter", unit="degC", start=("5",), is_relative=True)).component.parameters
    assert (parameter.start, str(parameter.type)) == (5.0, "K")


def test_bounds_that_bound_nothing_are_left_out():
    (parameter,) = offered(real("p", "parameter", minimum=-math.inf, maximum=math.inf)).component.parameters
    assert (parameter.minimum, parameter.maximum) == (None, None)


def test_an_interface_that_lacks_an_input_is_not_taken():
    made = implementing(offered(U, V, Y), [interface("silent", y=OUT), interface("half", u=IN, y=OUT)])
    assert made.component.interface.name == "x"
    assert [port.name for port in made.component.interface.ports] == ["u", "v", "y"]
    assert made.component.parameters == ()
    assert made.left_out == ()


def test_an_output_that_the_interface_lacks_is_told():
    made = implementing(offered(U, Y, real("z", "output")), [interface("pair", u=IN, y=OUT)])
    assert made.component.interface.name == "pair"
    assert made.left_out == ("z: an output that pair does not have",)


def test_a_parameter_that_is_called_like_a_port_is_told():
    made = implementing(offered(real("U", "input"), Y, real("u", "parameter")), [interface("pair", u=IN, y=OUT)])
    assert made.component.names == {"u": "U"}
    assert made.left_out == ("u: a parameter called like a port of pair",)


def test_start_values_of_inputs_go_by_the_names_of_the_interface():
    made = implementing(offered(real("Bus.u_1", "input", start=("7",)), Y), [interface("pair", bus_u1=IN, y=OUT)])
    assert made.starts == {"bus_u1": 7.0}


def test_of_several_interfaces_the_one_with_the_most_ports_is_taken():
    kinds = [interface("b", u=IN), interface("c", u=IN, y=OUT), interface("a", u=IN)]
    assert implementing(offered(U, Y), kinds).component.interface.name == "c"
    assert implementing(offered(U, Y), [kinds[0], kinds[2]]).component.interface.name == "a"


def test_an_enumeration_whose_items_cannot_be_names_is_told():
    items = {"Option 1": 4, "Option 2": 7}
    made = offered(Variable("k", 1, "Integer", "parameter", Kind.ENUMERATION, items=items))
    assert [(p.type, p.start) for p in made.component.parameters] == [(Type(Kind.INTEGER), 4)]
    assert made.told == ("k: an int, as its items cannot be names: 4 (Option 1), 7 (Option 2)",)
