"""The discrete part of flat models: relations, triggers, clocks, assignments, reinit, checks."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

import pytest
from modelica_text import flattened, values

from dse.modelica.algebra.evaluate import evaluate
from dse.modelica.algebra.expression import Expression
from dse.modelica.algebra.symbol import Referent, Symbol
from dse.modelica.flat_model import Assignment, Clock, FlatModel, Role, ScalarType, Trigger

STATE = "model M Real x(start = 0, fixed = true); "


def _known(**given: float) -> dict[Symbol, float]:
    known = {Symbol(referent=Referent.TIME): given.pop("time", 0.0), Symbol(referent=Referent.INITIAL): 0.0}
    for name, value in given.items():
        known[Symbol(name)] = value
        known[Symbol(name, referent=Referent.PRE)] = value
    return known


def _value(expression: Expression, known: Mapping[Symbol, float]) -> float:
    return evaluate([expression], known)[0]


def _steps(flat: FlatModel, target: str) -> list[Assignment]:
    return [item for item in flat.assignments if item.target == target]


def test_a_comparison_in_an_equation_is_held_between_events() -> None:
    flat = flattened("model M input Real u; Real y; equation y = if u > 1 then u else 2; end M;")
    (relation,) = flat.relations
    (equation,) = flat.equations
    assert relation.truth.operator == "greater"
    known = {**_known(u=5.0, y=0.0), Symbol("0", referent=Referent.HELD): 0.0}
    assert _value(equation.residual, known) == -2.0


def test_one_comparison_at_two_places_is_one_relation() -> None:
    flat = flattened("model M input Real u; Real y = if u > 1 then 1 else 2; Real z = if u > 1 then 3 else 4; end M;")
    assert len(flat.relations) == 1


def test_a_comparison_with_time_is_an_event_too() -> None:
    flat = flattened("model M Real y = if time > 2 then 1 else 0; end M;")
    assert len(flat.relations) == 1
    assert not values(flat, time=2.0)["y"]
    assert values(flat, time=2.5)["y"]


def test_comparisons_in_for_equations_are_events_of_their_own() -> None:
    flat = flattened(
        "model M input Real u; Real y[3]; equation for i in 1:3 loop y[i] = if u > i then 1 else 0; end for; end M;"
    )
    assert len(flat.relations) == 3
    assert [values(flat, {"u": 2.5})[f"y[{i}]"] for i in (1, 2, 3)] == [1, 1, 0]


@pytest.mark.parametrize("expression", ["noEvent(if u > 0 then 1 else 0)", "smooth(0, if u > 0 then u else 0)"])
def test_no_event_and_smooth_keep_comparisons_out_of_the_relations(expression: str) -> None:
    flat = flattened(f"model M input Real u; Real y = {expression}; end M;")
    assert not flat.relations
    assert values(flat, {"u": 1.0})["y"] == 1.0


def test_comparisons_of_discrete_quantities_are_evaluated_directly() -> None:
    flat = flattened(
        "type Mode = enumeration(Off, On); model M input Mode m; input Integer k; parameter Real p = 3; Real y; "
        "equation y = if m == Mode.On and k > 2 and p < 4 then 1 else 0; end M;"
    )
    assert not flat.relations
    assert values(flat, {"m": 2.0, "k": 3.0})["y"] == 1.0


def test_initial_equations_make_no_relations() -> None:
    flat = flattened(
        STATE + "Real w; initial equation w = if x > 0 then 1 else 2; equation der(x) = 1; der(w) = 0; end M;"
    )
    assert not flat.relations
    assert len(flat.initial_equations) == 1


def test_a_when_condition_over_a_state_is_a_held_relation() -> None:
    flat = flattened(
        STATE + "discrete Real d(start = 5); equation der(x) = 1; when x > 1 then d = pre(d) + x; end when; end M;"
    )
    (step,) = _steps(flat, "d")
    assert step.trigger is not None
    (condition,) = flat.triggers[step.trigger].conditions
    assert condition.symbol == Symbol("0", referent=Referent.HELD)
    assert _value(step.value, _known(d=5.0, x=2.0)) == 7.0
    assert flat.variables["d"].role is Role.DISCRETE


def test_a_vector_of_conditions_is_one_trigger_with_alternatives() -> None:
    flat = flattened(
        STATE + "Boolean s; Integer n(start = 0); equation der(x) = 1; s = x > 3; "
        "when {s, sample(0, 0.3), initial(), x > 1 and s} then n = pre(n) + 1; end when; end M;"
    )
    (step,) = _steps(flat, "n")
    assert step.trigger is not None
    trigger = flat.triggers[step.trigger]
    assert (len(trigger.conditions), trigger.clocks, trigger.at_start) == (2, (0,), True)


def test_sample_times_are_exact_fractions_even_if_they_are_computed() -> None:
    flat = flattened(
        "model M parameter Real T = 0.15; Integer n(start = 0); Integer k(start = 0); equation "
        "when sample(0.05, 0.1) then n = pre(n) + 1; end when; "
        "when sample(0, T / 3) then k = pre(k) + 1; end when; end M;"
    )
    assert flat.clocks == (Clock(Fraction(1, 10), Fraction(1, 20)), Clock(Fraction(1, 20), Fraction(0)))


def test_a_sample_can_be_counted_from_the_start() -> None:
    flat = flattened(
        "model M parameter Real t0(fixed = false); Integer n(start = 0); initial equation t0 = time; equation "
        "when sample(t0 + 0.05, 0.1) then n = pre(n) + 1; end when; end M;"
    )
    assert flat.clocks == (Clock(Fraction(1, 10), Fraction(1, 20), is_from_start=True),)


def test_a_sample_in_a_compound_condition_ticks_through_an_internal_variable() -> None:
    flat = flattened(
        STATE + "discrete Real d; equation der(x) = 1; when sample(0, 0.1) and x > 0 then d = x; end when; end M;"
    )
    (step,) = _steps(flat, "d")
    assert step.trigger is not None
    (condition,) = flat.triggers[step.trigger].conditions
    (name,) = (name for name in flat.variables if name.startswith("$"))
    known = {**_known(**{name: 1.0}), Symbol("0", referent=Referent.HELD): 1.0}
    assert _value(condition, known) == 1.0
    ticking, resting = _steps(flat, name)
    assert (ticking.value.value, resting.value.value, resting.trigger) == (1.0, 0.0, None)
    assert ticking.trigger is not None
    assert flat.triggers[ticking.trigger] == Trigger(clocks=(0,))


def test_elsewhen_branches_stand_in_their_order() -> None:
    flat = flattened(
        "model M input Real u; discrete Real d(start = 0); equation when u > 0.5 then d = 1; elsewhen u < "
        "0.1 then d = 2; "
        "elsewhen u < 0.2 then d = 3; end when; end M;"
    )
    assert [step.value.value for step in _steps(flat, "d")] == [1.0, 2.0, 3.0]
    assert len({step.trigger for step in _steps(flat, "d")}) == 3


def test_a_later_branch_with_another_reinit_is_kept_from_it_by_the_earlier_one() -> None:
    flat = flattened(
        STATE + "Real z(start = 0, fixed = true); equation der(x) = 1; der(z) = 1; "
        "when x > 1 then reinit(x, 0); elsewhen z > 1 then reinit(z, 5); end when; end M;"
    )
    written = [(item.state, _value(item.value, _known(x=2.0, z=3.0)), item.trigger) for item in flat.reinitializations]
    assert written == [("x", 0.0, 0), ("z", 3.0, 0), ("z", 5.0, 1)]


def test_an_if_in_a_when_clause_chooses_the_value() -> None:
    flat = flattened(
        "model M input Real u; Integer n(start = 0); equation when u > 0.5 then if u > 0.8 then n = 1; "
        "elseif u > 0.6 then n = 2; else n = 3; end if; end when; end M;"
    )
    (step,) = _steps(flat, "n")
    assert [_value(step.value, _known(u=u, n=9.0)) for u in (0.9, 0.7, 0.55)] == [1.0, 2.0, 3.0]


def test_an_if_without_else_keeps_the_value_before() -> None:
    flat = flattened(
        "model M input Real u; Integer n(start = 0); equation when u > 0.5 then if u > 0.8 then n = 1; end if; "
        "elsewhen u > 0.7 then n = 4; end when; end M;"
    )
    first, second = _steps(flat, "n")
    assert [_value(first.value, _known(u=u, n=9.0)) for u in (0.9, 0.7)] == [1.0, 9.0]
    assert second.value.value == 4.0


@pytest.mark.parametrize("kind", ["Integer", "discrete Real"])
def test_the_last_assignment_of_an_algorithm_holds(kind: str) -> None:
    flat = flattened(
        STATE + f"{kind} n(start = 0); equation der(x) = 1; algorithm when x > 0.5 then n := 1; "
        "if x > 0.6 then n := 2; end if; if x > 0.7 then n := 3; end if; end when; end M;"
    )
    (step,) = _steps(flat, "n")
    assert [_value(step.value, _known(x=x, n=9.0)) for x in (0.55, 0.65, 0.75)] == [1.0, 2.0, 3.0]


@pytest.mark.parametrize("kind", ["Integer", "discrete Real"])
def test_elsewhen_in_an_algorithm_gives_way_to_the_first_branch(kind: str) -> None:
    flat = flattened(
        STATE + f"{kind} n(start = 0); equation der(x) = 1; algorithm when x > 0.5 then n := 1; "
        "elsewhen x > 0.4 then n := 2; end when; end M;"
    )
    assert [step.value.value for step in _steps(flat, "n")] == [1.0, 2.0]


def test_components_of_an_array_have_clauses_of_their_own() -> None:
    flat = flattened(
        "model C input Real u; discrete Real d(start = 0); Integer n(start = 0); equation when u > 0.5 then "
        "d = 1; n = 1; "
        "elsewhen u < 0.1 then d = 2; n = 2; end when; end C; model M C c[2]; equation c[1].u = time; c[2].u "
        "= 2 * time; "
        "end M;"
    )
    for name in ("c[1].d", "c[2].d", "c[1].n", "c[2].n"):
        assert [step.value.value for step in _steps(flat, name)] == [1.0, 2.0]
    assert len({step.trigger for name in ("c[1].d", "c[2].d") for step in _steps(flat, name)}) == 4


def test_reinit_under_an_if_keeps_the_state_otherwise() -> None:
    flat = flattened(
        STATE + "equation der(x) = 1; when time > 1 then if x > 3 then reinit(x, -pre(x)); end if; end when; end M;"
    )
    (item,) = flat.reinitializations
    assert [_value(item.value, _known(x=x)) for x in (4.0, 2.0)] == [-4.0, 2.0]


def test_edge_and_change_compare_with_the_value_before() -> None:
    flat = flattened(
        "model M input Real u; Boolean b; Boolean e; Boolean c; equation b = u > 0; e = edge(b); c = change(b); end M;"
    )
    known = {**_known(), Symbol("b"): 1.0, Symbol("b", referent=Referent.PRE): 0.0}
    assert [_value(_steps(flat, name)[0].value, known) for name in ("e", "c")] == [1.0, 1.0]
    known[Symbol("b", referent=Referent.PRE)] = 1.0
    assert [_value(_steps(flat, name)[0].value, known) for name in ("e", "c")] == [0.0, 0.0]


@pytest.mark.parametrize(
    ("function", "u", "expected"),
    [
        ("floor(u)", -1.5, -2.0),
        ("ceil(u)", -1.5, -1.0),
        ("integer(u)", 2.7, 2.0),
        ("mod(u, 0.4)", -1.5, 0.1),
        ("rem(u, 0.4)", -1.5, -0.3),
        ("div(u, 0.4)", -1.5, -3.0),
        ("div(u, 0.4)", 1.5, 3.0),
    ],
)
def test_a_rounding_is_held_and_its_next_jumps_are_relations(function: str, u: float, expected: float) -> None:
    flat = flattened(f"model M input Real u; Real y = {function}; end M;")
    assert values(flat, {"u": u})["y"] == pytest.approx(expected, abs=1e-12)
    (kept,) = (variable for name, variable in flat.variables.items() if name.startswith("$"))
    assert (kept.role, kept.is_protected) == (Role.DISCRETE, True)
    held = values(flat, {"u": u})[kept.name]
    at_rest = _known(u=u, **{kept.name: held})
    assert not any(_value(relation.truth, at_rest) for relation in flat.relations if "mod" in function)
    for moved in (u - 1.01, u + 1.01):
        now = [_value(relation.truth, _known(u=moved, **{kept.name: held})) for relation in flat.relations]
        assert now != [_value(relation.truth, at_rest) for relation in flat.relations]


def test_an_integer_quotient_of_integers_needs_no_event() -> None:
    flat = flattened(
        "model M input Integer k; output Integer y; equation y = mod(k, 3) + 10 * div(k, 3) + 100 * rem(k, 3); end M;"
    )
    assert not flat.relations
    assert values(flat, {"k": -7.0})["y"] == 2 - 20 - 100


def test_asserts_become_checks_without_events() -> None:
    flat = flattened(
        STATE
        + 'equation der(x) = 1; assert(x < 3, "x is " + String(x)); assert(x < 2, "near", AssertionLevel.warning); '
        'when x > 1 then assert(time < 5, "late"); terminate("done"); end when; end M;'
    )
    first, warning, late, done = flat.checks
    assert (first.message, first.is_warning, first.trigger) == ("x is <x>", False, None)
    assert [_value(first.condition, _known(x=x)) for x in (2.0, 4.0)] == [1.0, 0.0]
    assert warning.is_warning
    assert (late.trigger, late.terminates) == (0, False)
    assert [_value(late.condition, _known(time=time)) for time in (4.0, 6.0)] == [1.0, 0.0]
    assert (done.terminates, done.condition.value) == (True, 0.0)
    assert len(flat.relations) == 1


def test_initial_values_of_discrete_variables_come_from_initial_equations() -> None:
    flat = flattened(
        STATE + "parameter Integer k = 3; Integer n; Boolean b; initial equation n = k + 1; pre(b) = true; equation "
        "der(x) = 1; b = x < 1; when x > 1 then n = pre(n) + 1; end when; end M;"
    )
    start = flat.variables["n"].start
    assert start is not None
    assert flat.variables["n"].is_fixed
    assert _value(start, _known(k=3.0)) == 4.0
    assert flat.variables["b"].start is flat.graph.constant(1.0)


def test_families_of_discrete_equations_go_element_by_element() -> None:
    flat = flattened(STATE + "Boolean b[3]; equation der(x) = 1; for k in 1:3 loop b[k] = x > k; end for; end M;")
    found = values(flat, {"x": 2.5})
    assert [found[f"b[{k}]"] for k in (1, 2, 3)] == [1.0, 1.0, 0.0]
    assert flat.variables["b[2]"].kind is ScalarType.BOOLEAN


def test_initial_is_true_at_the_start_only() -> None:
    flat = flattened("model M Real y = if initial() then 1 else 2; end M;")
    assert values(flat)["y"] == 2.0
