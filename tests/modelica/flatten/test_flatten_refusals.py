"""What is not translated with certainty is refused, by name and with its place in the model's file."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest
from modelica_text import compiled, flattened

from dse.errors import DseError
from dse.modelica.flatten.flattening import flatten

STATE = "model M Real x(start = 0, fixed = true); "
TABLE = (
    "function t input Real x; input Real xs[:]; input Real ys[:]; input Integer e; output Real y; "
    'external "C" y = dse_table1(x, xs, size(xs, 1), ys, 0, e); end t; '
)

REFUSED = [
    (
        (
            "function f input Real x; output Integer n; algorithm n := integer(x); end f; model M Integer k; equation "
            "k = f(time); end M;"
        ),
        "'k', a discrete variable whose value changes without an event,",
    ),
    ("model M input Real u; Boolean b = noEvent(u > 0); end M;", "'b', a discrete variable whose value changes"),
    (
        STATE + "discrete Real d; equation der(x) = 1; when noEvent(x > 1) then d = 1; end when; end M;",
        "a when-condition that changes without an event",
    ),
    (TABLE + "model M Real y = t(time, {0, 1}, {1, 2, 3}, 1); end M;", "other than one value a point"),
    (
        TABLE + "model M input Integer e; Real y = t(time, {0, 1}, {1, 2}, e); end M;",
        "a table whose interpolation changes",
    ),
    (
        STATE
        + 'discrete Real d; equation der(x) = 1; when x > 1 then d = 1; elsewhen x > 2 then d = 2; terminate("end"); '
        "end when; end M;",
        "a terminate in an elsewhen",
    ),
    (
        STATE + "discrete Real d; discrete Real e; equation der(x) = 1; algorithm when x > 1 then d := 1; end when; "
        "when x > 2 then e := 1; elsewhen x > 3 then d := 2; end when; end M;",
        "'d' assigned under several conditions that are not one when-clause",
    ),
    (
        STATE + "discrete Real d; discrete Boolean b = x > 3; equation der(x) = 1; algorithm when x > 1 then d := 1; "
        "end when; when x > 2 then if b then d := 2; end if; end when; end M;",
        "'d' assigned under several conditions that are not one when-clause",
    ),
    (
        STATE + "discrete Real d; equation der(x) = 1; algorithm d := 1; when x > 2 then d := 2; end when; end M;",
        "'d' assigned under several conditions that are not one when-clause",
    ),
    ("model M input Boolean b = true; Real y = if b then 1 else 2; end M;", "the input 'b' with a default value"),
    ("model M Real x = time; Real y(start = x) = 2; end M;", "'start' of 'y' that depends on more than parameters"),
    (
        STATE + "Integer n; initial equation n = if x > 0 then 1 else 2; equation der(x) = 1; when x > 1 then n = 2; "
        "end when; end M;",
        "an initial value of 'n' that depends on more than parameters",
    ),
    (
        (
            "model P function k input Real x; output Real y; algorithm y := 5 * x; end k; Real y = k(1); end P; "
            "model N function k input Real x; output Real y; algorithm y := 7 * x; end k; Real y = k(1); end N; "
            "model M P p; N n; end M;"
        ),
        "'k', a function with the name of another one",
    ),
    (
        (
            "function f input Real x; output Real y; algorithm y := x; for i in 1:1000 loop for j in 1:1000 loop "
            "y := y * x + i; end for; end for; end f; model M Real y = f(time); end M;"
        ),
        "whose loops unroll to more than 50000 assignments",
    ),
    (
        (
            "function f input Real x; output Real y; algorithm y := x; for i in 1:18000 loop y := y * x + i; "
            "end for; end f; model M Real y = f(time); end M;"
        ),
        "which unrolls to more than 50000 operations",
    ),
    (
        (
            "function f input Real x; output Real y; protected Real a; algorithm if x > 0 then a := x; end if; y "
            ":= a; end f; "
            "model M Real y = f(time); end M;"
        ),
        "function 'f': `a` is used without a value",
    ),
]


@pytest.mark.parametrize(("text", "what"), REFUSED)
@pytest.mark.sampled(4)
def test_a_construct_is_refused_by_name_and_place(text: str, what: str) -> None:
    try:
        result = compiled(text)
    except Exception as refusal:  # noqa: BLE001 - the front-end's own refusal is as good, but the case is then idle
        pytest.fail(f"the front-end refuses it already: {refusal}")
    with pytest.raises(DseError) as caught:
        flatten(result)
    (problem,) = caught.value.problems
    assert what in problem.what
    assert problem.where is not None
    assert (problem.where.file, problem.where.line) == ("m.mo", 2)


def test_the_place_is_the_line_and_column_of_the_construct() -> None:
    with pytest.raises(DseError) as caught:
        flattened("model M\n  input Real u;\n  Real y;\nequation\n  y = 3 + delay(u, 0.1);\nend M;")
    (problem,) = caught.value.problems
    assert str(problem.where) == "m.mo:6:11"


PLAIN = "model M input Real u; Real x(start = 1, fixed = true); Real y; equation der(x) = -x; y = sin(u) + x; end M;"


CHANGES: dict[str, Callable[[Any], object]] = {
    "a part of the system": lambda storage: storage.update(brand_new=[1]),
    "a kind of expression": lambda storage: _nodes(storage).__setitem__(-1, {"riddle": {"lhs": 0, "rhs": 1}}),
    "a key of an expression": lambda storage: _nodes(storage)[-1]["binary"].update(mode="strange"),
    "an operator": lambda storage: _nodes(storage)[-1]["binary"].update(operator="xor"),
    "a function": lambda storage: [
        node["builtin"].update(builtin="gamma") for node in _nodes(storage) if "builtin" in node
    ],
    "a role of a variable": lambda storage: storage["variables"][0].update(role="oracle"),
    "an attribute": lambda storage: storage["variables"][0]["attributes"].update(colour="red"),
    "operands left over": lambda storage: storage["expressions"]["operands"].append(0),
    "a later expression": lambda storage: _nodes(storage)[-1]["binary"].update(lhs=len(_nodes(storage)) + 3),
    "a missing equation": lambda storage: storage["continuous_equation_operations"].pop(),
    "a kind of equation": lambda storage: storage["continuous_equation_operations"].append({"inequality": {}}),
} | {
    part: lambda storage, part=part: storage.update({part: [{"unknown": 1}]})  # type: ignore[misc]
    for part in ("delays", "previous_values", "terminals")
}
"""To the front-end's storage of a plain model, which the reader does not know."""


def _nodes(storage: Any) -> Any:
    return storage["expressions"]["nodes"]


@pytest.mark.parametrize("change", CHANGES)
def test_what_the_reader_does_not_know_is_refused(change: str) -> None:
    result = compiled(PLAIN)
    flatten(result)
    CHANGES[change](result.dae["storage"])
    with pytest.raises(DseError):
        flatten(result)


def test_an_unknown_statement_of_a_function_is_refused() -> None:
    result = compiled(
        "function f input Real x; output Real y; algorithm y := 2 * x; end f; model M Real y = f(time); end M;"
    )
    result.dae["storage"]["functions"][0]["statements"].insert(0, {"pray": {}})
    with pytest.raises(DseError, match="a statement of kind 'pray'"):
        flatten(result)


def test_a_reading_of_an_outdated_value_is_refused() -> None:
    result = compiled(
        "function f input Real x; output Real y; algorithm y := x; y := y + 1; y := y * 2; end f; "
        "model M Real y = f(time); end M;"
    )
    readings = [
        node["function_value"] for node in result.dae["storage"]["expressions"]["nodes"] if "function_value" in node
    ]
    assert readings[-1]["definition_ordinal"] == 1
    readings[-1]["definition_ordinal"] = 0
    with pytest.raises(DseError, match="a value that no statement before has given"):
        flatten(result)


def test_an_unknown_condition_is_refused() -> None:
    result = compiled(STATE + "discrete Real d; equation der(x) = 1; when x > 1 then d = 1; end when; end M;")
    result.dae["storage"]["conditions"][0]["node"] = {"omen": 3}
    with pytest.raises(DseError, match="a condition of kind 'omen'"):
        flatten(result)
