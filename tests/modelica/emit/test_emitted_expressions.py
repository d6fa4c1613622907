"""Every operator, alone and in random graphs: the C code computes what the evaluator computes."""

from __future__ import annotations

import math
import struct

from emitted_model import Emitter
from hypothesis import HealthCheck, given, settings, strategies as st

from dse.modelica.algebra.evaluate import evaluate
from dse.modelica.algebra.expression import Expression, Graph
from dse.modelica.algebra.symbol import Symbol
from dse.modelica.flat_model import FlatModel, Role, ScalarType, Variable
from dse.modelica.solved_model import Explicit, Solved

_INPUTS = ("a", "b", "c", "d")


def model_of(graph: Graph, values: list[Expression]) -> Solved:
    """A model without states whose outputs y0, y1, … are *values* of the inputs a, b, c, d."""
    names = [f"y{number}" for number in range(len(values))]
    declared = {name: Variable(name, ScalarType.REAL, Role.INPUT) for name in _INPUTS}
    declared |= {name: Variable(name, ScalarType.REAL, Role.CONTINUOUS, is_output=True) for name in names}
    flat = FlatModel("Random", graph, declared, ())
    blocks = tuple(Explicit(Symbol(n), value) for n, value in zip(names, values, strict=True))
    return Solved(flat, (), (), (), blocks, blocks, blocks, {}, (), {})


_TWO = (
    *("add", "subtract", "multiply", "divide", "power", "minimum", "maximum", "atan2", "and", "or"),
    *("less", "less_equal", "greater", "greater_equal", "equal", "not_equal"),
)
_ONE = (
    *("negate", "not", "abs", "sign", "sqrt", "sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh"),
    *("exp", "log", "log10", "floor", "ceil"),
)
_SPECIAL = (0.0, -0.0, 1.0, -1.0, 0.5, 2.0, -2.0, 3.0, -3.0, 7.25, 1e-300, 1e300, math.inf, -math.inf, math.nan)


def is_close(one: float, other: float, units: float) -> bool:
    """Equal but for *units* in the last place; NaN equals NaN, and zeros of both signs are equal."""
    if math.isnan(one) or math.isnan(other):
        return math.isnan(one) and math.isnan(other)
    if one == other:
        return True
    return (
        math.isfinite(one) and math.isfinite(other) and abs(one - other) <= units * math.ulp(max(abs(one), abs(other)))
    )


def symbols(graph: Graph) -> list[Expression]:
    return [graph.variable(name) for name in _INPUTS]


def test_every_operator_computes_what_the_evaluator_does_for_every_special_value(emitted: Emitter) -> None:
    graph = Graph()
    a, b, c, _ = symbols(graph)
    values = [graph.node(operator, (a,)) for operator in _ONE]
    values += [graph.node(operator, (a, b)) for operator in _TWO]
    values.append(graph.node("if", (a, b, c)))
    model = emitted(model_of(graph, values))
    wrong = []
    for first in _SPECIAL:
        for second in _SPECIAL:
            numbers = {Symbol(name): value for name, value in zip("abc", (first, second, 4.0), strict=True)}
            model.set(numbers)
            assert model.call("outputs") == 0
            for number, (value, expected) in enumerate(zip(values, evaluate(values, numbers), strict=True)):
                found = model.get(Symbol(f"y{number}"))
                if not is_close(found, expected, 1):
                    wrong.append((value, first, second, found, expected))
    assert wrong == []


def test_a_constant_power_is_the_power(emitted: Emitter) -> None:
    graph = Graph()
    exponents = [*range(-17, 18), 0.5, -0.5, 2.5, 1 / 3]
    values = [graph.node("power", (graph.variable("a"), graph.constant(exponent))) for exponent in exponents]
    model = emitted(model_of(graph, values))
    for base in (0.0, 1.0, -1.0, 1.7, -2.3, 1e-5, 12345.678, math.inf, math.nan):
        model.set({Symbol("a"): base})
        model.call("outputs")
        for number, expected in enumerate(evaluate(values, {Symbol("a"): base})):
            # Each of at most 7 multiplications rounds once, on up to twice the error of its operands.
            assert is_close(model.get(Symbol(f"y{number}")), expected, 16), (base, exponents[number])


def graphs(count: int) -> st.SearchStrategy[list[tuple[str, tuple[int, ...], float]]]:
    """Recipes of nodes; operands count back from the node itself."""
    return st.lists(
        st.tuples(
            st.sampled_from((*_TWO, *_ONE, "if", "constant", "select")),
            st.tuples(*(st.integers(0, 40) for _ in range(4))),
            st.floats(-10, 10),
        ),
        min_size=1,
        max_size=count,
    )


def built(graph: Graph, recipe: list[tuple[str, tuple[int, ...], float]]) -> list[Expression]:
    nodes = symbols(graph)
    for operator, operands, number in recipe:
        picked = [nodes[-1 - (place % len(nodes))] for place in operands]
        if operator == "constant":
            nodes.append(graph.constant(number))
        elif operator == "select":
            array = graph.array(picked[:3], (3,))
            nodes.append(graph.make("select", array, whole_from_1_to_3(graph, picked[3])))
        else:
            nodes.append(graph.make(operator, *picked[: 3 if operator == "if" else 2 if operator in _TWO else 1]))
    return nodes[4:]


def whole_from_1_to_3(graph: Graph, value: Expression) -> Expression:
    one, three = graph.constant(1), graph.constant(3)
    inside = graph.make("and", graph.make("greater", value, one), graph.make("less", value, three))
    return graph.make("if", inside, graph.make("floor", value), three)


@given(graphs(150), st.lists(st.tuples(*(st.floats(-20, 20) for _ in range(4))), min_size=3, max_size=3))
@settings(max_examples=8, deadline=None, suppress_health_check=[HealthCheck.too_slow])
def test_random_graphs_compute_what_the_evaluator_computes(
    emitted: Emitter, recipe: list[tuple[str, tuple[int, ...], float]], points: list[tuple[float, ...]]
) -> None:
    graph = Graph()
    values = built(graph, recipe)
    model = emitted(model_of(graph, values))
    assert model.call("parameters") == 0  # what is constant is computed there
    for point in points:
        numbers = {Symbol(name): value for name, value in zip(_INPUTS, point, strict=True)}
        model.set(numbers)
        code = model.call("outputs")
        found = [model.get(Symbol(f"y{number}")) for number in range(len(values))]
        # Python and C call the same libm, so that all but multiplied powers are equal to the bit.
        assert code == 0
        for value, one, other in zip(values, found, evaluate(values, numbers), strict=True):
            assert bits(one) == bits(other) or is_close(one, other, 0), (value, one, other)


def bits(value: float) -> bytes:
    return struct.pack("<d", value)
