"""Ports on variables of existing FMUs: units, items, arrays and texts."""

from __future__ import annotations

from pathlib import Path

import pytest

from dse.domain.component import Causality, Component, Interface, Kind, Parameter, Port, Type
from dse.domain.design import Connection
from dse.domain.fmu import FmuModel, UnitDefinition, Variable
from dse.domain.system import Conversion
from dse.errors import DseError
from dse.kinds.fmu import FmuSource
from dse.system.assembly import WiredParts, assemble
from dse.system.binding import bind
from dse.units import is_rounded, parse_unit

SPEED = Type(Kind.REAL, parse_unit("m/s"))
MODE = Type(Kind.ENUMERATION, items=("speed", "distance"))
PER_SECOND = {"m": 1, "s": -1}


def component(port: str = "v", type_: Type = SPEED, name: str | None = None) -> Component:
    interface = Interface("i", (Port(port, Causality.OUTPUT, type_),))
    return Component("radar", interface, source=FmuSource(Path("radar.fmu")), names={port: name} if name else {})


def model(*variables: Variable, units: dict[str, UnitDefinition] | None = None) -> FmuModel:
    nowhere = Path("nowhere")
    named = {variable.name: variable for variable in variables}
    return FmuModel(nowhere, nowhere, nowhere, 3, "radar", "{}", named, units=units or {})


def output(name: str = "v", kind: Kind | None = Kind.REAL, fmi_type: str = "Float64", **fields: object) -> Variable:
    return Variable(name, 1, fmi_type, "output", kind, **fields)


def conversion(unit: str, **units: UnitDefinition) -> Conversion:
    return bind(component(), "v", SPEED, model(output(unit=unit), units=units), ("output",)).conversion


def refusal(part: Component, type_: Type, fmu: FmuModel) -> str:
    with pytest.raises(DseError) as caught:
        bind(part, part.interface.ports[0].name, type_, fmu, ("output",))
    (found,) = caught.value.problems
    return str(found)


def test_a_unit_is_converted_by_its_usual_meaning():
    assert conversion("km/h") == Conversion(1000.0 / 3600.0, 0.0)
    assert conversion("m/s") == conversion("") == Conversion()


def test_a_unit_of_its_own_is_converted_as_the_fmu_defines_it():
    assert conversion("warp", warp=UnitDefinition(299792458.0, 0.0, PER_SECOND)) == Conversion(299792458.0, 0.0)


def test_a_rounded_factor_stands_for_the_usual_one():
    assert conversion("km/h", **{"km/h": UnitDefinition(0.277778, 0.0, PER_SECOND)}) == Conversion(1000.0 / 3600.0, 0.0)


def test_a_unit_that_the_fmu_defines_otherwise_is_the_fmus():
    assert conversion("km/h", **{"km/h": UnitDefinition(0.5, 0.0, PER_SECOND)}) == Conversion(0.5, 0.0)


def test_an_offset_is_converted_too():
    kelvin = Type(Kind.REAL, parse_unit("K"))
    fmu = model(output(unit="degC"), units={"degC": UnitDefinition(1.0, 273.15, {"K": 1})})
    assert bind(component(type_=kelvin), "v", kelvin, fmu, ("output",)).conversion == Conversion(1.0, 273.15)


def test_a_difference_has_no_offset():
    kelvin = Type(Kind.REAL, parse_unit("K"))
    fmu = model(output(unit="degC", is_relative=True))
    assert bind(component(type_=kelvin), "v", kelvin, fmu, ("output",)).conversion == Conversion()


def test_what_is_another_variable_with_the_other_sign_is_negated():
    fmu = model(output(unit="km/h", is_negated=True))
    assert bind(component(), "v", SPEED, fmu, ("output",)).conversion == Conversion(-1000.0 / 3600.0)
    truth = Type(Kind.BOOLEAN)
    fmu = model(output(kind=Kind.BOOLEAN, fmi_type="Boolean", is_negated=True))
    assert bind(component(type_=truth), "v", truth, fmu, ("output",)).conversion.items == ((0.0, 1.0), (1.0, 0.0))


def test_an_unknown_unit_is_refused():
    assert "the unknown unit 'warp'" in refusal(component(), SPEED, model(output(unit="warp")))


def test_items_are_matched_by_their_names():
    fmu = model(output(kind=Kind.ENUMERATION, fmi_type="Int64", items={"distance": 7, "off": 3, "speed": -2}))
    found = bind(component(type_=MODE), "v", MODE, fmu, ("output",))
    assert found.conversion == Conversion(items=((-2.0, 0.0), (7.0, 1.0)))


def test_items_with_the_same_numbers_need_no_conversion():
    fmu = model(output(kind=Kind.ENUMERATION, fmi_type="Int64", items={"speed": 0, "distance": 1}))
    assert bind(component(type_=MODE), "v", MODE, fmu, ("output",)).conversion == Conversion()


def test_an_item_that_the_fmu_lacks_is_named():
    fmu = model(output(kind=Kind.ENUMERATION, fmi_type="Int64", items={"speed": 0, "gap": 1}))
    text = refusal(component(type_=MODE), MODE, fmu)
    assert "has no item 'distance'" in text
    assert "its items: speed, gap" in text


def test_one_value_of_an_array_is_mapped_by_its_label():
    fmu = model(output("x", shape=(2, 3)))
    found = bind(component(name="x[2,1]"), "v", SPEED, fmu, ("output",))
    assert (found.variable.name, found.label) == ("x", "x[2,1]")


@pytest.mark.parametrize("label", ["x[3,1]", "x[0,1]", "x[1]", "x[1,1", "x]", "[1,1]"])
def test_a_label_outside_of_the_array_is_refused(label):
    fmu = model(output("x", shape=(2, 3)))
    text = refusal(component(name=label), SPEED, fmu)
    assert "the FMU of radar has no " in text
    assert f"'{label}'" in text


def test_a_whole_array_is_no_port():
    text = refusal(component(name="x"), SPEED, model(output("x", shape=(2, 3))))
    assert "'x' in the FMU of radar is an array of shape 2x3" in text
    assert "x[1,1]" in text


def source(*parameters: Parameter, names: dict[str, str]) -> Component:
    ports = (Port("a", Causality.OUTPUT, SPEED), Port("b", Causality.OUTPUT, SPEED))
    return Component(
        "source", Interface("i", ports), source=FmuSource(Path("s.fmu")), parameters=parameters, names=names
    )


def sink(names: dict[str, str]) -> Component:
    ports = (Port("a", Causality.INPUT, SPEED), Port("b", Causality.INPUT, SPEED))
    return Component("sink", Interface("j", ports), source=FmuSource(Path("t.fmu")), names=names)


def test_ports_on_one_array_are_one_variable_and_wires_of_their_own():
    given = source(names={"a": "y[1]", "b": "y[2]"})
    taken = sink({"a": "u[2]", "b": "u[1]"})
    fmus = {
        "source": model(output("y", shape=(2,), sized_by=("",))),
        "sink": model(Variable("u", 1, "Float64", "input", Kind.REAL, shape=(2,), sized_by=("",))),
    }
    wires = [Connection("s.a", "t.a"), Connection("s.b", "t.b")]
    system = assemble("x", WiredParts({"s": given, "t": taken}, tuple(wires)), fmus, [])
    assert [v.name for v in system.element("s").outputs] == ["y"]
    assert [v.name for v in system.element("t").inputs] == ["u"]
    assert [(w.source_variable, w.target_variable) for w in system.wires] == [("y[1]", "u[2]"), ("y[2]", "u[1]")]


def test_a_structural_parameter_sizes_the_arrays_of_its_element():
    size = Parameter("n", Type(Kind.INTEGER), 2)
    part = source(size, names={"a": "y[1]", "b": "y[3]"})
    fmu = model(
        Variable("n", 0, "UInt64", "structuralParameter", Kind.INTEGER, start=("2",)),
        output("y", shape=(2,), sized_by=("n",)),
    )
    with pytest.raises(DseError, match=r"has no 'y\[3\]'"):
        assemble("x", WiredParts({"s": part}), {"source": fmu}, ["s.b"])
    element = assemble("x", WiredParts({"s": part}, (), {"s.n": 3}), {"source": fmu}, ["s.b"]).element("s")
    assert element.outputs[0].shape == (3,)
    assert element.start == {"n": 3.0}


def test_a_text_goes_to_a_variable_that_takes_texts():
    text = Parameter("file", Type(Kind.TEXT), "a.csv")
    part = Component("p", Interface("i", ()), source=FmuSource(Path("p.fmu")), parameters=(text,))
    fmu = model(Variable("file", 0, "String", "parameter", None))
    assert assemble("x", WiredParts({"p": part}), {"p": fmu}, []).element("p").texts == {"file": "a.csv"}
    given = WiredParts({"p": part}, (), {"p.file": "b"})
    assert assemble("x", given, {"p": fmu}, []).element("p").texts == {"file": "b"}
    number = model(Variable("file", 0, "Float64", "parameter", Kind.REAL))
    with pytest.raises(DseError, match="is real, not string"):
        assemble("x", WiredParts({"p": part}), {"p": number}, [])


@pytest.mark.parametrize(("inside", "outside"), [("rpm", "Hz"), ("Hz", "rad/s"), ("deg/s", "kHz")])
def test_cycles_and_angles_are_not_taken_for_each_other(inside, outside):
    type_ = Type(Kind.REAL, parse_unit(outside))
    assert f"is in {inside}, expected {outside}" in refusal(component(type_=type_), type_, model(output(unit=inside)))


@pytest.mark.parametrize(("inside", "outside"), [("rpm", "rad/s"), ("Hz", "1/s"), ("rad/s", "1/s"), ("kHz", "Hz")])
def test_what_counts_alike_is_converted(inside, outside):
    type_ = Type(Kind.REAL, parse_unit(outside))
    found = bind(component(type_=type_), "v", type_, model(output(unit=inside)), ("output",)).conversion
    assert found.factor == float(parse_unit(inside).factor)


@pytest.mark.parametrize(
    ("usual", "written", "same"),
    [
        (1 / 3.6, 0.27778, True),
        (1 / 3.6, 0.27777, True),
        (1 / 3.6, 0.2777777777777778, True),
        (0.3048, 1200 / 3937, False),  # the foot of American surveyors
        (0.3048, 0.3, False),
        (273.15, 273.15, True),
        (0.0, 0.0, True),
        (0.0, 1e-9, False),
    ],
)
def test_only_a_factor_with_fewer_digits_stands_for_the_usual_one(usual, written, same):
    assert is_rounded(usual, written) is same


def sized() -> FmuModel:
    size = Variable("m", 2, "UInt64", "structuralParameter", Kind.INTEGER, start=("3",))
    return model(size, output("y", shape=(3,), sized_by=("m",)))


def sized_part() -> Component:
    count = Parameter("m", Type(Kind.INTEGER), 3)
    ports = (Port("y_3", Causality.OUTPUT, Type(Kind.REAL)),)
    return Component("x", Interface("i", ports), parameters=(count,), names={"y_3": "y[3]"})


def test_an_array_that_became_too_small_is_told_by_its_size():
    with pytest.raises(DseError) as caught:
        assemble("x", WiredParts({"s": sized_part()}, (), {"s.m": 2}), {"x": sized()}, [])
    (found,) = caught.value.problems
    assert found.what == "the FMU of x has no 'y[3]': 'y' has 2 values"
    assert found.hint == "its size is set by 'm'"


def test_an_array_beyond_all_measure_is_refused_before_its_values_get_names():
    with pytest.raises(DseError, match=r"with m = 200000000 the array 'y' has 200,000,000 values"):
        assemble("x", WiredParts({"s": sized_part()}, (), {"s.m": 200_000_000}), {"x": sized()}, [])


def test_a_number_that_is_none_of_an_enumerations_items_is_refused():
    kind = Variable("k", 1, "Int64", "parameter", Kind.ENUMERATION, start=("1",), items={"Option 1": 1, "Option 2": 7})
    part = Component("p", Interface("i", ()), parameters=(Parameter("k", Type(Kind.INTEGER), 1),))
    given = WiredParts({"p": part}, (), {"p.k": 7})
    assert assemble("x", given, {"p": model(kind)}, []).element("p").start == {"k": 7.0}
    with pytest.raises(DseError) as caught:
        assemble("x", WiredParts({"p": part}, (), {"p.k": 3}), {"p": model(kind)}, [])
    (found,) = caught.value.problems
    assert found.what == "'k' in the FMU of p cannot be 3: it is an enumeration"
    assert found.hint == "its items: 1 (Option 1), 7 (Option 2)"
