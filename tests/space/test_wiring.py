"""Connections of containers end at the ports of the components that were chosen."""

from __future__ import annotations

import pytest
from hypothesis import given, strategies as st

from dse.domain.component import Causality, Component, Interface, Kind, Port, Type
from dse.domain.design import Alternative, Compound, Connection, DesignSpace, Optional, Part
from dse.domain.labels import is_part, wholes
from dse.errors import DseError, Location
from dse.space.check import check_space
from dse.space.configurations.wiring import architecture_outputs, wire
from dse.space.restriction.refine import refine
from dse.space.space import open_space

REAL = Type(Kind.REAL)


def interface(name, inputs="", outputs=""):
    into = [Port(port, Causality.INPUT, REAL) for port in inputs.split()]
    return Interface(name, (*into, *(Port(port, Causality.OUTPUT, REAL) for port in outputs.split())))


def part(name, of):
    return Part(Component(name, of), Location("components.yaml", 1, 1))


def wires(*texts):
    return tuple(Connection(*text.split(" -> "), Location("car.yaml", n, 5)) for n, text in enumerate(texts, 1))


def car(parts, *texts):
    return DesignSpace("car", Compound("car", parts, wires(*texts)), where=Location("car.yaml", 1, 1))


def listed(connections):
    return [str(connection) for connection in connections]


SENSOR = interface("range_sensor", outputs="target.gap target.speed status")
CONTROLLER = interface("controller", "target.gap target.speed", "demand.drive demand.brake")
POWERTRAIN = interface("powertrain", "demand.drive demand.brake wheel_speed", "wheels.torque")
ENGINE = interface("engine", "drive shaft.speed", "shaft.torque")
GEARBOX = interface("gearbox", "side.torque second wheel_speed brake", "side.speed out.torque")

HYBRID = Compound(
    "hybrid",
    {"engine": part("otto", ENGINE), "box": part("dct", GEARBOX), "boost": Optional(part("motor", ENGINE))},
    wires(
        "demand.drive -> engine.drive",
        "demand.drive -> boost.drive",
        "demand.brake -> box.brake",
        "wheel_speed -> box.wheel_speed",
        "engine.shaft -> box.side",
        "boost.shaft.torque -> box.second",
        "box.out -> wheels",
    ),
    POWERTRAIN,
)
PARTS = {
    "sensor": Alternative((part("radar", SENSOR), part("lidar", SENSOR))),
    "controller": part("pd", CONTROLLER),
    "powertrain": Alternative((part("simple", POWERTRAIN), HYBRID)),
}
CAR = car(PARTS, "sensor.target -> controller.target", "controller.demand -> powertrain.demand")


def test_groups_connect_port_by_port():
    assert listed(wire(CAR, {"sensor": "radar", "powertrain": "simple"})) == [
        "sensor.target.gap -> controller.target.gap",
        "sensor.target.speed -> controller.target.speed",
        "controller.demand.drive -> powertrain.demand.drive",
        "controller.demand.brake -> powertrain.demand.brake",
    ]


def test_a_connection_to_an_architecture_ends_at_the_parts_inside_and_may_fan_out():
    choices = {"sensor": "radar", "powertrain": "hybrid", "powertrain.boost": "motor"}
    assert listed(wire(CAR, choices))[2:] == [
        "controller.demand.drive -> powertrain.engine.drive",
        "controller.demand.drive -> powertrain.boost.drive",
        "controller.demand.brake -> powertrain.box.brake",
        "powertrain.engine.shaft.torque -> powertrain.box.side.torque",
        "powertrain.box.side.speed -> powertrain.engine.shaft.speed",
        "powertrain.boost.shaft.torque -> powertrain.box.second",
    ]


def test_connections_of_an_absent_part_vanish():
    found = listed(wire(CAR, {"sensor": "radar", "powertrain": "hybrid"}))
    assert "controller.demand.drive -> powertrain.engine.drive" in found
    assert not [text for text in found if "boost" in text]


def test_a_bench_reaches_through_the_architecture_in_both_directions():
    world = interface("world", "wheels.torque", "wheel_speed")
    bench = wires("powertrain.wheels -> world.wheels", "world.wheel_speed -> powertrain.wheel_speed")
    found = wire(CAR, {"sensor": "radar", "powertrain": "hybrid"}, {"world": Component("world", world)}, bench)
    assert "powertrain.box.out.torque -> world.wheels.torque" in listed(found)
    assert "world.wheel_speed -> powertrain.box.wheel_speed" in listed(found)


def test_a_resolved_connection_stands_where_the_outermost_one_was_written():
    found = wire(CAR, {"sensor": "radar", "powertrain": "hybrid"})
    places = {str(connection): connection.where.line for connection in found}
    assert places["controller.demand.drive -> powertrain.engine.drive"] == 2
    assert places["powertrain.engine.shaft.torque -> powertrain.box.side.torque"] == 5


def test_every_configuration_carries_its_own_wiring():
    for configuration in open_space(CAR).configurations():
        assert configuration.connections == wire(CAR, configuration.choices)
        ends = {end.rpartition(".")[0] for c in configuration.connections for end in (c.source, c.target)}
        assert all(any(end == p or end.startswith(f"{p}.") for p in configuration.parts) for end in ends)


def test_architectures_nest_and_a_compound_without_interface_shows_its_parts():
    inner = Compound("inner", {"e": part("otto", ENGINE)}, wires("drive -> e.drive", "e.shaft -> shaft"), ENGINE)
    axle = Compound("axle", {"motor": Alternative((inner,))})
    space = car({"front": axle, "box": part("dct", GEARBOX)}, "front.motor.shaft -> box.side")
    assert sorted(listed(wire(space, {"front.motor": "inner"}))) == [
        "box.side.speed -> front.motor.e.shaft.speed",
        "front.motor.e.shaft.torque -> box.side.torque",
    ]
    assert check_space(space) == []


def test_an_architecture_shows_the_outputs_of_the_parts_behind_it():
    choices = {"sensor": "radar", "powertrain": "hybrid"}
    assert architecture_outputs(CAR, choices) == {"powertrain.wheels.torque": "powertrain.box.out.torque"}
    assert architecture_outputs(CAR, {"sensor": "radar", "powertrain": "simple"}) == {}


def test_an_output_is_seen_through_nested_architectures():
    inner = Compound("inner", {"e": part("otto", ENGINE)}, wires("drive -> e.drive", "e.shaft -> shaft"), ENGINE)
    outer = Compound("outer", {"m": inner}, wires("drive -> m.drive", "m.shaft -> shaft"), ENGINE)
    assert architecture_outputs(car({"drive": outer, "box": part("dct", GEARBOX)}, "drive.shaft -> box.side"), {}) == {
        "drive.m.shaft.torque": "drive.m.e.shaft.torque",
        "drive.shaft.torque": "drive.m.e.shaft.torque",
    }


def test_the_example_has_no_problems():
    assert check_space(CAR) == []


@pytest.mark.parametrize(
    ("text", "what", "hint"),
    [
        ("sensr.target -> controller.target", "unknown part 'sensr'", "did you mean 'sensor'"),
        ("sensor.targt -> controller.target", "sensor (range_sensor) has no port 'targt'", "did you mean 'target'"),
        ("sensor -> controller.target", "sensor (range_sensor) is without a port", "possible"),
        ("controller.target -> sensor.target", "no signal goes this way", "turn the arrow around"),
        ("sensor.status -> controller.target.gap", None, None),
        ("sensor.status -> controller.target", "no signal goes this way", "one side has"),
        ("sensor.target -> controller", "controller (controller) is without a port", "possible"),
        ("controller.demand -> controller.demand", "no signal goes this way", "one side has"),
        ("powertrain.engine.shaft -> controller.target.gap", "powertrain (powertrain) has no port", "possible"),
    ],
)
def test_a_connection_that_cannot_be_made_is_located_and_names_both_ends(text, what, hint):
    problems = check_space(car(PARTS, text))
    if what is None:
        assert problems == []
        return
    (problem,) = problems
    assert problem.what.startswith(f"{text}: ")
    assert what in problem.what
    assert hint in problem.hint
    assert problem.where == Location("car.yaml", 1, 5)


def test_a_port_that_is_given_nothing_is_named():
    thin = {**PARTS, "sensor": part("thin", interface("thin", outputs="target.gap other"))}
    (problem,) = check_space(car(thin, "sensor.target -> controller.target"))
    assert "nothing is given to controller.target.speed" in problem.what
    assert "sensor.target has gap (output)" in problem.hint


def test_two_sources_of_one_input_are_refused_with_both_places():
    twice = car(PARTS, "sensor.target -> controller.target", "sensor.status -> controller.target.gap")
    (problem,) = check_space(twice)
    assert "controller.target.gap has a source already" in problem.what
    assert "sensor.target -> controller.target at car.yaml:1:5" in problem.hint
    with pytest.raises(DseError, match="has a source already"):
        wire(twice, {"sensor": "radar", "powertrain": "simple"})


def test_two_optional_sources_are_refused_only_where_both_are_there():
    parts = {"a": Optional(part("radar", SENSOR)), "b": Optional(part("lidar", SENSOR)), "c": part("pd", CONTROLLER)}
    space = car(parts, "a.target -> c.target", "b.target -> c.target")
    assert check_space(space) == []
    assert listed(wire(space, {"b": "lidar"}))[0] == "b.target.gap -> c.target.gap"
    with pytest.raises(DseError, match=r"c\.target\.gap has a source already"):
        wire(space, {"a": "radar", "b": "lidar"})


def test_a_connection_from_an_optional_part_replaces_one_from_a_part_that_is_always_there():
    parts = {"c": part("pd", CONTROLLER), "slip": Optional(part("filter", interface("f", "raw", "clean")))}
    parts |= {"sensor": part("radar", SENSOR)}
    texts = "sensor.target -> c.target", "sensor.target.gap -> slip.raw", "slip.clean -> c.target.gap"
    for space in (car(parts, *texts), car(parts, *reversed(texts))):
        assert check_space(space) == []
        assert set(listed(wire(space, {}))) == {
            "sensor.target.gap -> c.target.gap",
            "sensor.target.speed -> c.target.speed",
        }
        assert set(listed(wire(space, {"slip": "filter"}))) == {
            "sensor.target.gap -> slip.raw",
            "slip.clean -> c.target.gap",
            "sensor.target.speed -> c.target.speed",
        }
        refined = refine(space, {"slip": ["filter"]})
        assert check_space(refined) == []
        assert [each.connections for each in open_space(refined).configurations()] == [wire(space, {"slip": "filter"})]


def test_an_output_of_an_architecture_that_nothing_gives_is_found():
    hollow = Compound("hollow", {"box": part("dct", GEARBOX)}, (), POWERTRAIN, Location("car.yaml", 9, 3))
    (problem,) = check_space(car({"powertrain": Alternative((part("simple", POWERTRAIN), hollow))}))
    assert "nothing inside 'hollow' gives its output 'wheels.torque'" in problem.what
    assert problem.where == Location("car.yaml", 9, 3)


def test_alternatives_that_are_not_exchangeable_are_found():
    bare = Compound("bare", {"box": part("dct", GEARBOX)}, (), None, Location("car.yaml", 9, 3))
    other = part("brick", GEARBOX)
    first, second = check_space(car({"powertrain": Alternative((part("simple", POWERTRAIN), bare, other))}))
    assert "an architecture among alternatives without an interface" in first.what
    assert "'simple' is a powertrain, 'brick' a gearbox" in second.what
    assert second.where == other.where


@given(st.lists(st.from_regex(r"[ab](\.[ab]|\[[12]\]){0,3}", fullmatch=True), unique=True))
def test_the_ports_of_a_group_are_its_parts_in_order(names):
    # A name that is a port has no parts beside itself.
    names = [name for name in names if not any(other != name and is_part(other, name) for other in names)]
    interface = Interface("i", tuple(Port(name, Causality.INPUT, REAL) for name in names))
    for whole in {*names, *(whole for name in names for whole in wholes(name)), "a", "c"}:
        assert [port.name for port in interface.group(whole)] == [name for name in names if is_part(name, whole)]
