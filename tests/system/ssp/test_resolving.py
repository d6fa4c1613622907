"""Nested systems become wires between FMUs: directions, units, tables and the precedence of parameters."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, strategies as st
from ssp_packages import (
    METRES_PER_SECOND,
    binding,
    bindings,
    component,
    connection,
    connections,
    connectors,
    description,
    elements,
    entry,
    mapping,
    model,
    parameter_set,
    resolved,
    variable,
)

from dse.domain.component import Kind
from dse.domain.fmu import FmiInterface, UnitDefinition
from dse.errors import DseError
from dse.interchange.resolving.carry import Carry

REAL = {
    "gain": model("gain", variable("u", "input"), variable("y", "output"), variable("k", "parameter", start=("1",))),
    "kmh": model(
        "kmh", variable("u", "input", unit="km/h"), variable("y", "output", unit="km/h"), units=METRES_PER_SECOND
    ),
    "ms": model("ms", variable("u", "input", unit="m/s"), variable("y", "output", unit="m/s"), units=METRES_PER_SECOND),
}
UNITS = (
    '<ssd:Units><ssc:Unit name="km/h"><ssc:BaseUnit m="1" s="-1" factor="0.2777777777777778"/></ssc:Unit>'
    '<ssc:Unit name="m/s"><ssc:BaseUnit m="1" s="-1"/></ssc:Unit>'
    '<ssc:Unit name="degC"><ssc:BaseUnit K="1" offset="273.15"/></ssc:Unit>'
    '<ssc:Unit name="K"><ssc:BaseUnit K="1"/></ssc:Unit></ssd:Units>'
)


def gains(*names: str) -> str:
    return elements(*(component(name, "input u", "output y", source="resources/gain.fmu") for name in names))


def wires(system) -> list[tuple[str, str]]:
    return [(f"{w.source}.{w.source_variable}", f"{w.target}.{w.target_variable}") for w in system.structure.wires]


def problems(*args, **options) -> list[str]:
    with pytest.raises(DseError) as caught:
        resolved(*args, **options)
    return [str(problem) for problem in caught.value.problems]


def test_the_direction_is_that_of_the_connectors_not_of_the_words_start_and_end(tmp_path):
    text = description(gains("a", "b") + connections(connection("b.u", "a.y"), connection("b.y", "a.u")))
    assert sorted(wires(resolved(tmp_path, text, REAL))) == [("a.y", "b.u"), ("b.y", "a.u")]


def test_connectors_of_nested_systems_are_seen_through(tmp_path):
    inner = f'<ssd:System name="s">{connectors("input in", "output out")}' + elements(
        f'<ssd:System name="t">{connectors("input in", "output out")}{gains("g")}'
        + connections(connection(".in", "g.u"), connection("g.y", ".out"))
        + "</ssd:System>"
    )
    inner += connections(connection(".in", "t.in"), connection("t.out", ".out")) + "</ssd:System>"
    text = description(
        elements(component("a", "input u", "output y", source="resources/gain.fmu"), inner)
        + connections(connection("a.y", "s.in"), connection("s.out", "a.u"))
    )
    found = resolved(tmp_path, text, REAL)
    assert sorted(wires(found)) == [("a.y", "s.t.g.u"), ("s.t.g.y", "a.u")]
    assert {element.name for element in found.structure.elements} == {"a", "s.t.g"}


def test_a_system_may_pass_an_input_straight_through(tmp_path):
    inner = f'<ssd:System name="s">{connectors("input in", "output out")}{connections(connection(".in", ".out"))}</ssd:System>'
    text = description(
        elements(*(component(n, "input u", "output y", source="resources/gain.fmu") for n in "ab"), inner)
        + connections(connection("a.y", "s.in"), connection("s.out", "b.u"))
    )
    assert wires(resolved(tmp_path, text, REAL)) == [("a.y", "b.u")]


def test_elements_stand_along_the_flow_of_signals(tmp_path):
    text = description(gains("c", "b", "a") + connections(connection("a.y", "b.u"), connection("b.y", "c.u")))
    assert [element.name for element in resolved(tmp_path, text, REAL).structure.elements] == ["a", "b", "c"]


def two(source: str, target: str, inner: str = "", **attributes: str) -> str:
    return elements(
        component("a", "input u", "output y", source=f"resources/{source}.fmu"),
        component("b", "input u", "output y", source=f"resources/{target}.fmu"),
    ) + connections(connection("a.y", "b.u", inner, **attributes))


def test_units_are_converted_between_fmus(tmp_path):
    (wire,) = resolved(tmp_path, description(two("kmh", "ms")), REAL).structure.wires
    # 3.6 km/h is 1 m/s; the factor is rounded once.
    assert math.isclose(wire.factor * 3.6, 1.0, rel_tol=1e-15)
    assert wire.offset == 0.0


BRACKETED = {"[m]": UnitDefinition(exponents={"m": 1}), "[mm]": UnitDefinition(1e-3, exponents={"m": 1})}
IN_METRES = {
    "m": model("m", variable("u", "input", unit="m"), variable("y", "output", unit="[m]"), units=BRACKETED),
    "bare": model("bare", variable("u", "input"), variable("y", "output")),
}
LEVEL = (
    '<ssd:Connectors><ssd:Connector name="level" kind="input"><ssc:Real unit="UNIT"/></ssd:Connector></ssd:Connectors>'
)
NOTE = "the unit '{}' is not defined in the package: it means what its FMUs declare"


def levelled(unit: str) -> str:
    inner = elements(component("a", "input u", source="resources/m.fmu"))
    return description(LEVEL.replace("UNIT", unit) + inner + connections(connection(".level", "a.u")))


def test_a_unit_that_only_an_fmu_declares_is_taken_and_told(tmp_path):
    own = bindings(binding(parameter_set("level Real 1500 [mm]")))
    text = levelled("[m]").replace("</ssd:System>", f"{own}</ssd:System>")
    found = resolved(tmp_path, text, IN_METRES)
    assert math.isclose(dict(found.structure.element("a").start)["u"], 1.5, rel_tol=1e-15)
    assert [note.what for note in found.notes] == [NOTE.format("[m]"), NOTE.format("[mm]")]
    assert all(".ssd" in str(note.where) for note in found.notes)


def test_a_unit_that_nothing_declares_or_two_fmus_mean_differently_is_refused(tmp_path):
    own = bindings(binding(parameter_set("level Real 1500 m")))
    text = levelled("[ell]").replace("</ssd:System>", f"{own}</ssd:System>")
    assert "the unit '[ell]' is defined nowhere" in problems(tmp_path, text, IN_METRES)[0]
    other = model("other", variable("u", "input"), units={"[m]": UnitDefinition(2.0, exponents={"m": 1})})
    third = model("third", variable("u", "input", unit="m"))
    inner = elements(component("m", "input u"), component("other", "input u"), component("third", "input u"))
    text = description(LEVEL.replace("UNIT", "[m]") + inner + connections(connection(".level", "third.u")) + own)
    given = IN_METRES | {"other": other, "third": third}
    assert "the unit '[m]' is defined nowhere" in problems(tmp_path, text, given)[0]


def test_suppressing_the_conversion_passes_the_number(tmp_path):
    (wire,) = resolved(tmp_path, description(two("kmh", "ms", suppressUnitConversion="true")), REAL).structure.wires
    assert (wire.factor, wire.offset) == (1.0, 0.0)


def test_the_linear_transformation_is_given_the_value_in_the_targets_unit(tmp_path):
    linear = '<ssc:LinearTransformation factor="2" offset="5"/>'
    (wire,) = resolved(tmp_path, description(two("kmh", "ms", linear)), REAL).structure.wires
    assert math.isclose(wire.factor * 36 + wire.offset, 2 * 10 + 5, rel_tol=1e-15)
    (wire,) = resolved(
        tmp_path, description(two("kmh", "ms", linear, suppressUnitConversion="true")), REAL
    ).structure.wires
    assert (wire.factor, wire.offset) == (2.0, 5.0)


def test_a_nested_systems_connector_may_be_in_a_unit_of_its_own(tmp_path):
    inner = (
        '<ssd:System name="s"><ssd:Connectors><ssd:Connector name="in" kind="input"><ssc:Real unit="km/h"/></ssd:Connector>'
        f"</ssd:Connectors>{elements(component('b', 'input u', source='resources/ms.fmu'))}"
        + connections(connection(".in", "b.u", '<ssc:LinearTransformation factor="1" offset="1"/>'))
        + "</ssd:System>"
    )
    text = elements(component("a", "output y", source="resources/ms.fmu"), inner) + connections(
        connection("a.y", "s.in")
    )
    (wire,) = resolved(tmp_path, description(text, UNITS), REAL).structure.wires
    # There and back again, and 1 m/s on top.
    assert math.isclose(wire.factor, 1.0, rel_tol=1e-15)
    assert wire.offset == 1.0


def test_temperatures_are_converted_with_their_offset_and_differences_without(tmp_path):
    def fmus(*, is_relative: bool):
        return {
            "c": model("c", variable("y", "output", unit="degC", is_relative=is_relative)),
            "k": model("k", variable("u", "input", unit="K", is_relative=is_relative)),
        }

    text = description(
        elements(component("c", "output y"), component("k", "input u")) + connections(connection("c.y", "k.u")), UNITS
    )
    (wire,) = resolved(tmp_path, text, fmus(is_relative=False)).structure.wires
    assert wire.factor == 1.0
    assert math.isclose(wire.offset, 273.15)
    (wire,) = resolved(tmp_path, text, fmus(is_relative=True)).structure.wires
    assert (wire.factor, wire.offset) == (1.0, 0.0)


NUMBERS = st.integers(-8, 8).map(lambda n: n / 4)


@given(st.lists(st.tuples(NUMBERS, NUMBERS), min_size=1, max_size=5), NUMBERS)
def test_transformations_one_after_the_other_are_one(steps, value):
    total, expected = Carry(), value
    for factor, offset in steps:
        total = total.then(Carry.of(factor, offset))
        expected = factor * expected + offset
    # Quarters are exact in floating point, so nothing is rounded.
    assert total.apply(value) == expected


@given(
    st.lists(st.dictionaries(st.integers(0, 5), st.integers(0, 5), min_size=1), min_size=1, max_size=4),
    st.integers(0, 6),
)
def test_tables_one_after_the_other_are_one(tables, value):
    total, expected = Carry(), value
    for table in tables:
        total = total.then(Carry(table=table))
        expected = table.get(expected, expected)
    assert total.apply(value) == expected


def enumerated(name: str, causality: str, **items: int):
    return variable(name, causality, Kind.ENUMERATION, items=items)


MODES = {
    "source": model("source", enumerated("y", "output", off=0, slow=1, fast=2), variable("b", "output", Kind.BOOLEAN), variable("n", "output", Kind.INTEGER)),
    "same": model("same", enumerated("u", "input", off=7, slow=8, fast=9)),
    "other": model("other", enumerated("u", "input", halt=1, go=2)),
    "flag": model("flag", variable("u", "input", Kind.BOOLEAN)),
    "number": model("number", variable("u", "input", Kind.INTEGER)),
    "real": model("real", variable("u", "input")),
    "text": model("text", variable("u", "input", None)),
}  # fmt: skip


def joined(start: str, target: str, inner: str = "") -> str:
    return description(
        elements(component("source", f"output {start}"), component(target, "input u"))
        + connections(connection(f"source.{start}", f"{target}.u", inner))
    )


def table(kind: str, **entries: str) -> str:
    lines = "".join(f'<ssc:MapEntry source="{a}" target="{b}"/>' for a, b in entries.items())
    return f"<ssc:{kind}MappingTransformation>{lines}</ssc:{kind}MappingTransformation>"


@pytest.mark.parametrize(
    ("start", "target", "inner", "items"),
    [
        ("y", "same", "", ((0, 7), (1, 8), (2, 9))),
        ("y", "number", "", ()),
        ("n", "real", "", ()),
        ("b", "flag", "", ()),
        ("b", "flag", table("Boolean", true="false"), ((0, 0), (1, 0))),
        ("y", "other", table("Enumeration", off="halt", slow="go", fast="go"), ((0, 1), (1, 2), (2, 2))),
        ("n", "number", '<ssc:IntegerMappingTransformation><ssc:MapEntry source="3" target="4"/></ssc:IntegerMappingTransformation>', ((3, 4),)),
        ("y", "number", '<ssc:IntegerMappingTransformation><ssc:MapEntry source="2" target="1"/></ssc:IntegerMappingTransformation>', ((0, 0), (1, 1), (2, 1))),
    ],
)  # fmt: skip
def test_values_of_other_kinds_go_by_themselves_or_by_a_table(tmp_path, start, target, inner, items):
    (wire,) = resolved(tmp_path, joined(start, target, inner), MODES).structure.wires
    assert wire.items == items
    assert (wire.factor, wire.offset) == (1.0, 0.0)


@pytest.mark.parametrize(
    ("start", "target", "inner", "expected"),
    [
        ("y", "other", "", "enumerations differ: the source's item 'off' is none of halt, go"),
        ("y", "other", table("Enumeration", off="stop"), "'stop' is not an item of the target: halt, go"),
        ("y", "other", table("Enumeration", of="halt"), "'of' is not an item of the source"),
        ("b", "number", "", "types differ: bool and int"),
        ("n", "text", "", "types differ: int and String"),
        ("b", "flag", '<ssc:LinearTransformation factor="2"/>', "a linear transformation is for real values"),
        ("n", "number", table("Boolean", true="false"), "a Boolean table is not for int and int"),
        ("b", "flag", table("Boolean", yes="false"), "'yes' is neither true nor false"),
    ],
)
def test_what_cannot_be_connected_is_told_at_the_connection(tmp_path, start, target, inner, expected):
    (found,) = problems(tmp_path, joined(start, target, inner), MODES)
    assert expected in found
    assert "example.ssp/SystemStructure.ssd:4:" in found


@pytest.mark.parametrize(
    ("inner", "expected"),
    [
        (connection("a.y", "b.y"), "a.y - b.y: both ends give values"),
        (connection("a.u", "b.u"), "a.u - b.u: both ends take values"),
        (connection("a.y", "c.u"), "there is no element 'c'"),
        (connection("a.z", "b.u"), "'a' has no connector 'z'"),
        (connection("a.y", ".out"), "system 'top' has no connector 'out'"),
        (connection("a.y", "b.u") + connection("b.y", "b.u"), "b.u has a source already: a.y"),
    ],
)
def test_impossible_connections_are_told(tmp_path, inner, expected):
    found = problems(tmp_path, description(gains("a", "b") + connections(inner)), REAL)
    assert any(expected in problem for problem in found), found


def test_units_of_other_dimensions_are_refused(tmp_path):
    fmus = REAL | {"m": model("m", variable("u", "input", unit="m"))}
    text = elements(component("ms", "output y"), component("m", "input u")) + connections(connection("ms.y", "m.u"))
    assert "units differ: m/s and m" in problems(tmp_path, description(text), fmus)[0]


@pytest.mark.parametrize(
    ("inner", "expected"),
    [
        (component("gain", "input v"), "the FMU of gain has no variable 'v'\n    hint: possible: k, u, y"),
        (component("gain", "output u"), "gain.u is a connector of the kind output, the FMU's variable is input"),
        (component("gain", "input u").replace("/></ssd:Conn", "><ssc:Boolean/></ssd:Connector></ssd:Conn"), "the connector is bool, the FMU's variable real"),
        (component("kmh", "input u").replace("/></ssd:Conn", '><ssc:Real unit="m/s"/></ssd:Connector></ssd:Conn'), "the connector is in m/s, the FMU's variable in km/h"),
        (component("gain", "input u").replace("source=", 'implementation="ModelExchange" source='), "its FMU has no ModelExchange"),
    ],
)  # fmt: skip
def test_connectors_must_be_those_of_the_fmu(tmp_path, inner, expected):
    target = inner.partition('Component name="')[2][:4].strip('"') + (".v" if "'v'" in expected else ".u")
    used = connection(".x", target) if 'kind="input"' in inner else ""
    text = elements(inner) + connectors("input x") + connections(used)
    (found,) = problems(tmp_path, description(text, UNITS), REAL)
    assert expected in found


def test_all_outputs_with_connectors_are_recorded_and_the_systems_own_first(tmp_path):
    text = connectors("output speed") + two("kmh", "ms").replace(
        "</ssd:Connections>", connection("b.y", ".speed") + "</ssd:Connections>"
    )
    found = resolved(tmp_path, description(text), REAL)
    assert [(s.name, s.label, s.unit) for s in found.signals] == [
        ("speed", "b.y", "m/s"),
        ("a.y", "a.y", "km/h"),
        ("b.y", "b.y", "m/s"),
    ]
    assert found.record == ("b.y", "a.y")


def test_what_is_asked_for_is_recorded_instead(tmp_path):
    found = resolved(tmp_path, description(gains("a", "b")), REAL, record=["b.k", "a.u"])
    assert found.record == ("b.k", "a.u")
    assert "did you mean 'a.y'" in problems(tmp_path, description(gains("a")), REAL, record=["a.yy"])[0]


# Parameters


def starts(tmp_path, text, fmus=REAL, **options) -> dict[str, dict[str, float]]:
    return {e.name: dict(e.start) for e in resolved(tmp_path, text, fmus, **options).structure.elements}


def one(more: str) -> str:
    return component("gain", "input u", "output y", more=more)


def test_later_bindings_count_more_and_outer_ones_most(tmp_path):
    own = bindings(binding(parameter_set("k Real 1")), binding(parameter_set("k Real 2", "u Real 5")))
    assert starts(tmp_path, description(elements(one(own)))) == {"gain": {"k": 2.0, "u": 5.0}}
    outer = bindings(binding(parameter_set("gain.k Real 3")))
    assert starts(tmp_path, description(outer + elements(one(own)))) == {"gain": {"k": 3.0, "u": 5.0}}
    assert starts(tmp_path, description(outer + elements(one(own))), settings={"gain.k": "4"})["gain"]["k"] == 4.0


def test_hierarchical_names_reach_into_nested_systems(tmp_path):
    inner = f'<ssd:System name="s">{bindings(binding(parameter_set("gain.k Real 1")))}{elements(one(""))}</ssd:System>'
    outer = bindings(binding(parameter_set("s.gain.k Real 2", "s.gain.u Real 7")))
    assert starts(tmp_path, description(outer + elements(inner))) == {"s.gain": {"k": 2.0, "u": 7.0}}


def test_a_prefix_stands_before_every_name(tmp_path):
    outer = bindings(binding(parameter_set("k Real 8"), prefix="gain."))
    assert starts(tmp_path, description(outer + elements(one("")))) == {"gain": {"k": 8.0}}


def test_a_mapping_renames_transforms_and_leaves_out_what_it_does_not_name(tmp_path):
    linear = '<ssc:LinearTransformation factor="10" offset="1"/>'
    rules = mapping(entry("stiffness", "k", linear))
    own = bindings(binding(parameter_set("stiffness Real 2", "u Real 3"), rules))
    assert starts(tmp_path, description(elements(one(own)))) == {"gain": {"k": 21.0}}
    prefixed = bindings(binding(parameter_set("stiffness Real 2"), mapping(entry("x.stiffness", "k")), prefix="x."))
    assert starts(tmp_path, description(elements(one(prefixed)))) == {"gain": {"k": 2.0}}


def test_what_is_written_into_another_file_need_not_say_its_version(tmp_path):
    # OMSimulator writes mappings like this.
    values, rules = parameter_set("stiffness Real 2"), mapping(entry("stiffness", "k"))
    without = bindings(binding(*(text.replace(' version="1.0"', "") for text in (values, rules))))
    assert "version" not in without
    assert starts(tmp_path, description(elements(one(without)))) == {"gain": {"k": 2.0}}


def test_a_value_of_a_systems_connector_goes_where_it_is_connected(tmp_path):
    inner = (
        f'<ssd:System name="s">{connectors("parameter stiffness")}'
        + elements(component("gain", "parameter k"))
        + connections(connection(".stiffness", "gain.k", '<ssc:LinearTransformation factor="2"/>'))
        + "</ssd:System>"
    )
    outer = bindings(binding(parameter_set("s.stiffness Real 4")))
    assert starts(tmp_path, description(outer + elements(inner))) == {"s.gain": {"k": 8.0}}
    assert starts(tmp_path, description(elements(inner)), settings={"s.stiffness": "5"}) == {"s.gain": {"k": 10.0}}


def test_a_value_that_comes_over_a_connection_counts_more_than_the_components_own(tmp_path):
    own = bindings(binding(parameter_set("k Real 1")))
    inner = (
        f'<ssd:System name="s">{connectors("parameter stiffness")}'
        + bindings(binding(parameter_set("stiffness Real 4")))
        + elements(component("gain", "parameter k", more=own))
        + connections(connection(".stiffness", "gain.k"))
        + "</ssd:System>"
    )
    text = description(elements(inner))
    assert starts(tmp_path, text) == {"s.gain": {"k": 4.0}}
    assert [note.what for note in resolved(tmp_path, text, REAL).notes] == [
        "s.gain.k is given another over a connection; the value here is not used"
    ]
    assert starts(tmp_path, text, settings={"s.gain.k": "7"}) == {"s.gain": {"k": 7.0}}
    # Nothing comes over the connection: the component's own value stays.
    silent = text.replace('<ssv:Parameter name="stiffness">', '<ssv:Parameter name="other">')
    assert starts(tmp_path, silent) == {"s.gain": {"k": 1.0}}


def test_a_structural_parameter_is_given_its_value_itself(tmp_path):
    text = (
        connectors("structuralParameter size")
        + bindings(binding(parameter_set("size Int32 3", version="2.0")))
        + elements(component("all", "structuralParameter n"))
        + connections(connection(".size", "all.n"))
    )
    (found,) = problems(tmp_path, description(text, version="2.0"), TYPED)
    assert "all.n: a structural parameter that is set over a connection is not supported" in found


def test_an_input_of_the_whole_system_keeps_the_value_it_is_given(tmp_path):
    text = connectors("input demand") + elements(one("")) + connections(connection(".demand", "gain.u"))
    outer = bindings(binding(parameter_set("demand Real 6")))
    assert starts(
        tmp_path, description(connectors("input demand") + outer + text.removeprefix(connectors("input demand")))
    ) == {"gain": {"u": 6.0}}
    assert starts(tmp_path, description(text)) == {"gain": {}}


def test_values_are_converted_to_the_fmus_unit(tmp_path):
    own = bindings(binding(parameter_set("u Real 10 m/s", more=UNITS.replace("ssd:Units", "ssv:Units"))))
    text = description(elements(component("kmh", "input u", more=own)))
    assert math.isclose(starts(tmp_path, text)["kmh"]["u"], 36.0, rel_tol=1e-15)
    assert math.isclose(starts(tmp_path, text, settings={"kmh.u": "20 m/s"})["kmh"]["u"], 72.0, rel_tol=1e-15)
    assert starts(tmp_path, text, settings={"kmh.u": "20"})["kmh"]["u"] == 20.0
    rules = mapping(entry("u", "u", suppressUnitConversion="true"))
    raw = bindings(binding(parameter_set("u Real 10 m/s", more=UNITS.replace("ssd:Units", "ssv:Units")), rules))
    assert starts(tmp_path, description(elements(component("kmh", "input u", more=raw))))["kmh"]["u"] == 10.0


TYPED = {
    "all": model(
        "all",
        variable("r", "parameter"),
        variable("i", "parameter", Kind.INTEGER),
        variable("b", "parameter", Kind.BOOLEAN),
        enumerated("e", "parameter", low=10, high=20),
        variable("s", "parameter", None),
        variable("x", "parameter", None, fmi_type="Binary"),
        variable("v", "parameter", shape=(2, 2), sized_by=("n", ""), start=("0",)),
        variable("n", "structuralParameter", Kind.INTEGER, start=("2",)),
    )
}


def test_every_type_of_value_is_taken(tmp_path):
    values = ["r Integer 3", "i Integer 4", "b Boolean true", "e Enumeration high", "s String some", "x Binary 00ff"]
    own = bindings(binding(parameter_set(*values)))
    (element,) = resolved(tmp_path, description(elements(component("all", more=own))), TYPED).structure.elements
    assert element.start == {"b": 1.0, "e": 20.0, "i": 4.0, "r": 3.0}
    assert element.texts == {"s": "some", "x": b"\x00\xff"}


def test_an_array_takes_the_size_of_its_structural_parameter_and_all_its_values(tmp_path):
    values = parameter_set("n Int32 3", "v Float64 V", version="2.0").replace('"V"', '"1 2 3 4 5 6"')
    text = description(elements(component("all", more=bindings(binding(values)))), version="2.0")
    (element,) = resolved(tmp_path, text, TYPED).structure.elements
    assert element.model.variables["v"].shape == (3, 2)
    assert [element.start[label] for label in element.model.variables["v"].labels] == [1, 2, 3, 4, 5, 6]
    assert element.start["n"] == 3.0
    wrong = parameter_set("v Float64 V", version="2.0").replace('"V"', '"1 2 3"')
    text = description(elements(component("all", more=bindings(binding(wrong)))), version="2.0")
    assert "'v' has 4 values, 3 are given" in problems(tmp_path, text, TYPED)[0]


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        ("i Real 1.5", "types differ: real and int"),
        ("b Integer 1", "types differ: int and bool"),
        ("e Enumeration middle", "'middle' is none of low, high"),
        ("r String some", "a value of the type String cannot be given to real"),
        ("s Real 1", "a value of the type Real cannot be given to String"),
        ("x Binary 0", "'0' is not a sequence of hexadecimal digits"),
        ("r Real fast", "'fast' is not of the type Real"),
    ],
)
def test_values_of_other_types_are_refused_where_they_stand(tmp_path, value, expected):
    text = description(elements(component("all", more=bindings(binding(parameter_set(value))))))
    (found,) = problems(tmp_path, text, TYPED)
    assert expected in found
    assert "SystemStructure.ssd:4:" in found


COMPUTED = {
    "twice": model(
        "twice",
        variable("k", "parameter"),
        variable("double", "calculatedParameter", is_settable=False),
        variable("y", "output", is_settable=False),
        variable("pi", "local", variability="constant", is_settable=False),
        variable("time", "independent", is_settable=False),
        variable("gain", "parameter", reference=7),
        variable("other", "parameter", reference=7),
    )
}


def test_what_an_fmu_computes_is_not_set_and_that_is_told(tmp_path):
    values = parameter_set("k Real 1", "double Real 5", "y Real 6", "pi Real 3", "time Real 2")
    text = description(elements(component("twice", more=bindings(binding(values)))))
    found = resolved(tmp_path, text, COMPUTED)
    assert found.structure.element("twice").start == {"k": 1.0}
    end = "; the value here is not used"
    assert sorted(note.what for note in found.notes) == [
        f"twice.double takes no value: it is calculatedParameter, which the FMU computes{end}",
        f"twice.pi takes no value: it is constant{end}",
        f"twice.time takes no value: it is independent, which the FMU computes{end}",
        f"twice.y takes no value: it is output, which the FMU computes{end}",
    ]
    assert all(note.where and note.where.file.endswith("SystemStructure.ssd") for note in found.notes)
    (typed,) = problems(tmp_path, text.replace("double", "gone"), COMPUTED, settings={"twice.double": "5"})
    assert "twice.double takes no value" in typed
    assert "hint: set what it is computed from" in typed


def test_a_value_of_a_connected_input_is_told_and_not_set(tmp_path):
    own = bindings(binding(parameter_set("u Real 3", "k Real 2")))
    second = component("b", "input u", "output y", source="resources/gain.fmu", more=own)
    first = component("a", "input u", "output y", source="resources/gain.fmu")
    text = description(elements(first, second) + connections(connection("a.y", "b.u")))
    found = resolved(tmp_path, text, REAL)
    assert found.structure.element("b").start == {"k": 2.0}
    assert [note.what for note in found.notes] == ["b.u is connected; the value here is not used"]
    (typed,) = problems(tmp_path, text, REAL, settings={"b.u": "5"})
    assert "b.u is connected" in typed
    assert "hint: set what it is connected to" in typed


def test_two_names_of_one_variable_take_one_value(tmp_path):
    values = parameter_set("gain Real 1", "other Real 2")
    found = resolved(tmp_path, description(elements(component("twice", more=bindings(binding(values))))), COMPUTED)
    assert found.structure.element("twice").start == {"gain": 1.0}
    assert [note.what for note in found.notes] == [
        "twice.other is the variable that is given a value as 'gain'; the value here is not used"
    ]


def test_names_that_match_nothing_are_told_and_ignored(tmp_path):
    own = bindings(binding(parameter_set("gone Real 1"), ""))
    found = resolved(tmp_path, description(elements(one(own))), REAL)
    assert [note.what for note in found.notes] == ["nothing in gain is called 'gone'; its value is not used"]
    assert "there is no 'gain.kk' to set\n    hint: did you mean 'gain.k'" in problems(
        tmp_path, description(elements(one(""))), REAL, settings={"gain.kk": "1"}
    )[0]  # fmt: skip


def test_a_calculated_parameter_cannot_set_a_parameter(tmp_path):
    fmus = REAL | {"calc": model("calc", variable("c", "calculatedParameter"))}
    text = elements(component("calc", "calculatedParameter c"), component("gain", "parameter k"))
    text += connections(connection("calc.c", "gain.k"))
    assert (
        "a calculated parameter that sets a parameter is not supported"
        in problems(tmp_path, description(text), fmus)[0]
    )


# Signal dictionaries


def dictionary(*entries: str) -> str:
    lines = "".join(
        f'<ssb:DictionaryEntry name="{name}"><ssc:Real unit="km/h"/></ssb:DictionaryEntry>' for name in entries
    )
    return (
        '<ssd:SignalDictionaries><ssd:SignalDictionary name="bus"><ssb:SignalDictionary version="1.0">'
        f"{lines}{UNITS.replace('ssd:Units', 'ssb:Units')}</ssb:SignalDictionary></ssd:SignalDictionary></ssd:SignalDictionaries>"
    )


def reference(name: str, kind: str = "inout") -> str:
    return f'<ssd:SignalDictionaryReference name="{name}" dictionary="bus">{connectors(f"{kind} speed")}</ssd:SignalDictionaryReference>'


def test_a_signal_dictionary_joins_all_that_is_connected_to_its_entry(tmp_path):
    inner = f'<ssd:System name="s">{elements(component("c", "input u", source="resources/kmh.fmu"), reference("near"))}'
    inner += connections(connection("c.u", "near.speed")) + "</ssd:System>"
    text = elements(
        component("a", "output y", source="resources/ms.fmu"),
        component("b", "input u", source="resources/ms.fmu"),
        reference("there"),
        reference("here"),
        inner,
    )
    text += connections(connection("a.y", "there.speed"), connection("here.speed", "b.u")) + dictionary("speed")
    found = resolved(tmp_path, description(text), REAL)
    assert sorted(wires(found)) == [("a.y", "b.u"), ("a.y", "s.c.u")]
    factors = {wire.target: wire.factor for wire in found.structure.wires}
    # The dictionary's entry is in km/h, b in m/s, c in km/h.
    assert math.isclose(factors["b"], 1.0, rel_tol=1e-15)
    assert math.isclose(factors["s.c"], 3.6, rel_tol=1e-15)


def test_two_sources_of_one_entry_are_refused(tmp_path):
    text = elements(*(component(n, "output y", source="resources/ms.fmu") for n in "ab"), reference("bus"))
    text += connections(connection("a.y", "bus.speed"), connection("b.y", "bus.speed")) + dictionary("speed")
    assert "bus.speed has a source already: a.y" in problems(tmp_path, description(text), REAL)[0]


def test_a_dictionary_that_is_not_there_is_refused(tmp_path):
    text = elements(reference("bus").replace('dictionary="bus"', 'dictionary="buzz"')) + dictionary("speed")
    assert (
        "there is no signal dictionary 'buzz'\n    hint: possible: bus"
        in problems(tmp_path, description(text), REAL)[0]
    )


# Arrays


ARRAYS = {
    "source": model("source", variable("y", "output", shape=(3,), sized_by=("",)), variable("z", "output")),
    "sink": model("sink", variable("u", "input", shape=(3,), sized_by=("",)), variable("w", "input")),
}


def array_system(*inner: str) -> str:
    return description(
        elements(component("source", "output y", "output z"), component("sink", "input u", "input w"))
        + connections(*inner),
        version="2.0",
    )


def test_whole_arrays_and_single_values_are_connected(tmp_path):
    assert wires(resolved(tmp_path, array_system(connection("source.y", "sink.u")), ARRAYS)) == [("source.y", "sink.u")]
    picked = connection("source.y", "sink.w", startIndices="2")
    placed = connection("source.z", "sink.u", endIndices="3")
    assert sorted(wires(resolved(tmp_path, array_system(picked, placed), ARRAYS))) == [
        ("source.y[2]", "sink.w"),
        ("source.z", "sink.u[3]"),
    ]


def test_an_array_of_one_value_and_a_single_value_are_connected(tmp_path):
    one = variable("one", "input", shape=(1, 1), sized_by=("", ""))
    fmus = {"source": ARRAYS["source"], "sink": model("sink", one)}
    said = elements(component("source", "output z"), component("sink", "input one"))
    text = description(said + connections(connection("source.z", "sink.one")), version="2.0")
    assert wires(resolved(tmp_path, text, fmus)) == [("source.z", "sink.one[1,1]")]


def test_values_of_an_array_that_nothing_arrives_at_keep_what_they_are_given(tmp_path):
    given = bindings(binding(parameter_set("u[1] Real 4", "u[2] Real 5", "u[3] Real 6", "w Real 7")))
    inner = [component("source", "output y", "output z"), component("sink", "input u", "input w", more=given)]
    placed = connections(connection("source.z", "sink.u", endIndices="1"), connection("source.z", "sink.w"))
    found = resolved(tmp_path, description(elements(*inner) + placed, version="2.0"), ARRAYS)
    assert dict(found.structure.element("sink").start) == {"u[2]": 5.0, "u[3]": 6.0}


@pytest.mark.parametrize("number", ["NaN", "INF", "-INF"])
def test_a_start_value_is_finite(tmp_path, number):
    given = bindings(binding(parameter_set(f"k Real {number}")))
    (found,) = problems(tmp_path, description(elements(component("gain", "input u", more=given))), REAL)
    assert f"gain.k: '{number}' is not a number that an FMU can begin with" in found


@pytest.mark.parametrize(
    ("inner", "expected"),
    [
        (connection("source.y", "sink.w"), "shapes differ: 3 and one value"),
        (connection("source.y", "sink.w", startIndices="4"), "'y' (3) has no value 4"),
        (connection("source.z", "sink.w", startIndices="1"), "'z' (no array) has no value 1"),
    ],
)
def test_arrays_of_other_shapes_are_refused(tmp_path, inner, expected):
    assert expected in problems(tmp_path, array_system(inner), ARRAYS)[0]


def test_a_component_may_ask_for_the_kind_of_fmu_it_gets(tmp_path):
    fmus = {"gain": REAL["gain"]}
    assert fmus["gain"].interface is FmiInterface.CO_SIMULATION
    text = description(elements(component("gain").replace("source=", 'implementation="CoSimulation" source=')))
    assert [e.name for e in resolved(tmp_path, text, fmus).structure.elements] == ["gain"]
