"""Declarations: scalars with the attributes the model gives them."""

from __future__ import annotations

import pytest
from modelica_text import compiled, flattened

from dse.errors import Location
from dse.modelica.algebra.evaluate import evaluate
from dse.modelica.algebra.expression import Expression
from dse.modelica.algebra.symbol import Symbol
from dse.modelica.flat_model import FlatModel, Role, ScalarType
from dse.modelica.flatten.flattening import flatten


def _number(flat: FlatModel, expression: Expression | None) -> float | None:
    if expression is None:
        return None
    known: dict[Symbol, float] = {}
    for name, variable in flat.variables.items():
        if variable.role is Role.PARAMETER:
            own = variable.binding or variable.start
            if own is not None and own.is_constant:
                known[Symbol(name)] = own.value
    return evaluate([expression], known)[0]


def test_attributes_of_a_type_and_of_the_declaration_meet() -> None:
    flat = flattened(
        'type Torque = Real(unit = "N.m", min = -9); model M input Torque u(max = 5, start = 2, nominal = '
        '100) "demand"; '
        "Real x(start = 1, fixed = true, stateSelect = StateSelect.prefer); equation der(x) = u; end M;"
    )
    u, x = flat.variables["u"], flat.variables["x"]
    assert (u.role, u.kind, u.unit, u.description) == (Role.INPUT, ScalarType.REAL, "N.m", "demand")
    assert [_number(flat, item) for item in (u.minimum, u.maximum, u.start, u.nominal)] == [-9.0, 5.0, 2.0, 100.0]
    assert (x.role, x.is_fixed, x.prefers_state) == (Role.CONTINUOUS, True, 1)


def test_only_outputs_of_the_model_itself_are_outputs() -> None:
    flat = flattened("model S output Real y = 1; end S; model M S s; output Real z = s.y; end M;")
    assert (flat.variables["s.y"].is_output, flat.variables["z"].is_output) == (False, True)


def test_a_start_that_the_model_does_not_give_is_absent() -> None:
    flat = flattened("model M Real x; Real z(start = 0); equation der(x) = 1; der(z) = 1; end M;")
    assert flat.variables["x"].start is None
    assert _number(flat, flat.variables["z"].start) == 0.0


def test_an_array_has_attributes_by_element_or_for_all() -> None:
    flat = flattened(
        "model M parameter Real p[2] = {1, 2}; parameter Real q[2](min = {0, 1}, each max = 9) = 2 * p; "
        "Real x[2](start = p, each fixed = true); equation der(x) = q; end M;"
    )
    second = flat.variables["q[2]"]
    assert [_number(flat, item) for item in (second.binding, second.minimum, second.maximum)] == [4.0, 1.0, 9.0]
    assert [_number(flat, flat.variables[f"x[{k}]"].start) for k in (1, 2)] == [1.0, 2.0]
    assert flat.variables["x[2]"].is_fixed


def test_dependent_parameters_keep_their_formulas() -> None:
    flat = flattened(
        "model M parameter Real a = 2; final parameter Real b = 3 * a; parameter Real c(fixed = false); "
        "parameter Real d(start = 4); initial equation c = b; end M;"
    )
    a, b, c, d = (flat.variables[name] for name in "abcd")
    assert (a.is_final, b.is_final) == (False, True)
    assert b.binding is not None
    assert Symbol("a") in {node.symbol for node in b.binding.operands}
    assert (c.binding, c.is_fixed, len(flat.initial_equations)) == (None, False, 1)
    assert (d.binding, _number(flat, d.start), d.is_fixed) == (None, 4.0, True)


def test_a_parameter_computed_by_an_initial_algorithm_is_an_initial_equation() -> None:
    flat = flattened(
        "model M parameter Real base = 1; parameter Real p(fixed = false); Real y = p; initial algorithm p := base; "
        "for i in 1:2 loop p := p + i; end for; end M;"
    )
    (equation,) = flat.initial_equations
    known = {Symbol("base"): 1.0, Symbol("p"): 0.0}
    assert -evaluate([equation.residual], known)[0] == 4.0


def test_constants_and_strings_take_their_place_and_are_no_variables() -> None:
    flat = flattened(
        'model M constant Real c[2] = {3, 4}; parameter String s = "dry"; Real y = c[2] + (if s == "dry" '
        "then 1 else 2); "
        "end M;"
    )
    assert set(flat.variables) == {"y"}
    assert evaluate([flat.equations[0].residual], {Symbol("y"): 0.0}) == [-5.0]


def test_enumerations_list_their_items() -> None:
    flat = flattened(
        "type Mode = enumeration(Off, Speed, Gap); model M parameter Mode m = Mode.Speed; Mode n = Mode.Gap; end M;"
    )
    m = flat.variables["m"]
    assert (m.kind, m.items, _number(flat, m.binding)) == (ScalarType.ENUMERATION, ("Off", "Speed", "Gap"), 2.0)
    assert flat.variables["n"].role is Role.DISCRETE


def test_protected_final_and_structural_are_told() -> None:
    text = (
        "model S parameter Real k = 1; protected parameter Real h = 2; end S; model M S s(final k = 3); "
        "parameter Integer n = 2; Real y[n] = fill(1, n); end M;"
    )
    flat = flattened(text)
    assert (flat.variables["s.k"].is_final, flat.variables["s.h"].is_protected) == (True, True)
    assert flat.variables["n"].is_structural
    assert not flat.variables["s.h"].is_structural
    assert flatten(compiled(text, frozenset({"s.h"}))).variables["s.h"].is_structural


def test_a_bound_input_of_the_model_is_an_ordinary_unknown() -> None:
    flat = flattened("model P input Real u; Real y = u; end P; model M extends P(u = 3 * time); end M;")
    assert flat.variables["u"].role is Role.CONTINUOUS
    assert len(flat.equations) == 2


@pytest.mark.parametrize(("name", "column"), [("x", 9), ("u", 34)])
def test_every_variable_knows_its_place(name: str, column: int) -> None:
    flat = flattened("model M Real x = u; input Real u; end M;".replace("input", "/* here */  input"))
    where = flat.variables[name].where
    assert where is not None
    assert (where.file, where.line) == ("m.mo", 2)
    assert isinstance(where, Location)
    assert where.column >= column


def test_an_enumeration_named_by_a_part_of_its_path_has_its_items() -> None:
    flat = flattened(
        "package P type E = enumeration(low, high); end P; model M parameter P.E e = P.E.high; "
        "output Boolean y = e == P.E.high; end M;"
    )
    assert flat.variables["e"].items == ("low", "high")
