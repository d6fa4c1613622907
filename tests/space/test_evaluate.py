"""What a constraint means: exact numbers, roll-ups, absent parts, and located refusals."""

from __future__ import annotations

from dataclasses import replace

import pytest

from dse.domain.component import Component, Interface, Kind, Parameter, Type
from dse.domain.design import Alternative, Compound, Constraint, DesignSpace, Optional, Part
from dse.errors import DseError, Location
from dse.expression.parse import parse_expression
from dse.space.check import check_space
from dse.space.language.evaluate import compile_in
from dse.space.language.places import Places
from dse.space.space import open_space
from dse.units import parse_quantity, parse_unit

ANY = Interface("any", ())
HERE = Location("designs/car.yaml", 3, 10)


def part(name, *parameters, **properties):
    stated = {key: parse_quantity(text) for key, text in properties.items()}
    return Part(Component(name, ANY, parameters=parameters, properties=stated))


def parameter(name, start, low=None, high=None, unit="", kind=Kind.REAL):
    return Parameter(name, Type(kind, parse_unit(unit)), start, low, high)


RADAR = part("radar", cost="0.1 EUR", range="150 m", mass="200 g")
CAMERA = part("camera", cost="0.2 EUR", range="90 m")
ENGINE = part("engine", cost="10 EUR", mass="100 kg", factor="2")
MOTOR = part("motor", cost="20 EUR", mass="50 kg", factor="3")
HYBRID = Compound("hybrid", {"engine": Alternative((ENGINE, MOTOR)), "motor": MOTOR}, (), ANY)
CAR = DesignSpace(
    "car",
    Compound(
        "car",
        {
            "sensor": Alternative((RADAR, CAMERA)),
            "rear": Optional(CAMERA),
            "drive": Alternative((ENGINE, HYBRID)),
            "body": part("body", mass="300 kg"),
        },
    ),
)
SMALL = {"sensor": "radar", "drive": "engine"}
FULL = {"sensor": "camera", "rear": "camera", "drive": "hybrid", "drive.engine": "motor"}


def outcome(text, choices):
    return compile_in(parse_expression(text, HERE), Places(CAR)).outcome(choices)


@pytest.mark.parametrize(
    ("text", "small", "full"),
    [
        ("true", True, True),
        ("sensor.range >= 100 m", True, False),
        ("sensor.range >= 0.09 km", True, True),
        ("sensor is radar", True, False),
        ("sensor is not radar", False, True),
        ("sensor in [radar, camera]", True, True),
        ("body is body", True, True),
        ("rear is camera", False, True),
        ("rear is absent", True, False),
        ("rear is present", False, True),
        ("drive is hybrid", False, True),
        ("drive.engine is motor", False, True),
        ("drive.engine in [engine, absent]", True, False),
        ("sum(cost) == 10.1 EUR", True, False),
        ("sum(cost) == 40.4 EUR", False, True),
        ("cost == 40.4 EUR", False, True),
        ("sum(cost, drive) == 10 EUR", True, False),
        ("sum(cost, rear) == 0 EUR", True, False),
        ("sum(mass) between 400.2 kg and 400.2 kg", True, False),
        ("count(cost) == 2", True, False),
        ("count(cost, drive.engine) == 0", True, False),
        ("min(cost) == 0.1 EUR", True, False),
        ("max(mass, drive) == 100 kg", True, False),
        ("max(mass, drive.engine) < 1 kg", None, False),
        ("mean(cost) == 10.1 EUR", False, True),
        ("mean(cost) == 5.05 EUR", True, False),
        ("product(factor) == 9", False, True),
        ("product(factor, drive.engine) == 1", True, False),
        ("rear.range > 100 m", None, False),
        ("not rear.range > 100 m", None, True),
        ("rear.range > 100 m or sensor is radar", True, False),
        ("rear.range > 100 m and sensor is camera", False, False),
        ("sensor is radar implies rear.range > 1 m", None, True),
        ("rear.range > 1 m implies sensor is radar", True, False),
        ("if rear.range > 1 m then true else true", None, True),
        ("if rear is present then rear.range > 100 m else true", True, False),
        ("same_choice(sensor, rear)", False, True),
        ("not same_choice(sensor, rear)", True, False),
        ("same_choice(rear, drive.engine)", True, False),
        ("same_choice(sensor, rear, drive.engine)", False, False),
        ("same_choice(drive, drive.engine)", False, False),
        ("not same_choice(drive, drive.engine)", True, True),
        ("sensor is radar xor rear is camera", True, True),
        ("sensor is radar iff rear is absent", True, True),
        ("min(sensor.range, 100 m) == 100 m", True, False),
        ("max(sensor.range, 100 m, 1 km) == 1 km", True, True),
        ("abs(sensor.range - 120 m) == 30 m", True, True),
        ("floor(sensor.range / 100 m) == 1", True, False),
        ("sqrt(sensor.range / 1.5 m) == 10", True, False),
        ("sqrt(sensor.range * 1 m) < 12.2474 m", False, True),
        ("sensor.range ^ 2 == 22500 m^2", True, False),
        ("(sensor.range / 1 m) ^ 0.5 > 12.2", True, False),
        ("sensor.range ^ -1 <= 1 / 150 * 1 m^-1", True, False),
        ("-sensor.range < 0 m", True, True),
        ("0.1 + 0.2 == 0.3", True, True),
        ("if sensor is radar then 1 m < 2 m else 2 m < 1 m", True, False),
        ("at_least(2, sensor is radar, rear is camera, drive is hybrid)", False, True),
        ("at_most(1, sensor is radar, rear is camera, drive is hybrid)", True, False),
        ("exactly(1, sensor is radar, rear is camera, drive is hybrid)", True, False),
        ("exactly(0, sensor is radar)", False, True),
        ("at_least(1, rear.range > 1 m, sensor is radar)", True, True),
        ("at_least(2, rear.range > 1 m, sensor is radar)", None, False),
        ("at_most(0, rear.range > 1 m, sensor is camera)", None, False),
        ("at_most(2, rear.range > 1 m, sensor is camera)", True, True),
        ("exactly(1, rear.range > 1 m, sensor is camera, body is absent)", None, False),
        ("exactly(2, rear.range > 1 m, sensor is radar, body is body)", None, True),
        ("exactly(0, rear.range > 1 m, sensor is radar)", False, False),
        ("(rear is present) == (drive is hybrid)", True, True),
        ("(rear.range > 1 m) != (drive is hybrid)", None, False),
    ],
)
def test_a_condition_is_evaluated_exactly_on_what_is_chosen(text, small, full):
    assert outcome(text, SMALL) is small
    assert outcome(text, FULL) is full


def test_an_undefined_constraint_holds_but_an_undefined_selection_does_not_select():
    rule = parse_expression("rear.range > 100 m")
    space = DesignSpace("car", CAR.root, (Constraint("far", rule),))
    held = list(open_space(space).configurations())
    assert held
    assert all("rear" not in configuration.choices for configuration in held)
    assert list(open_space(space, where=rule).configurations()) == []


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("1 / (sensor.range - 150 m) > 0 m^-1", "division by zero, for sensor=radar, drive=engine"),
        ("0 ^ -1 > 0", "division by zero"),
        ("sqrt(sensor.range - 200 m) > 0 m^0.5", "square root of a negative number"),
        ("(-2) ^ 0.5 > 0", "power of a negative number"),
        ("((2 ^ 100) ^ 100) ^ 100 > 0", "too many digits"),
        ("(10 ^ 900) ^ 0.5 > 0", "too large"),
    ],
)
def test_a_value_that_does_not_exist_is_refused_with_the_choices_that_led_to_it(text, what):
    with pytest.raises(DseError, match=what):
        outcome(text, SMALL)


def test_a_guard_keeps_a_division_by_zero_away():
    assert outcome("if sensor.range > 150 m then 1 m / (sensor.range - 150 m) > 0 else true", SMALL) is True
    assert outcome("sensor.range > 150 m and 1 m / (sensor.range - 150 m) > 0", SMALL) is False


def test_a_range_of_a_parameter_is_a_value_as_it_was_written():
    slow = part("slow", parameter("speed", 25 / 3.6, 5 / 3.6, 70 / 3.6, "km/h"), parameter("pid.gain", 0.1))
    fast = part("fast", parameter("speed", 30 / 3.6, 0.0, 120 / 3.6, "km/h"), parameter("pid.gain", 0.3))
    space = DesignSpace("car", Compound("car", {"a": Alternative((slow, fast)), "b": Optional(fast)}))

    def holds(text, **choices):
        return compile_in(parse_expression(text), Places(space)).outcome(choices)

    assert holds("a.speed.max == 70 km/h", a="slow") is True
    assert holds("a.speed.max == 70 km/h", a="fast") is False
    assert holds("a.speed.max - a.speed.min == 65 km/h and a.speed.start == 25 km/h", a="slow") is True
    assert holds("a.pid.gain.start == 0.1", a="slow") is True
    assert holds("b.speed.max > a.speed.max", a="slow") is None
    assert holds("b.speed.max > a.speed.max", a="slow", b="fast") is True


@pytest.mark.parametrize(
    ("text", "offset", "what", "hint"),
    [
        ("a.sped.max > 1 m/s", 2, "nothing at 'a' has a parameter 'sped'", "did you mean 'speed'"),
        ("a.speed.max > 1 m", 14, "cannot compare length/time and length", "same unit"),
        ("a.open.max > 1 m/s", 0, "'fast', which can be at 'a', has no number 'open.max'", "in parts/fast.yaml"),
        ("a.only.max > 1", 0, "'fast', which can be at 'a', has no parameter 'only'", "add it to the parameters"),
        ("a.mode.start > 1", 0, "'slow', which can be at 'a', has no number 'mode.start'", "parameters"),
        ("a.speed > 1 m/s", 2, "nothing at 'a' states 'speed'", "cost"),
        ("b.speed.max > 1 m/s", 0, "'b' can be several parts, so it has no 'speed' of its own", "one of its parts"),
    ],
)
def test_a_range_that_is_not_there_is_refused_by_the_name_of_the_component(text, offset, what, hint):
    speed = parameter("speed", 1.0, 0.0, 2.0, "m/s")
    mode = Parameter("mode", Type(Kind.ENUMERATION, items=("on", "off")), "on")
    ranged = (parameter("open", 1.0, 0.0, 2.0, "m/s"), parameter("only", 1.0, high=2.0))
    slow = part("slow", speed, *ranged, mode, cost="1 EUR")
    fast = part("fast", speed, parameter("open", 1.0, unit="m/s"), mode, cost="1 EUR")
    fast = Part(replace(fast.component, where=Location("parts/fast.yaml", 1, 1)))
    parts = {"a": Alternative((slow, fast)), "b": Compound("b", {"c": slow}, (), ANY)}
    (problem,) = check_space(
        DesignSpace("car", Compound("car", parts), (Constraint("c", parse_expression(text, HERE)),))
    )
    assert what in problem.what
    assert hint in problem.hint
    assert problem.where == Location(HERE.file, HERE.line, HERE.column + offset)


REFUSED = [
    ("sum(cost) <= 5 kg", 13, "cannot compare currency and mass", "same unit"),
    ("sum(cost) <= 5", 13, "cannot compare currency and a plain number", "a bare number has none"),
    ("true and sensor.rang > 5 m", 16, "nothing at 'sensor' states 'rang'", "did you mean 'range'"),
    ("senor.range > 5 m", 0, "unknown place 'senor'", "did you mean 'sensor'"),
    ("senor is radar", 0, "unknown place 'senor'", "did you mean 'sensor'"),
    ("sensor is rader", 10, "'rader' cannot be chosen for 'sensor'", "did you mean 'radar'"),
    ("sum(cots) < 1 EUR", 4, "no component states 'cots'", "did you mean 'cost'"),
    ("sum(cost, reer) < 1 EUR", 10, "unknown place 'reer'", "did you mean 'rear'"),
    ("sum(cost, body) < 1 EUR", 0, "nothing at 'body' states 'cost'", "leave out the place"),
    ("sum() < 1", 0, "'sum' needs a property", "sum(property)"),
    ("sum(1) < 1", 4, "a roll-up takes names", "sum(property)"),
    ("sum(sensor.cost) < 1 EUR", 4, "a roll-up takes a bare property", "sum(property)"),
    ("sum(cost, of = 1) < 1 EUR", 15, "'sum' has no option 'of'", "no named arguments"),
    ("drive.cost < 1 EUR", 0, "'drive' can be several parts", "sum(cost, drive)"),
    ("sensor.mass < 1 kg", 0, "'camera', which can be at 'sensor', does not state 'mass'", "add it"),
    ("sensor > 1", 0, "'sensor' is a place, not a value", "sensor is"),
    ("foo > 1", 0, "unknown name 'foo'", "possible"),
    ("sensor.range", 0, "expected a condition, found a number (length)", "compare it"),
    ("sensor.range and true", 0, "expected a condition", "compare it"),
    ("1 + true > 1", 4, "expected a number, found a condition", "arithmetic"),
    ("sensor.range + 1 s > 1 m", 15, "cannot add length and time", "same unit"),
    ("sensor.range ^ sensor.range > 1", 15, "an exponent has no unit", "bare number"),
    ("sensor.range ^ count(cost) > 1", 15, "must be written out", "open"),
    ("product(cost) > 1", 0, "cannot multiply up 'cost'", "number of parts"),
    ("summ(cost) > 1 EUR", 0, "unknown function 'summ'", "did you mean 'sum'"),
    ("abs(1, 2) > 1", 0, "'abs' needs one value", "abs(x)"),
    ("min(2) > 1", 0, "'min' needs two values", "min("),
    ("max(1 m, 2 s) > 1 m", 9, "cannot compare length and time", "same unit"),
    ("floor(1 m) > 1 m", 0, "plain number", "same unit"),
    ("same_choice(sensor) ", 0, "needs two places", "same_choice(front"),
    ("same_choice(sensor, 1)", 20, "compares places", "same_choice(front"),
    ("at_least(sensor is radar)", 9, "'at_least' needs to know how many", "at_least(2, a is x"),
    ("at_least()", 0, "'at_least' needs to know how many", "at_least(2, a is x"),
    ("at_least(1.5, sensor is radar)", 9, "needs to know how many", "write a number"),
    ("at_most(2 m, sensor is radar)", 8, "needs to know how many", "write a number"),
    ("exactly(2)", 0, "'exactly' needs conditions", "exactly(2, a is x"),
    ("exactly(2, sensor is radar, sensor.range)", 28, "expected a condition", "compare it"),
    ("at_least(3, sensor is radar, true)", 9, "3 of 2 conditions can never hold", "lower the number"),
    ("at_lest(1, sensor is radar)", 11, "expected a number", "arithmetic"),
    ("if 1 then true else true", 3, "expected a condition", "compare it"),
    ("if true then 1 else 2 m > 3 m", 0, "cannot choose between", "same unit"),
    ("true < false", 0, "expected a number", "arithmetic"),
    ("true == 1", 8, "cannot compare a condition and a plain number", "same unit"),
]


@pytest.mark.parametrize(("text", "offset", "what", "hint"), REFUSED, ids=[text for text, *_ in REFUSED])
def test_a_constraint_that_makes_no_sense_is_refused_at_its_column(text, offset, what, hint):
    space = DesignSpace("car", CAR.root, (Constraint("c", parse_expression(text, HERE)),))
    (problem,) = check_space(space)
    assert what in problem.what
    assert hint in problem.hint
    assert problem.where == Location(HERE.file, HERE.line, HERE.column + offset)


def test_a_property_of_two_kinds_names_both_components():
    other = part("other", cost="3 kg")
    space = DesignSpace("car", Compound("car", {"sensor": Alternative((RADAR, other))}))
    with pytest.raises(DseError, match="'cost' is currency in 'radar' and mass in 'other'"):
        compile_in(parse_expression("sum(cost) < 1 EUR"), Places(space))


def test_a_good_space_has_no_problems():
    assert check_space(CAR) == []
