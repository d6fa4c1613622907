"""From a bench's metrics and requirements to numbers and verdicts."""

from __future__ import annotations

import math
import pickle

import numpy as np
import pytest

from dse.domain.bench import Judgement, Metric, Requirement, Verdict
from dse.domain.component import Kind, Type
from dse.errors import DseError, Location
from dse.expression.parse import parse_expression
from dse.metrics.program import compile_metrics, judge_failed
from dse.units import DIMENSIONLESS, parse_unit

HERE = Location("bench.yaml", 9, 20)


def real(unit=""):
    return Type(Kind.REAL, parse_unit(unit))


TYPES = {
    "world.speed": real("km/h"),
    "world.lead_speed": real("m/s"),
    "world.gap": real("m"),
    "world.closing": real("m/s"),
    "world.detected": Type(Kind.BOOLEAN),
    "controller.mode": Type(Kind.ENUMERATION, items=("speed", "distance")),
    "controller.set_speed": real("km/h"),
    "controller.set_gap": real("m"),
    "controller.active": Type(Kind.BOOLEAN),
    "controller.gain": real(),
}
SIGNALS = frozenset(
    {"world.speed", "world.lead_speed", "world.gap", "world.closing", "world.detected", "controller.mode"}
)
TIME = np.array([0.0, 1.0, 2.0, 3.0])
COLUMNS = {
    "world.speed": np.array([0.0, 10.0, 22.0, 20.0]),
    "world.lead_speed": np.array([15.0, 15.0, 15.0, 15.0]),
    "world.gap": np.array([150.0, 100.0, 38.0, 40.0]),
    "world.closing": np.array([-1.0, 10.0, 19.0, 0.0]),
    "world.detected": np.array([0.0, 0.0, 1.0, 1.0]),
    "controller.mode": np.array([0.0, 1.0, 1.0, 1.0]),
}
CONSTANTS = {"controller.set_speed": 20.0, "controller.set_gap": 40.0, "controller.active": 1.0, "controller.gain": 2.0}


def metric(text, name="m", unit=DIMENSIONLESS, over=None):
    return Metric(name, parse_expression(text, HERE), unit, over=over)


def compiled(*metrics, requirements=()):
    return compile_metrics(metrics, requirements, TYPES, SIGNALS)


def value(text):
    return compiled(metric(text)).evaluate(TIME, COLUMNS, CONSTANTS)[0]["m"]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("overshoot(world.speed, target = controller.set_speed)", 0.1),
        ("overshoot(world.speed, 72 km/h)", 0.1),
        ("undershoot(world.gap, target = controller.set_gap)", 0.05),
        ("rise_time(world.speed, target = controller.set_speed)", 2 * 1 - 0.2 - 2 / 12 * 2),
        ("reach_time(world.speed, target = controller.set_speed, band = 10 %)", 1 + 8 / 12),
        ("settling_time(world.gap, target = controller.set_gap, band = 1 %)", 2 + 1.6 / 2),
        ("steady_state_error(world.speed, target = controller.set_speed)", 1.0),
        ("steady_state_error(world.speed, target = controller.set_speed, window = 0 s)", 0.0),
        ("minimum(time_to_collision(world.gap, world.closing))", 2.0),
        ("minimum(world.gap)", 38.0),
        ("maximum(world.speed - world.lead_speed)", 7.0),
        ("final(world.speed) / 1 m * 1 s", 20.0),
        ("initial(world.gap)", 150.0),
        ("mean(world.lead_speed)", 15.0),
        ("rms(world.lead_speed)", 15.0),
        ("integral(world.lead_speed)", 45.0),
        ("at_first(world.gap, world.gap < 99 m)", 38.0),
        ("duration(world.gap < 99 m)", 1.5),
        ("duration(world.gap between 38 m and 40 m and world.detected)", 1.5),
        ("duration(not world.detected)", 1.5),
        ("duration(controller.mode == distance)", 2.5),
        ("duration(speed == controller.mode)", 0.5),
        ("duration(controller.mode != distance)", 0.5),
        ("duration(world.detected implies world.gap < 39 m)", 2.5),
        ("duration(world.detected iff controller.mode == distance)", 2.0),
        ("duration(world.detected xor controller.active)", 1.5),
        ("duration(world.detected or world.gap > 149 m)", 2.0),
        ("maximum(if world.detected then world.gap else 1 m)", 40.0),
        ("at_first(if controller.active then 5 m else world.gap, world.detected)", 5.0),
        ("if controller.active then 1 else 2", 1.0),
        ("if true then maximum(world.gap) else 2 m", 150.0),
        ("maximum(abs(world.closing))", 19.0),
        ("maximum(min(world.gap, 50 m, 45 m))", 45.0),
        ("max(controller.set_gap, 1 km)", 1000.0),
        ("sqrt(controller.set_gap / 10 m)", 2.0),
        ("floor(controller.gain + 0.7)", 2.0),
        ("-controller.gain ^ 2 + 1", -3.0),
        ("controller.set_gap * 2 - 1 m", 79.0),
        ("minimum(sqrt(world.gap * 1 m))", math.sqrt(38)),
        ("1 / (controller.gain - 2)", math.inf),
        ("-1 / (controller.gain - 2)", -math.inf),
        ("minimum(world.gap) / (initial(world.gap) - initial(world.gap))", math.inf),
        ("final(time)", 3.0),
        ("at_first(time, world.detected)", 2.0),
        ("maximum(if time > 2 s then world.speed else 0 m/s)", 20.0),
        ("percentile(world.gap, 50 %)", 40.0),
        ("maximum(rolling_mean(world.speed, window = 2 s))", (16 + 21) / 2),
    ],
)
def test_a_metric_is_the_si_number_its_expression_says(text, expected):
    assert value(text) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(
    ("text", "over", "expected"),
    [
        ("maximum(world.gap)", (1, 3), 100.0),
        ("maximum(world.gap)", (1.5, 3), 40.0),
        ("initial(world.speed)", (2, 3), 22.0),
        ("initial(time)", (2, 3), 2.0),
        ("mean(world.speed)", (1, 2), 16.0),
        ("integral(world.speed)", (0, 2), 21.0),
        ("duration(world.detected)", (2, 3), 1.0),
        ("reach_time(world.speed, target = 22 m/s, band = 0)", (1, 3), 1.0),
        ("overshoot(world.speed, target = controller.set_speed)", (0, 1), -0.5),
        ("final(world.gap)", (0, 3 - 1e-12), 40.0),
        ("maximum(rolling_mean(world.speed, window = 1 s))", (0, 2), 16.0),
        ("maximum(world.gap) - whole", (2, 3), 40.0 - 150.0),
    ],
)
def test_a_window_hides_the_rows_outside_it(text, over, expected):
    whole = metric("maximum(world.gap)", "whole")
    program = compiled(whole, metric(text, over=over), metric("maximum(world.gap)", "after"))
    values, _ = program.evaluate(TIME, COLUMNS, CONSTANTS)
    assert values["m"] == pytest.approx(expected, rel=1e-12)
    assert values["after"] == values["whole"] == 150.0


@pytest.mark.parametrize(
    ("at_most", "exercised", "verdict"),
    [(99.0, None, Verdict.NOT_EXERCISED), (99.0, "m > 3 m", Verdict.NOT_EXERCISED), (99.0, "1 > 0", Verdict.FAIL)],
)
def test_a_window_without_rows_gives_nothing_that_a_verdict_could_rest_on(at_most, exercised, verdict):
    requirement = Requirement(
        "R", "m", at_most, unit=parse_unit("m"), exercised_when=exercised and parse_expression(exercised)
    )
    program = compiled(metric("minimum(world.gap)", over=(3.1, 9)), requirements=[requirement])
    values, (judgement,) = program.evaluate(TIME, COLUMNS, CONSTANTS)
    assert math.isnan(values["m"])
    assert judgement.verdict is verdict


def test_a_metric_is_stored_with_its_window_so_that_another_window_is_another_study():
    assert metric("maximum(world.gap)", over=(0.1, 30.0)).text == "maximum(world.gap) over [0.1 s, 30 s]"


def test_a_window_on_a_metric_without_waveforms_is_refused():
    with pytest.raises(DseError, match="'over' has no effect: 'm' uses no waveform") as caught:
        compiled(metric("maximum(world.gap)", "a"), metric("a / 2", over=(1.0, 2.0)))
    assert caught.value.problems[0].where == HERE


@pytest.mark.parametrize(
    "text",
    ["sqrt(-controller.gain)", "(-controller.gain) ^ 0.5", "0 / 0", "max(0 / 0, 1)", "maximum(world.gap + 0 m / 0)"],
)
def test_arithmetic_without_a_value_is_nan(text):
    assert math.isnan(value(text))


def test_a_metric_may_use_those_before_it():
    program = compiled(metric("minimum(world.gap)", "low"), metric("low / 2 + controller.set_gap", "m"))
    assert program.evaluate(TIME, COLUMNS, CONSTANTS)[0] == {"low": 38.0, "m": 59.0}


def test_a_program_names_the_waveforms_and_constants_it_needs_and_its_units():
    program = compiled(
        metric("overshoot(world.speed, target = controller.set_speed)", "a", parse_unit("%")),
        metric("integral(world.gap)", "b"),
        metric("maximum(world.speed)", "c", parse_unit("km/h")),
        metric("rise_time(world.speed, 20 m/s)", "d"),
    )
    assert program.signals == ("world.speed", "world.gap")
    assert program.constants == ("controller.set_speed",)
    assert {name: str(unit) for name, unit in program.units.items()} == {"a": "%", "b": "m*s", "c": "km/h", "d": "s"}
    assert program.units["d"].dimension == parse_unit("s").dimension


def test_what_several_metrics_share_is_computed_once():
    once = compiled(metric("maximum(world.gap)", "a"))
    shared = compiled(metric("maximum(world.gap)", "a"), metric("overshoot(world.gap, 40 m)", "b"))
    assert len(shared.instructions) == len(once.instructions) + 1


def test_a_program_survives_being_sent_to_a_worker():
    requirement = Requirement("R", "m", at_least=1.0, unit=parse_unit("m"), exercised_when=parse_expression("m > 2 m"))
    program = compiled(metric("minimum(world.gap + 1 m)"), requirements=[requirement])
    sent = pickle.loads(pickle.dumps(program))  # noqa: S301  # our own bytes
    assert sent.evaluate(TIME, COLUMNS, CONSTANTS) == program.evaluate(TIME, COLUMNS, CONSTANTS)


REFUSED = [
    ("minimum(world.gapp)", 8, "unknown name 'world.gapp'", "did you mean 'world.gap'"),
    ("minimun(world.gap)", 0, "unknown function 'minimun'", "did you mean 'minimum'"),
    ("world.gap", 0, "this is a waveform", "minimum"),
    ("controller.active", 0, "expected a number", "arithmetic"),
    ("overshoot(world.speed, target = controller.set_gap)", 32, "must be length/time, found length", "give it in m/s"),
    ("overshoot(world.speed, target = world.lead_speed)", 32, "'world.lead_speed' varies", "final value"),
    ("overshoot(controller.set_speed, 1 m/s)", 10, "'controller.set_speed' does not vary", "varies in time"),
    ("overshoot(world.speed)", 0, "'overshoot' needs 'target'", "overshoot(x, target)"),
    ("overshoot(world.speed, goal = 1 m/s)", 30, "has no argument 'goal'", "overshoot(x, target)"),
    ("overshoot(world.speed, 1 m/s, target = 2 m/s)", 39, "'target' is given twice", "the form is"),
    ("settling_time(world.closing, target = 0 m/s)", 38, "must not be zero", "steady_state_error"),
    ("minimum(world.gap, 1 m)", 19, "too many arguments", "minimum(x)"),
    ("settling_time(world.gap, 40 m, band = 1 m)", 38, "must be a plain number, found length", "bare number"),
    ("steady_state_error(world.gap, 40 m, window = 1 m)", 45, "must be time, found length", "give it in s"),
    ("time_to_collision(world.gap, world.gap)", 29, "must be length/time", "give it in m/s"),
    ("minimum(time_to_collision(world.closing, world.gap))", 26, "must be length, found length/time", "give it in m"),
    ("duration(world.gap)", 9, "expected a condition", "compare it"),
    ("duration(controller.active)", 9, "'controller.active' does not vary", "varies in time"),
    ("minimum(world.gap) + 1 s", 21, "cannot add length and time", "same unit"),
    ("minimum(world.gap) < 3 m", 0, "expected a number, found a condition", "arithmetic"),
    ("minimum(controller.mode)", 8, "expected a number, found one of speed, distance", "arithmetic"),
    ("duration(controller.mode == brake)", 28, "unknown name 'brake'", "possible"),
    ("sensor is radar", 0, "is a choice", "item"),
    ("min(1)", 0, "needs two values", "minimum"),
    ("abs(1, 2)", 0, "needs one value", "minimum"),
    ("floor(2 m)", 0, "floor takes a plain number", "divide"),
    ("max(1 m, 1 s)", 9, "cannot compare", "same unit"),
    ("later", 0, "metric 'later' is defined further down", "move it up"),
    ("percentile(world.gap, 95)", 22, "'q' of percentile must be between 0 % and 100 %, found 9500 %", "as 95 %"),
    ("rolling_mean(world.gap, 2 s)", 0, "this is a waveform", "minimum"),
    ("time", 0, "this is a waveform", "minimum"),
    ("maximum(time) + 1 m", 16, "cannot add", "same unit"),
]


@pytest.mark.parametrize(("text", "offset", "what", "hint"), REFUSED, ids=[text for text, *_ in REFUSED])
def test_a_metric_that_makes_no_sense_is_refused_at_its_column(text, offset, what, hint):
    with pytest.raises(DseError) as caught:
        compiled(metric(text), metric("1", "later"))
    (problem,) = caught.value.problems
    assert what in problem.what
    assert hint in problem.hint
    assert problem.where == Location(HERE.file, HERE.line, HERE.column + offset)


def test_every_problem_is_reported_and_none_twice():
    bad = [metric("minimum(world.gapp)", "a"), metric("a + 1 m", "b"), metric("minimum(1 m)", "c")]
    needs = [Requirement("R", "b", at_most=1.0), Requirement("Q", "d", at_most=1.0, where=HERE)]
    with pytest.raises(DseError) as caught:
        compiled(*bad, requirements=needs)
    assert len(caught.value.problems) == 3


@pytest.mark.parametrize(
    ("requirement", "what"),
    [
        (Requirement("R", "n", at_most=1.0, where=HERE), "unknown metric 'n'"),
        (Requirement("R", "m", where=HERE), "has no bound"),
        (Requirement("R", "m", at_most=1.0, where=HERE), "'m' is length, its bound is a plain number"),
        (
            Requirement("R", "m", at_most=1.0, unit=parse_unit("m"), exercised_when=parse_expression("m < 60 s", HERE)),
            "cannot compare length and time",
        ),
        (
            Requirement("R", "m", at_most=1.0, unit=parse_unit("m"), exercised_when=parse_expression("m", HERE)),
            "expected a condition",
        ),
        (
            Requirement(
                "R", "m", at_most=1.0, unit=parse_unit("m"), exercised_when=parse_expression("world.detected", HERE)
            ),
            "this varies",
        ),
    ],
)
def test_a_requirement_that_makes_no_sense_is_refused_where_it_stands(requirement, what):
    with pytest.raises(DseError) as caught:
        compiled(metric("minimum(world.gap)"), requirements=[requirement])
    (problem,) = caught.value.problems
    assert what in problem.what
    assert (problem.where.file, problem.where.line) == (HERE.file, HERE.line)


def test_a_metric_cannot_be_shown_in_a_unit_of_another_kind():
    with pytest.raises(DseError, match="'m' is length and cannot be shown in km/h"):
        compiled(metric("minimum(world.gap)", unit=parse_unit("km/h")))


PASS, FAIL, NOT_EXERCISED = Verdict.PASS, Verdict.FAIL, Verdict.NOT_EXERCISED


@pytest.mark.parametrize(
    ("value_text", "at_most", "at_least", "exercised", "verdict", "margin"),
    [
        ("3", 5.0, None, None, PASS, 2.0),
        ("5", 5.0, None, None, PASS, 0.0),
        ("6", 5.0, None, None, FAIL, -1.0),
        ("6", None, 5.0, None, PASS, 1.0),
        ("4", None, 5.0, None, FAIL, -1.0),
        ("4", 5.0, 1.0, None, PASS, 1.0),
        ("0", 5.0, 1.0, None, FAIL, -1.0),
        ("3", 5.0, None, "m > 2", PASS, 2.0),
        ("3", 5.0, None, "m > 3", NOT_EXERCISED, 2.0),
        ("6", 5.0, None, "m < 3", NOT_EXERCISED, -1.0),
        ("0 / 0", 5.0, None, None, NOT_EXERCISED, math.nan),
        ("3", 5.0, None, "undefined < 3", NOT_EXERCISED, 2.0),
        ("3", 5.0, None, "undefined > 3", NOT_EXERCISED, 2.0),
        ("3", 5.0, None, "undefined == undefined", NOT_EXERCISED, 2.0),
        ("3", 5.0, None, "undefined != 3", NOT_EXERCISED, 2.0),
        ("3", 5.0, None, "undefined between 0 and 9", NOT_EXERCISED, 2.0),
        ("1 / 0", 5.0, None, None, FAIL, -math.inf),
        ("1 / 0", None, 5.0, None, PASS, math.inf),
        ("-1 / 0", 5.0, 1.0, None, FAIL, -math.inf),
        ("3", 5.0, None, "maximum(world.gap) > 100 m", PASS, 2.0),
    ],
)
def test_the_verdict_follows_from_bounds_and_exercise(value_text, at_most, at_least, exercised, verdict, margin):
    condition = parse_expression(exercised) if exercised else None
    program = compiled(
        metric("0 / 0", "undefined"),
        metric(value_text),
        requirements=[Requirement("R", "m", at_most, at_least, exercised_when=condition)],
    )
    (judgement,) = program.evaluate(TIME, COLUMNS, CONSTANTS)[1]
    assert (judgement.requirement, judgement.verdict) == ("R", verdict)
    assert judgement.margin == pytest.approx(margin, nan_ok=True)


def test_a_margin_is_not_rounded():
    program = compiled(metric("0.1 + 0.2"), requirements=[Requirement("R", "m", at_most=0.3)])
    (judgement,) = program.evaluate(TIME, COLUMNS, CONSTANTS)[1]
    assert judgement == Judgement("R", Verdict.FAIL, 0.3 - (0.1 + 0.2))


def test_a_run_that_failed_has_a_verdict_for_every_requirement():
    first, second = judge_failed([Requirement("R1", "m", 1.0), Requirement("R2", "m", 1.0)])
    assert (first.requirement, second.requirement) == ("R1", "R2")
    assert first.verdict is Verdict.FAILED_TO_RUN
    assert math.isnan(first.margin)


def test_the_columns_are_left_as_they_were():
    before = {name: column.copy() for name, column in COLUMNS.items()}
    value("minimum(time_to_collision(world.gap, world.closing)) + 0 s * maximum(world.speed) / 1 m/s")
    assert all(np.array_equal(before[name], COLUMNS[name]) for name in COLUMNS)


@pytest.mark.parametrize("bound", [{"at_most": 30.0}, {"at_least": 30.0}])
@pytest.mark.parametrize(
    ("exercised", "verdict"),
    [
        (None, Verdict.NOT_EXERCISED),
        ("closest < 50 m", Verdict.FAIL),
        ("closest > 50 m", Verdict.NOT_EXERCISED),
        ("undefined < 60", Verdict.NOT_EXERCISED),
        ("not undefined > 60", Verdict.NOT_EXERCISED),
    ],
)
def test_an_undefined_metric_never_passes_and_fails_only_where_it_was_exercised(bound, exercised, verdict):
    condition = None if exercised is None else parse_expression(exercised, HERE)
    requirement = Requirement("R", "undefined", **bound, exercised_when=condition)
    program = compiled(
        metric("minimum(world.gap)", "closest"), metric("sqrt(0 - 1)", "undefined"), requirements=[requirement]
    )
    values, (judgement,) = program.evaluate(TIME, COLUMNS, CONSTANTS)
    assert math.isnan(values["undefined"])
    assert judgement.verdict is verdict
    assert math.isnan(judgement.margin)
