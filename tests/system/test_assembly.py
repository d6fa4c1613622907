"""Connections are checked port by port; every message names both ends."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import networkx as nx
import pytest
from hypothesis import given, strategies as st

from dse.domain.component import Causality, Component, Interface, Kind, Parameter, Port, Type
from dse.domain.design import Connection
from dse.domain.fmu import FmuModel, Variable
from dse.domain.system import Conversion, Wire
from dse.errors import DseError, Location
from dse.system.assembly import Elements, WiredParts, along_the_flow, assemble
from dse.units import parse_unit

METRE = Type(Kind.REAL, parse_unit("m"))
SPEED = Type(Kind.REAL, parse_unit("m/s"))
MODE = Type(Kind.ENUMERATION, items=("speed", "distance"))
IN, OUT = Causality.INPUT, Causality.OUTPUT
HERE = Location("bench.yaml", 7, 5)


def component(name: str, *ports: tuple[str, Causality, Type], parameters: tuple[Parameter, ...] = ()) -> Component:
    return Component(name, Interface(f"{name}_interface", tuple(Port(*port) for port in ports)), parameters=parameters)


def model(part: Component, **changes: dict[str, object]) -> FmuModel:
    variables = {}
    described = [(p.name, str(p.causality), p.type) for p in part.interface.ports]
    described += [(p.name, "parameter", p.type) for p in part.parameters]
    for reference, (name, causality, type_) in enumerate(described):
        fields = {"causality": causality, "kind": type_.kind, "unit": type_.unit.symbol} | changes.get(name, {})
        variables[name] = Variable(name, **{"reference": reference, "fmi_type": "Real"} | fields)
    nowhere = Path("nowhere")
    return FmuModel(nowhere, nowhere, nowhere, 2, part.name, "{}", variables)


SENSOR = component("radar", ("gap", OUT, METRE), ("rate", OUT, SPEED))
KP = Parameter("kp", Type(Kind.REAL), 0.8)
CONTROLLER = component("pd", ("distance", IN, METRE), ("speed", IN, SPEED), ("mode", OUT, MODE), parameters=(KP,))
DISPLAY = component("display", ("mode", IN, MODE))
PARTS = {"sensor": SENSOR, "controller": CONTROLLER}
MODELS = {"radar": model(SENSOR), "pd": model(CONTROLLER), "display": model(DISPLAY)}
WIRES = (
    Connection("sensor.gap", "controller.distance", HERE),
    Connection("sensor.rate", "controller.speed", HERE),
)


def problem(parts=PARTS, wires=WIRES, values=(), models=MODELS, outputs=()) -> str:
    with pytest.raises(DseError) as caught:
        assemble("s", WiredParts(parts, tuple(wires), dict(values)), models, outputs)
    (found,) = caught.value.problems
    return str(found)


def test_a_system_holds_its_elements_wires_and_start_values():
    system = assemble("s", WiredParts(PARTS, WIRES, {"controller.kp": 1.5}), MODELS, ["controller.mode"])
    assert [element.name for element in system.elements] == ["sensor", "controller"]
    assert [variable.name for variable in system.element("controller").inputs] == ["distance", "speed"]
    assert [variable.name for variable in system.element("controller").outputs] == ["mode"]
    assert system.element("controller").start == {"kp": 1.5}
    assert [(w.source, w.source_variable, w.target, w.target_variable) for w in system.wires] == [
        ("sensor", "gap", "controller", "distance"),
        ("sensor", "rate", "controller", "speed"),
    ]


def test_an_element_that_is_used_alike_in_several_systems_is_made_once():
    made = Elements()

    def system(outputs=(), **values):
        given = {f"controller.{name}": value for name, value in values.items()}
        parts = WiredParts(PARTS, WIRES, given)
        found = assemble("s", parts, MODELS, outputs, made)
        assert found == assemble("s", parts, MODELS, outputs)
        return found.element("sensor"), found.element("controller")

    sensor, controller = system()
    assert system()[1] is controller
    assert system(kp=1.0)[0] is sensor
    assert system(kp=1.0)[1] is not controller
    assert str(system(kp=0.0)[1].start["kp"]) == "0.0"
    assert str(system(kp=-0.0)[1].start["kp"]) == "-0.0"
    assert system(outputs=["controller.mode"])[1] is not controller
    wrong = {**MODELS, "radar": model(SENSOR, gap={"unit": "kg"})}
    for _ in range(2):  # what is wrong is told again
        with pytest.raises(DseError, match="kg"):
            assemble("s", WiredParts(PARTS, WIRES), wrong, [], made)


def test_outputs_nobody_reads_are_left_out():
    system = assemble("s", WiredParts(PARTS, WIRES), MODELS, [])
    assert system.element("controller").outputs == ()


def test_elements_stand_along_the_flow_of_signals():
    parts = {"controller": CONTROLLER, "sensor": SENSOR}
    assert [element.name for element in assemble("s", WiredParts(parts, WIRES), MODELS, []).elements] == [
        "sensor",
        "controller",
    ]


@given(st.data())
def test_the_order_along_the_flow_is_that_of_networkx(data):
    names = data.draw(st.permutations([f"part{number}" for number in range(data.draw(st.integers(0, 12)))]))
    ends = st.sampled_from(names) if names else st.nothing()
    wires = [Wire(source, "y", target, "u") for source, target in data.draw(st.lists(st.tuples(ends, ends)))]
    graph = nx.DiGraph()
    graph.add_nodes_from(names)
    graph.add_edges_from((wire.source, wire.target) for wire in wires)
    condensed = nx.condensation(graph)
    loops = {node: sorted(members, key=names.index) for node, members in condensed.nodes(data="members")}
    order = nx.lexicographical_topological_sort(condensed, key=lambda node: names.index(loops[node][0]))
    assert along_the_flow(names, wires) == [name for node in order for name in loops[node]]


def test_an_enumeration_is_started_by_its_items_number():
    system = assemble("s", WiredParts({"display": DISPLAY}, (), {"display.mode": "distance"}), MODELS, [])
    assert system.element("display").start == {"mode": 1.0}


def test_units_that_differ_are_refused_and_the_fitting_port_is_hinted():
    wires = [Connection("sensor.gap", "controller.speed", HERE), WIRES[0]]
    with pytest.raises(DseError) as caught:
        assemble("s", WiredParts(PARTS, tuple(wires)), MODELS, [])
    first = next(p for p in caught.value.problems if "units differ" in p.what)
    assert str(first) == (
        "bench.yaml:7:5: sensor.gap -> controller.speed: units differ: m and m/s\n    hint: connect sensor.rate"
    )


def test_cycles_and_angles_cannot_be_connected():
    turning = component("turning", ("rate", OUT, Type(Kind.REAL, parse_unit("rad/s"))))
    beating = component("beating", ("rate", IN, Type(Kind.REAL, parse_unit("Hz"))))
    parts, fmus = {"a": turning, "b": beating}, {"turning": model(turning), "beating": model(beating)}
    with pytest.raises(DseError, match=r"units differ by 2 pi: rad/s and Hz"):
        assemble("s", WiredParts(parts, (Connection("a.rate", "b.rate"),)), fmus, [])


def test_types_that_differ_are_refused():
    parts = {"sensor": SENSOR, "display": DISPLAY}
    with pytest.raises(DseError, match=r"types differ: m and enum\[speed, distance\]"):
        assemble("s", WiredParts(parts, (Connection("sensor.gap", "display.mode"),)), MODELS, [])


def test_an_input_with_neither_source_nor_value_is_refused():
    text = problem(wires=WIRES[:1])
    assert "input controller.speed (pd) is neither connected nor given a value" in text
    assert "-> controller.speed" in text


def test_inputs_of_one_part_that_lack_a_source_are_told_at_once_where_the_bench_is():
    with pytest.raises(DseError) as caught:
        assemble("s", WiredParts(PARTS, (), {}, HERE), MODELS, [])
    (found,) = caught.value.problems
    assert found.what == "2 inputs of controller (pd) are neither connected nor given a value: distance, speed"
    assert found.where == HERE


def test_optional_inputs_need_no_source_and_may_have_one():
    optional = replace(CONTROLLER.interface, optional=("speed",))
    parts = PARTS | {"controller": replace(CONTROLLER, interface=optional)}
    for wires in (WIRES[:1], WIRES):
        assert len(assemble("s", WiredParts(parts, wires, {}), MODELS, []).wires) == len(wires)


def test_an_input_whose_connection_is_refused_is_told_once():
    text = problem(wires=[WIRES[0], Connection("sensor.gap", "controller.speed", HERE)])
    assert "units differ" in text


def test_an_input_with_source_and_value_is_refused():
    assert "controller.speed is given a value and connected to sensor.rate" in problem(
        values=[("controller.speed", 1.0)]
    )


def test_a_variable_missing_from_the_fmu_is_named():
    smaller = model(component("radar", ("gap", OUT, METRE)))
    text = problem(models={**MODELS, "radar": smaller})
    assert "the FMU of radar has no variable 'rate'" in text
    assert "possible: gap" in text


def test_a_variable_of_another_dimension_is_refused():
    text = problem(models={**MODELS, "radar": model(SENSOR, gap={"unit": "kg"})})
    assert "'gap' in the FMU of radar is in kg, expected m" in text


def test_a_variable_in_another_unit_is_converted():
    system = assemble("s", WiredParts(PARTS, WIRES), {**MODELS, "radar": model(SENSOR, gap={"unit": "km"})}, [])
    assert system.element("sensor").conversions == {"gap": Conversion(1000.0, 0.0)}


def test_two_parameters_that_are_one_value_of_the_fmu_are_refused():
    gain = Parameter("gain", Type(Kind.REAL), 1.0)
    double = component(
        "pd", *((p.name, p.causality, p.type) for p in CONTROLLER.interface.ports), parameters=(KP, gain)
    )
    text = problem(parts={**PARTS, "controller": double}, models={**MODELS, "pd": model(double, gain={"reference": 3})})
    assert "'kp' and 'gain' of pd are one value of its FMU, 'gain'" in text
    assert "map one of them to another variable" in text


def test_a_variable_of_another_causality_is_refused():
    text = problem(models={**MODELS, "radar": model(SENSOR, gap={"causality": "local"})})
    assert "'gap' in the FMU of radar is local, not output" in text
