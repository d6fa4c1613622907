"""Every operator and built-in function over scalars and arrays, against values computed by hand."""

from __future__ import annotations

import math

import pytest
from modelica_text import flattened, values

SCALARS = [
    ("u + 2 * u - 3 / u ^ 2", 2.0, 2 + 4 - 0.75),
    ("-u ^ 2", 3.0, -9.0),
    ("2 ^ u", 3.0, 8.0),
    ("abs(u) + sqrt(4 * u ^ 2)", -3.0, 9.0),
    ("sin(u) + cos(u) + tan(u)", 0.3, math.sin(0.3) + math.cos(0.3) + math.tan(0.3)),
    ("asin(u) + acos(u) + atan(u)", 0.3, math.asin(0.3) + math.acos(0.3) + math.atan(0.3)),
    ("sinh(u) + cosh(u) + tanh(u)", 0.3, math.sinh(0.3) + math.cosh(0.3) + math.tanh(0.3)),
    ("exp(u) + log(u) + log10(u)", 0.3, math.exp(0.3) + math.log(0.3) + math.log10(0.3)),
    ("atan2(u, -1)", 0.3, math.atan2(0.3, -1)),
    ("min(u, 2) + 10 * max(u, 2)", 3.0, 32.0),
    ("if u > 2 then 1 elseif u > 1 then 2 else 3", 1.5, 2.0),
    ("if u > 2 then 1 elseif u > 1 then 2 else 3", 1.0, 3.0),
    ("if not (u > 2 or u < 1) and u <> 4 then 1 else 0", 1.5, 1.0),
    ("noEvent(if u >= 0 then u else -2 * u)", -2.0, 4.0),
    ("smooth(1, if u >= 0 then u ^ 2 else 0)", 3.0, 9.0),
    ("homotopy(u ^ 2, u)", 3.0, 9.0),
    ("semiLinear(u, 2, 5)", 3.0, 6.0),
    ("semiLinear(u, 2, 5)", -3.0, -15.0),
    ("time + u", 1.0, 5.0),
]


@pytest.mark.parametrize(("expression", "u", "expected"), SCALARS)
def test_a_scalar_expression_has_the_value_computed_by_hand(expression: str, u: float, expected: float) -> None:
    if "<>" in expression:
        expression = expression.replace("u <> 4", "time < 5")
    flat = flattened(f"model M input Real u; Real y = {expression}; end M;")
    assert values(flat, {"u": u}, time=4.0)["y"] == pytest.approx(expected, rel=1e-15)


ARRAYS = [
    ("sum(v)", 7.0),
    ("product(v)", 2.0 * 4.0),
    ("max(v) + 10 * min(v)", 14.0),
    ("v * v", 1 + 4 + 16.0),
    ("v * {1, 10, 100}", 421.0),
    ("sum(v .* v - v ./ {1, 2, 4} + v .^ 2)", 21 - 3 + 21.0),
    ("sum(A * v)", (1 + 4 + 12) + (4 + 10 + 24.0)),
    ("sum({1, 10} * A)", 41 + 52 + 63.0),
    ("sum({1, 10} * A * v)", 41 + 2 * 52 + 4 * 63.0),
    ("sum({{1, 10}} * A * transpose({{1, 0, 2}}))", 41 + 2 * 63.0),
    ("transpose(A)[3, 1] + 10 * transpose(A)[1, 2]", 43.0),
    ("A[2, :] * v", 4 + 10 + 24.0),
    ("sum(A[:, 2])", 7.0),
    ("sum(A[2, 2:3]) + A[end, end]", 17.0),
    ("sum(v[{3, 1}] .* {1, 10})", 14.0),
    ("sum(v[3:-2:1] .* {1, 10})", 14.0),
    ("size(A, 1) + 10 * size(A, 2) + sum(size(A))", 37.0),
    ("sum(zeros(3)) + sum(ones(2, 2)) + sum(fill(v[2], 3))", 10.0),
    ("linspace(1, 2, 5)[4]", 1.75),
    ("sum(identity(3) * v .* {1, 10, 100})", 421.0),
    ("diagonal(v)[2, 2] + 10 * diagonal(v)[1, 2]", 2.0),
    ("cross(v, {0.0, 1.0, 0.0}) * {1, 10, 100}", -4 + 100.0),
    (
        "sum(skew(v) * {1.0, 2.0, 3.0} .* {1, 10, 100})",
        (2 * 3 - 4 * 2) + 10 * (4 * 1 - 1 * 3) + 100 * (1 * 2 - 2 * 1.0),
    ),
    ("outerProduct(v, v)[2, 3]", 8.0),
    ("vector([v[1]; v[2]])[2]", 2.0),
    ("cat(1, v, {7.0})[4]", 7.0),
    ("cat(2, A, {{9.0}, {8.0}})[2, 4]", 8.0),
    ("[A; 7, 8, 9] * {0, 1, 0} * {0, 0, 1}", 8.0),
    ("[A, {{7}, {8}}] * {0, 0, 0, 1} * {0, 1}", 8.0),
    ("sum(v[i] * i for i in 1:3)", 1 + 4 + 12.0),
    ("sum({v[i] * j for i in 1:3, j in 1:2})", 7 * 3.0),
    ("sum(if v[1] > 0 then v else -v)", 7.0),
    ("sin(v) * {1, 1, 1}", math.sin(1) + math.sin(2) + math.sin(4)),
    ("sum(-v)", -7.0),
    ("sum(v / 2)", 3.5),
]


@pytest.mark.parametrize(("expression", "expected"), ARRAYS)
def test_an_array_expression_has_the_value_computed_by_hand(expression: str, expected: float) -> None:
    flat = flattened(
        "model M input Real v[3]; parameter Real A[2, 3] = [1, 2, 3; 4, 5, 6]; Real y; "
        f"equation y = {expression}; end M;"
    )
    given = {"v[1]": 1.0, "v[2]": 2.0, "v[3]": 4.0}
    assert values(flat, given)["y"] == pytest.approx(expected, rel=1e-15)


def test_a_matrix_equation_becomes_one_equation_an_element_row_by_row() -> None:
    flat = flattened("model M input Real u; Real B[2, 2]; equation B = [1, u; 3, 4] * [0, 1; 1, 0]; end M;")
    found = values(flat, {"u": 2.0})
    assert [found[f"B[{i},{j}]"] for i in (1, 2) for j in (1, 2)] == [2.0, 1.0, 4.0, 3.0]


def test_for_equations_run_over_their_counters_the_last_fastest() -> None:
    flat = flattened(
        "model M Real a[2, 3]; Real b[2, 3]; equation for i in 1:2 loop for j in 1:3 loop a[i, j] = 10 * i + j; "
        "end for; b[i, :] = i * {1, 2, 3}; end for; end M;"
    )
    found = values(flat)
    for i in (1, 2):
        for j in (1, 2, 3):
            assert found[f"a[{i},{j}]"] == 10 * i + j
            assert found[f"b[{i},{j}]"] == i * j


def test_an_index_known_only_at_run_time_selects_an_element() -> None:
    flat = flattened(
        "model M parameter Real q[2, 3] = [1, 2, 3; 4, 5, 6]; input Integer g; Real y; Real z; Real r[2]; "
        "equation y = q[2, g]; z = q[g, g]; r = q[:, g]; end M;"
    )
    found = values(flat, {"g": 2.0})
    assert (found["y"], found["z"], found["r[1]"], found["r[2]"]) == (5.0, 5.0, 2.0, 5.0)
    assert math.isnan(values(flat, {"g": 4.0})["y"])


def test_records_keep_their_fields_apart() -> None:
    flat = flattened(
        "record R Real a; Real b[2]; end R; model M input Real u; R r[2]; equation r.a = {u, 2}; "
        "for i in 1:2 loop r[i].b = {i, u}; end for; end M;"
    )
    found = values(flat, {"u": 7.0})
    assert [found[name] for name in ("r[1].a", "r[2].a", "r[1].b[1]", "r[2].b[1]", "r[2].b[2]")] == [7, 2, 1, 2, 7]


def test_derivatives_of_a_state_vector_are_symbols_of_order_one() -> None:
    flat = flattened("model M Real x[2](each fixed = true); equation der(x) = [0, 1; -4, -1] * x; end M;")
    found = values(flat, {"x[1]": 1.0, "x[2]": 2.0})
    assert (found["der(x[1])"], found["der(x[2])"]) == (2.0, -6.0)


def test_a_sum_of_a_thousand_terms_needs_no_deep_recursion() -> None:
    terms = " + ".join(["u"] * 1000)
    flat = flattened(f"model M input Real u; Real y; equation y = {terms}; end M;")
    assert values(flat, {"u": 2.0})["y"] == 2000.0
