"""Values of every C type through FMI, in both directions."""

from __future__ import annotations

import math

import pytest
from fmpy.fmi1 import FMICallException

from dse.domain.component import Causality, Interface, Kind, Parameter, Port, Type
from dse.units import parse_unit

REAL = Type(Kind.REAL, parse_unit("m"))
INTEGER = Type(Kind.INTEGER)
BOOLEAN = Type(Kind.BOOLEAN)
GEAR = Type(Kind.ENUMERATION, items=("park", "reverse", "drive"))
FMI_RANGE = (-(2**31), 2**31 - 1)

# port: type, C type, a value it takes, and the least and greatest of the whole numbers it takes
MEMBERS = {
    "wide": (REAL, "double", 0.1, None),
    "narrow": (REAL, "float", 0.5, None),
    "i8": (INTEGER, "int8_t", -7, (-128, 127)),
    "i16": (INTEGER, "int16_t", -300, (-32768, 32767)),
    "i32": (INTEGER, "int32_t", -70000, FMI_RANGE),
    "i64": (INTEGER, "int64_t", -70001, FMI_RANGE),
    "u8": (INTEGER, "uint8_t", 200, (0, 255)),
    "u16": (INTEGER, "uint16_t", 60000, (0, 65535)),
    "u32": (INTEGER, "uint32_t", 70002, (0, FMI_RANGE[1])),
    "u64": (INTEGER, "uint64_t", 70003, (0, FMI_RANGE[1])),
    "whole": (INTEGER, "long", 12, FMI_RANGE),
    "flag": (BOOLEAN, "bool", True, None),
    "flag8": (BOOLEAN, "unsigned char", True, None),
    "gear": (GEAR, "enum gear", 2, (0, 2)),
    "gear8": (GEAR, "uint8_t", 1, (0, 2)),
}
BOUNDED = [name for name, (_, _, _, bounds) in MEMBERS.items() if bounds]


@pytest.fixture
def mirror(workshop):
    """Shows its inputs at its outputs, and a dotted input at a dotted output; 'huge' overflows FMI's integers."""
    inputs = " ".join(f"{c} {name};" for name, (_, c, *_) in MEMBERS.items())
    outputs = " ".join(f"{c} {name}_out;" for name, (_, c, *_) in MEMBERS.items())
    copies = " ".join(f"c->out.{name}_out = c->in.{name};" for name in MEMBERS)
    ports = [Port(name, Causality.INPUT, kind) for name, (kind, *_) in MEMBERS.items()]
    ports += [Port(f"{name}_out", Causality.OUTPUT, kind) for name, (kind, *_) in MEMBERS.items()]
    ports += [Port("target.gap", Causality.INPUT, REAL), Port("seen.far.gap", Causality.OUTPUT, REAL)]
    ports += [Port("huge", Causality.OUTPUT, INTEGER), Port("lost", Causality.OUTPUT, GEAR)]
    return workshop.component(
        "mirror",
        f"""
        enum gear {{ PARK, REVERSE, DRIVE }};
        typedef struct {{
            struct {{ {inputs} struct {{ double gap; }} target; }} in;
            struct {{ {outputs} struct {{ struct {{ double gap; }} far; }} seen; uint64_t huge; enum gear lost; }} out;
            struct {{ bool negate; enum gear first; int8_t limit; float scale; }} par;
        }} mirror;
        void mirror_init(mirror *c);
        void mirror_step(mirror *c);
        """,
        f"""
        void mirror_init(mirror *c) {{ c->out.gear_out = c->par.first; c->out.i8_out = c->par.limit; }}
        void mirror_step(mirror *c) {{
            {copies}
            c->out.seen.far.gap = (c->par.negate ? -1 : 1) * c->in.target.gap;
            c->out.huge = UINT64_MAX;
            c->out.lost = 7;
        }}
        """,
        Interface("mirror", tuple(ports)),
        (
            Parameter("negate", BOOLEAN, True),
            Parameter("first", GEAR, "drive"),
            Parameter("limit", INTEGER, -5, -100, 100),
            Parameter("scale", Type(Kind.REAL, parse_unit("km/h")), 12.5),
        ),
        step=0.01,
    )


@pytest.fixture
def slave(mirror, new_slave):
    return new_slave(mirror)


def test_a_value_of_every_type_goes_in_and_comes_out(slave):
    slave.ready()
    for name, (_, _, value, _) in MEMBERS.items():
        slave.set(name, value)
    slave.set("target.gap", 4.5)
    slave.step(0.0, 0.01)
    assert {name: slave.get(f"{name}_out") for name in MEMBERS} == {n: value for n, (_, _, value, _) in MEMBERS.items()}
    assert slave.get("seen.far.gap") == -4.5


@pytest.mark.parametrize("name", BOUNDED)
def test_a_whole_number_is_taken_up_to_its_bounds_and_not_cut_beyond(slave, name):
    bounds = MEMBERS[name][3]
    slave.ready()
    for value in bounds:
        slave.set(name, value)
        assert slave.get(name) == value
    for value in (bounds[0] - 1, bounds[1] + 1):
        if FMI_RANGE[0] <= value <= FMI_RANGE[1]:
            with pytest.raises(FMICallException):
                slave.set(name, value)
            assert f"'{name}'" in slave.messages.pop()
            assert slave.get(name) == bounds[1]


def test_a_number_too_large_for_a_float_is_refused_but_infinity_and_nan_are_not(slave):
    slave.ready()
    with pytest.raises(FMICallException):
        slave.set("narrow", 1e39)
    assert "does not fit a float" in slave.messages[0]
    slave.set("narrow", math.inf)
    assert slave.get("narrow") == math.inf
    slave.set("narrow", math.nan)
    assert math.isnan(slave.get("narrow"))


def test_an_output_beyond_what_fmi_can_say_is_an_error_not_a_cut_number(slave):
    slave.ready()
    slave.step(0.0, 0.01)
    for name in ("huge", "lost"):
        with pytest.raises(FMICallException):
            slave.get(name)
        assert f"'{name}'" in slave.messages.pop()


def test_parameters_start_at_their_values_and_init_sees_them(slave):
    slave.ready()
    assert slave.get("gear_out") == 2
    assert slave.get("i8_out") == -5
    assert slave.get("scale") == 12.5
    assert slave.get("negate") is True or slave.get("negate") == 1


def test_a_variable_of_another_kind_is_not_read_with_this_accessor(slave, version):
    slave.ready()
    read = slave.fmu.getReal if version == 2 else slave.fmu.getFloat64
    with pytest.raises(FMICallException):
        read([slave.model.variables["i8"].reference])
    assert "'i8' is of the kind integer" in slave.messages[0]
    with pytest.raises(FMICallException):
        read([4000])
    assert "no variable with value reference 4000" in slave.messages[1]


def test_time_is_a_variable_in_fmi_3(slave, version):
    slave.ready(start_time=2.0)
    assert ("time" in slave.model.variables) == (version == 3)
    if version == 3:
        slave.step(2.0, 0.5)
        assert slave.get("time") == 2.5
