"""A function's derivative is that of its own algorithm; an annotation must say the same."""

from __future__ import annotations

import pytest
from modelica_text import flattened

from dse.errors import DseError
from dse.modelica.algebra.derivative import derived

MODEL = """model M
  function f
    input Real x[2];
    input Real k;
    input Integer n;
    output Real y;
    output Integer m;
  algorithm
    y := if x[1] > x[2] then k * x[1] ^ n else x[1] * sin(x[2]);
    m := n;
    annotation(derivative{how} = f_der);
  end f;
  function f_der
    input Real x[2];
    input Real k;
    input Integer n;
    input Real x_der[2];
    {more}
    output Real y;
  algorithm
    y := {right};
  end f_der;
  input Real u[2];
  Real y = f({argument}, u[2], 2);
end M;
"""
FULL = "if x[1] > x[2] then 2 * k * x[1] * x_der[1]{} else x_der[1] * sin(x[2]) + x[1] * cos(x[2]) * x_der[2]"
OF_K = FULL.format(" + k_der * x[1] ^ 2")


def written(right: str, how: str, more: str, argument: str) -> str:
    return MODEL.replace("{right}", right).replace("{how}", how).replace("{more}", more).replace("{argument}", argument)


def told(right: str, how: str = "", more: str = "input Real k_der;", argument: str = "u") -> str:
    try:
        flattened(written(right, how, more, argument))
    except DseError as error:
        (problem,) = error.problems
        return f"{problem.where.line}: {problem.what}"
    return ""


@pytest.mark.parametrize(("how", "more", "right"), [
    ("", "input Real k_der;", OF_K),
    ("(noDerivative = k)", "", FULL.format("")),
])  # fmt: skip
def test_what_is_the_derivative_is_taken(how: str, more: str, right: str) -> None:
    assert told(right, how, more) == ""


@pytest.mark.parametrize(("how", "more", "right"), [
    ("", "input Real k_der;", FULL.format("")),
    ("", "input Real k_der;", OF_K.replace("2 * k", "2.001 * k")),
])  # fmt: skip
def test_another_formula_is_refused_where_it_is_named(how: str, more: str, right: str) -> None:
    assert told(right, how, more) == "12: the annotation derivative of 'f': 'f_der' is not its derivative"


def test_another_formula_of_inputs_that_vary_is_no_derivative() -> None:
    flat = flattened(written(FULL.format("").replace("cos", "sin"), "(noDerivative = k)", "", "u"))
    residuals = [equation.residual for equation in flat.equations]
    with pytest.raises(DseError, match="annotated with noDerivative"):
        derived(residuals, lambda _: flat.graph.constant(1.0))
