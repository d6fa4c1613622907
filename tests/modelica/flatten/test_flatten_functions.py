"""Inlined functions against direct transcriptions in Python, for many arguments."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import cache

import pytest
from hypothesis import given, strategies as st
from modelica_text import flattened, values

from dse.modelica.algebra.evaluate import evaluate
from dse.modelica.algebra.symbol import Symbol
from dse.modelica.flat_model import FlatModel


def _branches(u: float, w: float) -> float:
    a, b = u, 0.0
    if u > w:
        a = a + 1
        b = a
        if a > 2:
            b = b * a
    elif u > 0:
        b = -a
        a = w
    else:
        a = 5
    return b * 10 + a


def _loop(u: float, w: float) -> float:
    a, b = 1.0, 0.0
    for i in range(1, 5):
        a = a * u + i
        b = b + a * w
        a = a - b
    return a + b


def _nested_loops(u: float, w: float) -> float:
    y = 0.0
    for i in range(1, 4):
        for j in range(1, 3):
            y = y * w + i * u - j
    return y


def _backwards(u: float, w: float) -> float:
    y = 0.0
    for i in range(5, 0, -2):
        y = y * u + i * w
    return y


def _swap(u: float, w: float) -> float:
    a, b = u, w
    for _ in range(3):
        a, b = b, a - b
    return a + 10 * b


def _while(u: float, w: float) -> float:
    i, y = 1, w
    while i < 6 and y < u:
        y = y + i
        i = i + 1
    return y * 10 + i


def _early_return(u: float, w: float) -> float:
    if u > w:
        return u * 2
    if u < 0:
        return -1.0
    return w


def _elements(u: float, w: float) -> float:
    v = [u, w, 1.0, 2.0]
    for i in range(1, 4):
        v[i] = v[i] * 0.5 + v[i - 1]
    v[1] = v[3] - v[0]
    return v[0] + 10 * v[1] + 100 * v[2] + 1000 * v[3]


def _search(u: float, w: float) -> float:
    xs = [0.0, 1.0, 2.5, 4.0]
    k = 1
    for i in range(1, 5):
        if u > xs[i - 1]:
            k = i
    return xs[k - 1] + w


def _interpolate(u: float, w: float) -> float:
    xs, ys = [0.0, 1.0, 2.5, 4.0], [1.0, 3.0, 2.0, w]
    y = ys[0]
    for i in range(3):
        y = y + (ys[i + 1] - ys[i]) / (xs[i + 1] - xs[i]) * (min(max(u, xs[i]), xs[i + 1]) - xs[i])
    return y


def _recursive(u: float, w: float) -> float:
    def power(x: float, n: int) -> float:
        return 1.0 if n <= 0 else x * power(x, n - 1)

    return power(u, 4) + power(w, 2)


def _several_outputs(u: float, w: float) -> float:
    def polar(x: float, y: float) -> tuple[float, float]:
        return math.sqrt(x * x + y * y), math.atan2(y, x)

    r, angle = polar(u, w)
    s, turned = polar(r, angle)
    return r + 10 * angle + 100 * s + 1000 * turned


def _vector_function(u: float, w: float) -> float:
    r = [u * k + w for k in range(1, 4)]
    total = sum(r)
    scaled = [item / 2 for item in r]
    return total + scaled[0] * scaled[2]


def _rounding(u: float, w: float) -> float:
    quotient = u / 0.7
    return (
        math.floor(u)
        + 10 * math.ceil(u)
        + 100 * (u - math.floor(quotient) * 0.7)
        + 1000 * math.trunc(quotient)
        + (u - math.trunc(quotient) * 0.7)
        + math.copysign(1.0, w) * (w != 0)
    )


HEAD = "function f input Real u; input Real w; output Real y; "
FUNCTIONS: Mapping[str, tuple[str, Callable[[float, float], float]]] = {
    "branches": (
        (
            "protected Real a; Real b; algorithm a := u; b := 0; if u > w then a := a + 1; b := a; "
            "if a > 2 then b := b * a; end if; elseif u > 0 then b := -a; a := w; else a := 5; end if; y := b * 10 + a;"
        ),
        _branches,
    ),
    "loop": (
        (
            "protected Real a; Real b; algorithm a := 1; b := 0; for i in 1:4 loop a := a * u + i; b := b + a * w; "
            "a := a - b; end for; y := a + b;"
        ),
        _loop,
    ),
    "nested loops": (
        "algorithm y := 0; for i in 1:3 loop for j in 1:2 loop y := y * w + i * u - j; end for; end for;",
        _nested_loops,
    ),
    "backwards": ("algorithm y := 0; for i in 5:-2:1 loop y := y * u + i * w; end for;", _backwards),
    "swap": (
        (
            "protected Real a; Real b; Real c; algorithm a := u; b := w; for i in 1:3 loop c := a; a := b; b := c - b; "
            "end for; y := a + 10 * b;"
        ),
        _swap,
    ),
    "while": (
        (
            "protected Integer i; algorithm i := 1; y := w; while i < 6 and y < u loop y := y + i; i := i + 1; "
            "end while; "
            "y := y * 10 + i;"
        ),
        _while,
    ),
    "early return": (
        "algorithm y := w; if u > w then y := u * 2; return; end if; if u < 0 then y := -1; return; end if; y := w;",
        _early_return,
    ),
    "elements": (
        (
            "protected Real v[4]; algorithm v := {u, w, 1, 2}; for i in 2:4 loop v[i] := v[i] * 0.5 + v[i - 1]; "
            "end for; "
            "v[2] := v[4] - v[1]; y := v * {1, 10, 100, 1000};"
        ),
        _elements,
    ),
    "search": (
        (
            "protected Real xs[4] = {0, 1, 2.5, 4}; Integer k; algorithm k := 1; for i in 1:4 loop if u > xs[i] then "
            "k := i; end if; end for; y := xs[k] + w;"
        ),
        _search,
    ),
    "interpolate": (
        (
            "protected Real xs[4] = {0, 1, 2.5, 4}; Real ys[4] = {1, 3, 2, w}; algorithm y := ys[1]; "
            "for i in 1:size(xs, 1) - 1 loop "
            "y := y + (ys[i + 1] - ys[i]) / (xs[i + 1] - xs[i]) * (min(max(u, xs[i]), xs[i + 1]) - xs[i]); end for;"
        ),
        _interpolate,
    ),
    "recursive": ("algorithm y := power(u, 4) + power(w, 2);", _recursive),
    "several outputs": (
        (
            "protected Real r; Real angle; Real s; Real turned; algorithm (r, angle) := polar(u, w); "
            "(s, turned) := polar(r, angle); y := r + 10 * angle + 100 * s + 1000 * turned;"
        ),
        _several_outputs,
    ),
    "vector function": (
        (
            "protected Real r[3]; Real scaled[3]; Real total; algorithm r := ramp(u, w, 3); total := sum(r); "
            "scaled := r / 2; y := total + scaled[1] * scaled[3];"
        ),
        _vector_function,
    ),
    "rounding": (
        "algorithm y := floor(u) + 10 * ceil(u) + 100 * mod(u, 0.7) + 1000 * div(u, 0.7) + rem(u, 0.7) + sign(w);",
        _rounding,
    ),
}
OTHERS = (
    "function power input Real x; input Integer n; output Real y; algorithm "
    "y := if n <= 0 then 1 else x * power(x, n - 1); end power; "
    "function polar input Real x; input Real y; output Real r; output Real a; algorithm "
    "r := sqrt(x * x + y * y); a := atan2(y, x); end polar; "
    "function ramp input Real u; input Real w; input Integer n; output Real v[n]; algorithm "
    "for k in 1:n loop v[k] := u * k + w; end for; end ramp; "
)
NUMBERS = st.floats(-5, 5).map(lambda value: round(value, 3)) | st.sampled_from([0.0, 1.0, 2.0, 2.5, -1.0])


@cache
def _flat(name: str) -> FlatModel:
    body, _ = FUNCTIONS[name]
    return flattened(f"{OTHERS}{HEAD}{body} end f; model M input Real u; input Real w; Real y = f(u, w); end M;")


@pytest.mark.parametrize("name", FUNCTIONS)
@given(u=NUMBERS, w=NUMBERS)
def test_an_inlined_function_gives_what_its_transcription_gives(name: str, u: float, w: float) -> None:
    known = {Symbol(item): value for item, value in (("u", u), ("w", w), ("y", 0.0))}
    (residual,) = (equation.residual for equation in _flat(name).equations)
    assert -evaluate([residual], known)[0] == pytest.approx(FUNCTIONS[name][1](u, w), rel=1e-12, abs=1e-12)


def test_a_function_of_a_matrix_is_specialised_for_its_size() -> None:
    flat = flattened(
        "function f input Real A[:, :]; output Real y; algorithm y := 0; for i in 1:size(A, 1) loop "
        "for j in 1:size(A, 2) loop y := y + A[i, j] * i * 10 ^ j; end for; end for; end f; "
        "model M input Real u; Real y = f([u, 1; 2, 3]); Real z = f([u; 5; 7]); end M;"
    )
    found = values(flat, {"u": 4.0})
    assert (found["y"], found["z"]) == (40 + 100 + 2 * 20 + 2 * 300, 40 + 100 + 210)


def test_an_element_assigned_by_an_index_known_at_run_time_leaves_the_others() -> None:
    flat = flattened(
        "function f input Real x; input Integer k; output Real y[3]; algorithm y := {1, 2, 3}; y[k] := x; end f; "
        "model M input Real u; input Integer k(start = 1); Real y[3] = f(u, k); end M;"
    )
    for k in (1, 2, 3):
        found = values(flat, {"u": 9.0, "k": float(k)})
        assert [found[f"y[{i}]"] for i in (1, 2, 3)] == [9.0 if i == k else float(i) for i in (1, 2, 3)]


def test_an_index_outside_its_array_is_a_check_that_fails() -> None:
    flat = flattened(
        "function f input Real x; input Integer k; output Real y[3]; algorithm y := {1, 2, 3}; y[k] := x; end f; "
        "model M input Real u; input Integer k(start = 1); Real y[3] = f(u, k); end M;"
    )
    (check,) = flat.checks
    assert [evaluate([check.condition], {Symbol("k"): k})[0] for k in (0.0, 1.0, 3.0, 4.0)] == [
        0,
        1,
        1,
        0,
    ]


def test_an_assert_in_a_function_holds_only_where_the_function_is_called() -> None:
    flat = flattened(
        'function f input Real x; output Real y; algorithm assert(x < 5, "too big"); y := x; end f; '
        "model M input Real u; input Boolean on; Real y = if on then f(u) else 0; end M;"
    )
    (check,) = flat.checks
    assert check.message == "too big"
    known = {Symbol("u"): 7.0}
    assert evaluate([check.condition], {**known, Symbol("on"): 1.0}) == [0.0]
    assert evaluate([check.condition], {**known, Symbol("on"): 0.0}) == [1.0]


def test_functions_make_no_events() -> None:
    flat = flattened(
        "function f input Real x; output Real y; algorithm if x > 0 then y := floor(x); else y := sign(x); end if; "
        "end f; model M input Real u; Real y = f(u); end M;"
    )
    assert not flat.relations
    assert not flat.assignments


def test_table_functions_become_primitives() -> None:
    flat = flattened(
        "function t input Real x; input Real xs[:]; input Real ys[size(xs, 1)]; output Real y; "
        'external "C" y = dse_table1(x, xs, size(xs, 1), ys, 0, 2); end t; '
        "function s input Real x; input Real y; input Real xs[:]; input Real ys[:]; "
        "input Real zs[size(xs, 1), size(ys, 1)]; output Real z; "
        'external "C" z = dse_table2(x, y, xs, size(xs, 1), ys, size(ys, 1), zs, 0, 1); end s; '
        "model M parameter Real q[3] = {1, 4, 9}; input Real u; Real y = t(u, {0, 1, 2}, 2 * q); "
        "Real z = s(u, 2 * u, {0, 2}, {0, 4, 8}, [1, 2, 3; 5, 6, 7]); end M;"
    )
    found = values(flat, {"u": 1.5})
    assert found["y"] == pytest.approx(13.0)
    assert found["z"] == pytest.approx(1 + 3.0 + 0.75)
