"""What can fail is computed only where its value is needed: random graphs against an evaluator that is lazy."""

from __future__ import annotations

import math

import pytest
from emitted_model import Emitter
from hypothesis import HealthCheck, given, settings, strategies as st

from dse.modelica.algebra.arithmetic import FUNCTIONS
from dse.modelica.algebra.expression import Expression, Graph
from dse.modelica.algebra.symbol import Symbol
from dse.modelica.algebra.traversal import walk
from dse.modelica.emit.expressions.regions import ROOT, regions
from dse.modelica.flat_model import FlatModel, Role, ScalarType, Variable
from dse.modelica.solved_model import Explicit, Solved

_INPUTS = ("a", "b", "c")


class IndexOutsideError(Exception):
    """The lazy evaluator needed an element that is not there."""


def lazy(node: Expression, values: dict[str, float]) -> float:
    """The value of *node*; operands that are not needed are not looked at."""
    if node.symbol is not None:
        return values[node.symbol.name]
    if node.is_constant:
        return node.value
    first = node.operands[0]
    match node.operator:
        case "if":
            return lazy(node.operands[1 if lazy(first, values) else 2], values)
        case "and":
            return float(bool(lazy(first, values)) and bool(lazy(node.operands[1], values)))
        case "or":
            return float(bool(lazy(first, values)) or bool(lazy(node.operands[1], values)))
        case "select":
            index = lazy(node.operands[1], values)
            if index not in (1.0, 2.0):
                raise IndexOutsideError
            # The elements are computed all, as an array is.
            return [lazy(element, values) for element in first.operands][int(index) - 1]
    return FUNCTIONS[node.operator](*(lazy(operand, values) for operand in node.operands))


_OPERATORS = ("if", "if", "if", "and", "or", "select", "select", "less", "add", "minimum", "sin")


def built(recipe: list[tuple[str, tuple[int, int, int]]]) -> list[Expression]:
    """The last nodes of the graph that *recipe* describes."""
    graph = Graph()
    nodes = [*(graph.variable(name) for name in _INPUTS), graph.constant(1), graph.constant(2)]
    for operator, operands in recipe:
        picked = [nodes[-1 - place % min(len(nodes), 9)] for place in operands]
        match operator:
            case "select":
                new = graph.make("select", graph.array(picked[:2], (2,)), picked[2])
            case "if":
                new = graph.make("if", graph.make("less", picked[0], graph.constant(1.5)), picked[1], picked[2])
            case "sin":
                new = graph.make("sin", picked[0])
            case _:
                new = graph.make(operator, picked[0], picked[1])
        nodes.append(new)
    return nodes[-4:]


def model_of(values: list[Expression]) -> Solved:
    """One model for each way to fail: the outputs y0, y1, … are *values*."""
    declared = {name: Variable(name, ScalarType.REAL, Role.INPUT) for name in _INPUTS}
    declared |= {f"y{k}": Variable(f"y{k}", ScalarType.REAL, Role.CONTINUOUS) for k in range(len(values))}
    blocks = tuple(Explicit(Symbol(f"y{k}"), value) for k, value in enumerate(values))
    flat = FlatModel("Lazy", values[0].graph, declared, ())
    return Solved(flat, (), (), (), blocks, (), (), {}, (), {})


_RECIPES = st.lists(
    st.tuples(st.sampled_from(_OPERATORS), st.tuples(st.integers(0, 20), st.integers(0, 20), st.integers(0, 20))),
    min_size=4,
    max_size=28,
)
_NUMBERS = (0.0, 1.0, 2.0, 3.0)


@pytest.mark.thorough
@given(_RECIPES)
@settings(max_examples=12, deadline=None, suppress_health_check=[HealthCheck.too_slow])
def test_a_model_fails_exactly_where_a_needed_index_is_outside(
    emitted: Emitter, recipe: list[tuple[str, tuple[int, int, int]]]
) -> None:
    values = built(recipe)
    model = emitted(model_of(values), "-O0")
    for a in _NUMBERS:
        for b in _NUMBERS:
            for c in _NUMBERS:
                inputs = dict(zip(_INPUTS, (a, b, c), strict=True))
                model.set({Symbol(name): value for name, value in inputs.items()})
                try:
                    expected = [lazy(value, inputs) for value in values]
                except IndexOutsideError:
                    assert model.call("parameters") or model.call("outputs")
                    continue
                assert (model.call("parameters"), model.call("outputs")) == (0, 0)
                found = [model.get(Symbol(f"y{k}")) for k in range(len(values))]
                assert all(f == e or (math.isnan(f) and math.isnan(e)) for f, e in zip(found, expected, strict=True))


@given(_RECIPES)
@settings(max_examples=100, deadline=None)
def test_what_a_node_needs_stands_in_its_region_or_around_it(recipe: list[tuple[str, tuple[int, int, int]]]) -> None:
    values = built(recipe)
    nodes = list(walk(values))
    found = regions(nodes, values)
    around = {inner: region for (_, region), opened in found.branches.items() for inner in opened}

    def holds(outer: tuple[int, ...], inner: int) -> bool:
        while inner not in outer:
            if inner == ROOT:
                return False
            inner = around[inner]
        return True

    for node in nodes:
        for region in found.of[node.number]:
            opened = found.branches.get((node.number, region))
            for place, operand in enumerate(node.operands):
                used = opened[place - 1] if opened and place > 0 else region
                assert holds(found.of[operand.number], used)
