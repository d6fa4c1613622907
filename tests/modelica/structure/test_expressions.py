"""Simplifying, evaluating and differentiating: against each other, numpy, scipy and finite differences."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from modelica.structure.interpreter import symbol
from scipy.interpolate import CubicHermiteSpline, PchipInterpolator

from dse.errors import DseError
from dse.modelica.algebra.arithmetic import FUNCTIONS
from dse.modelica.algebra.derivative import partial
from dse.modelica.algebra.evaluate import evaluate, table
from dse.modelica.algebra.expression import Expression, Graph
from dse.modelica.algebra.symbol import Referent, Symbol
from dse.modelica.flat_model import Role, ScalarType, Variable
from dse.modelica.structure.reduction.pantelides import total

ARITY = {
    **dict.fromkeys(("add", "subtract", "multiply", "divide", "power", "minimum", "maximum", "atan2", "and", "or"), 2),
    **dict.fromkeys(("less", "less_equal", "greater", "greater_equal", "equal", "not_equal", "prescribed"), 2),
    "if": 3,
}
SMOOTH = (
    *("add", "subtract", "multiply", "divide", "negate", "sin", "cos"),
    *("tanh", "exp", "atan", "atan2", "sqrt", "log"),
)


def plain(graph: Graph, operator: str, *operands: Expression) -> Expression:
    return graph.node(operator, operands)


TRUTH = ("less", "less_equal", "greater", "greater_equal", "equal", "not_equal", "and", "or", "not")


@st.composite
def trees(draw: st.DrawFn, operators: tuple[str, ...]) -> list[tuple[str, ...]]:
    """A program: each line an operator and the numbers of earlier lines; the first lines are leaves."""
    lines: list[tuple[object, ...]] = [("x",), ("y",), (draw(st.sampled_from([0.0, 1.0, -1.0, 2.5])),)]
    for _ in range(draw(st.integers(1, 12))):
        operator = draw(st.sampled_from(operators))
        count = ARITY.get(operator, 1)
        lines.append((operator, *(draw(st.integers(0, len(lines) - 1)) for _ in range(count))))
    return lines  # type: ignore[return-value]  # lines of mixed kinds


def built(graph: Graph, lines: list[tuple[object, ...]], is_simplified: bool) -> Expression:
    made: list[Expression] = []
    for operator, *places in lines:
        if isinstance(operator, float):
            made.append(graph.constant(operator))
        elif operator in ("x", "y"):
            made.append(graph.variable(str(operator)))
        else:
            operands = [made[int(str(place))] for place in places]
            if operator in ("and", "or", "not") or operator == "if":
                # Conditions are truth values, as the front-end guarantees.
                count = 1 if operator in ("if", "not") else 2
                for k in range(count):
                    if lines[int(str(places[k]))][0] not in TRUTH:
                        operands[k] = graph.node("less", (operands[k], graph.constant(0.5)))
            make = graph.make if is_simplified else lambda name, *o: plain(graph, name, *o)
            made.append(make(str(operator), *operands))
    return made[-1]


@settings(max_examples=150, deadline=None)
@given(trees(tuple(name for name in FUNCTIONS)), st.floats(-3, 3), st.floats(-3, 3))
def test_simplifying_keeps_every_finite_value_to_the_bit(lines: list[tuple[object, ...]], x: float, y: float) -> None:
    values = {symbol("x"): x, symbol("y"): y}
    before = _finite_everywhere(built(Graph(), lines, is_simplified=False), values)
    if before is not None:
        (after,) = evaluate([built(Graph(), lines, is_simplified=True)], values)
        # Zeros differ in sign at most, and what looks at the sign of a zero is atan2 alone.
        assert after == before or any(line[0] == "atan2" for line in lines)


def _finite_everywhere(root: Expression, values: dict[Symbol, float]) -> float | None:
    from dse.modelica.algebra.traversal import walk

    nodes = list(walk([root]))
    found = evaluate(nodes, values)
    return found[-1] if all(map(math.isfinite, found)) else None


@settings(max_examples=80, deadline=None)
@given(trees(SMOOTH), st.floats(0.3, 2), st.floats(0.3, 2))
def test_partial_derivatives_agree_with_finite_differences(lines: list[tuple[object, ...]], x: float, y: float) -> None:
    graph = Graph()
    root = built(graph, lines, is_simplified=True)
    values = {symbol("x"): x, symbol("y"): y}
    if _finite_everywhere(root, values) is None or not all(abs(v) < 1e3 for v in evaluate(_nodes(root), values)):
        return
    for leaf, at in list(values.items()):
        (exact,) = evaluate([partial(root, leaf)], values)
        steps = [evaluate([root], values | {leaf: at + h})[0] for h in (-2e-4, -1e-4, 1e-4, 2e-4)]
        difference = (steps[0] - 8 * steps[1] + 8 * steps[2] - steps[3]) / 12e-4
        coarse = (steps[3] - steps[0]) / 4e-4
        if math.isfinite(difference) and abs(difference - coarse) < 1e-4 * max(1, abs(difference)):
            assert exact == pytest.approx(difference, rel=1e-4, abs=1e-4)


def _nodes(root: Expression) -> list[Expression]:
    from dse.modelica.algebra.traversal import walk

    return list(walk([root]))


def test_an_infinite_result_is_not_folded_away() -> None:
    graph = Graph()
    assert graph.make("divide", graph.constant(1.0), graph.constant(0.0)).operator == "divide"
    assert (graph.variable("x") / graph.variable("x")).operator == "divide"


def test_steps_have_no_derivative_and_kinks_have_one_side() -> None:
    graph = Graph()
    x = graph.variable("x")
    assert partial(graph.make("floor", x), symbol("x")).is_number(0)
    slope = partial(graph.make("abs", x), symbol("x"))
    assert evaluate([slope], {symbol("x"): -2.0}) == [-1.0]
    assert evaluate([slope], {symbol("x"): 3.0}) == [1.0]
    slope = partial(graph.make("minimum", x * x, 2.0 * x), symbol("x"))
    assert evaluate([slope], {symbol("x"): 0.5}) == [1.0]
    assert evaluate([slope], {symbol("x"): 3.0}) == [2.0]


def test_time_derivatives_raise_the_order_and_leave_parameters() -> None:
    graph = Graph()
    variables = {
        "x": Variable("x", ScalarType.REAL, Role.CONTINUOUS),
        "p": Variable("p", ScalarType.REAL, Role.PARAMETER),
        "u": Variable("u", ScalarType.REAL, Role.INPUT),
    }
    x, p, u = (graph.variable(name) for name in variables)
    time = graph.symbol(Symbol(referent=Referent.TIME))
    assert total(p * x, variables) is p * graph.variable("x", 1)
    assert total(graph.variable("x", 1) + time, variables) is graph.variable("x", 2) + 1.0
    assert total(graph.symbol(Symbol("0", referent=Referent.HELD)) * x, variables).operands[1] is graph.variable("x", 1)
    with pytest.raises(DseError, match="derivative of the input 'u'"):
        total(u * x, variables)


def test_outside_a_table_holds_continues_or_is_not_a_number() -> None:
    xs, ys = [0.0, 1.0, 3.0], [1.0, 2.0, 0.0]
    slope = float(PchipInterpolator(xs, ys)(3.0, 1))
    assert table((0,), (5.0,), (xs,), ys, True, 1) == 0.0
    assert table((1,), (5.0,), (xs,), ys, True, 1) == 0.0
    assert table((0,), (5.0,), (xs,), ys, True, 2) == pytest.approx(2 * slope, rel=1e-14)
    assert table((1,), (5.0,), (xs,), ys, True, 2) == pytest.approx(slope, rel=1e-14)
    assert math.isnan(table((0,), (5.0,), (xs,), ys, True, 3))
    assert table((0,), (-1.0,), (xs,), ys, False, 2) == pytest.approx(0.0, abs=1e-15)


def test_smooth_tables_of_two_axes_are_hermite_along_both() -> None:
    xs, ys = [0.0, 1.0, 2.5, 4.0], [-1.0, 0.0, 2.0]
    zs = np.sin(np.arange(12.0)).reshape(4, 3)

    def curve(axis: list[float], values: np.ndarray) -> CubicHermiteSpline:
        slopes = []
        for k in range(len(axis)):
            first = min(max(k - 1, 0), len(axis) - 3)
            part = slice(first, first + 3)
            slopes.append(np.polyval(np.polyder(np.polyfit(axis[part], values[part], 2)), axis[k]))
        return CubicHermiteSpline(axis, values, slopes)

    for x, y in ((0.3, -0.2), (2.0, 1.5), (3.9, -1.0), (2.5, 0.0)):
        by_y = np.array([curve(ys, row)(y) for row in zs])
        found = table((0, 0), (x, y), (xs, ys), list(zs.ravel()), True, 1)
        assert found == pytest.approx(float(curve(xs, by_y)(x)), rel=1e-12)
        slope = table((1, 0), (x, y), (xs, ys), list(zs.ravel()), True, 1)
        assert slope == pytest.approx(float(curve(xs, by_y)(x, 1)), rel=1e-11, abs=1e-12)


@pytest.mark.parametrize("is_smooth", [0.0, 1.0])
@pytest.mark.parametrize("extrapolation", [1.0, 2.0])
@pytest.mark.parametrize("point", [(0.4, 0.7), (-2.0, 0.3), (5.0, 9.0), (2.9, -4.0)])
def test_derivatives_of_tables_agree_with_differences(
    is_smooth: float, extrapolation: float, point: tuple[float, float]
) -> None:
    graph = Graph()
    x, y = graph.variable("x"), graph.variable("y")
    axis = graph.array(map(graph.constant, (0.0, 1.0, 3.0, 4.0)), (4,))
    other = graph.array(map(graph.constant, (-1.0, 0.5, 2.0)), (3,))
    zs = graph.array(map(graph.constant, np.cos(np.arange(12.0))), (4, 3))
    zero, more = graph.constant(0.0), (graph.constant(is_smooth), graph.constant(extrapolation))
    root = graph.call("table2", (zero, zero, x, y, axis, other, zs, *more)) + graph.call(
        "table1", (zero, x * y, axis, graph.array(map(graph.constant, (1.0, 3.0, 2.0, 2.5)), (4,)), *more)
    )
    values = dict(zip((symbol("x"), symbol("y")), point, strict=True))
    for leaf, at in list(values.items()):
        first = partial(root, leaf)
        high, low = (evaluate([root, first], values | {leaf: at + h}) for h in (1e-6, -1e-6))
        assert evaluate([first], values)[0] == pytest.approx((high[0] - low[0]) / 2e-6, rel=1e-6, abs=1e-7)
        second = partial(first, leaf)
        assert evaluate([second], values)[0] == pytest.approx((high[1] - low[1]) / 2e-6, rel=1e-5, abs=1e-6)


def test_a_third_derivative_of_a_table_is_refused() -> None:
    graph = Graph()
    x, two = graph.variable("x"), graph.constant(2.0)
    axis = graph.array(map(graph.constant, (0.0, 1.0)), (2,))
    with pytest.raises(DseError, match="third derivative"):
        partial(graph.call("table1", (two, x, axis, axis, two, two)), symbol("x"))


def test_a_table_whose_axis_does_not_increase_cannot_be_evaluated() -> None:
    graph = Graph()
    axis = graph.array(map(graph.constant, (0.0, 0.0)), (2,))
    one = graph.constant(1.0)
    with pytest.raises(DseError, match="strictly increasing"):
        evaluate([graph.call("table1", (graph.constant(0.0), one, axis, axis, one, one))], {})


def test_an_index_outside_its_array_is_not_a_number() -> None:
    graph = Graph()
    array = graph.array(map(graph.constant, (1.0, 2.0, 3.0, 4.0)), (2, 2))
    chosen = graph.make("select", array, graph.variable("i"), graph.constant(2.0))
    assert evaluate([chosen], {symbol("i"): 2.0}) == [4.0]
    assert math.isnan(evaluate([chosen], {symbol("i"): 3.0})[0])
    assert graph.make("select", array, graph.constant(1.0), graph.constant(2.0)).is_number(2.0)
