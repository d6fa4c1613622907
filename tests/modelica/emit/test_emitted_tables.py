"""Tables, and elements with an index known at run time only, as compiled C."""

from __future__ import annotations

import math

import pytest
from emitted_model import Emitter
from model_maker import Maker, explicit

from dse.errors import DseError, Location
from dse.modelica.algebra.symbol import Symbol
from dse.modelica.emit.model import emit
from dse.modelica.emit.variables import variables
from dse.modelica.flat_model import Role, ScalarType

_AT = Location("ball.mo", 7, 3)


def test_an_index_outside_of_the_array_fails_by_name(emitted: Emitter) -> None:
    made = Maker()
    graph = made.graph
    values = [made.parameter(f"p[{k}]", 10.0 * k) for k in (1, 2, 3, 4, 5, 6)]
    i, j = made.variable("i", Role.INPUT, ScalarType.INTEGER), made.variable("j", Role.INPUT, ScalarType.INTEGER)
    made.variable("y", is_output=True)
    made.put("outputs", explicit("y", graph.make("select", graph.array(values, (2, 3)), i, j)))
    model = emitted(made.solved())
    for row in (1.0, 2.0):
        for column in (1.0, 2.0, 3.0):
            model.set({Symbol("i"): row, Symbol("j"): column})
            assert model.call("outputs") == 0
            assert model.get(Symbol("y")) == 10.0 * (3 * (row - 1) + column)
    for row, column in ((0.0, 1.0), (3.0, 1.0), (1.0, 4.0), (1.0, 0.0), (1.5, 1.0), (math.nan, 1.0), (math.inf, 1.0)):
        model.set({Symbol("i"): row, Symbol("j"): column})
        code = model.call("outputs")
        assert model.text("failure", code) == "an index is not in 1:2, 1:3: in the equation for y"


def test_a_branch_that_is_not_taken_cannot_fail(emitted: Emitter) -> None:
    made = Maker()
    graph = made.graph
    i = made.variable("i", Role.INPUT, ScalarType.INTEGER)
    made.variable("y", is_output=True)
    made.variable("z", is_output=True)
    three = graph.array([graph.constant(k) for k in (7.0, 8.0, 9.0)], (3,))
    element = graph.make("select", three, i)
    is_inside = graph.make("and", graph.make("greater", i, graph.constant(0)), graph.make("less", i, graph.constant(4)))
    made.put("outputs", explicit("y", graph.make("if", is_inside, element + element, graph.constant(-1))))
    is_eight = graph.make("and", is_inside, graph.make("equal", element, graph.constant(8)))
    made.put("outputs", explicit("z", graph.make("if", is_eight, graph.constant(1), graph.constant(0))))
    model = emitted(made.solved())
    for index, expected in ((0, (-1, 0)), (1, (14, 0)), (2, (16, 1)), (3, (18, 0)), (4, (-1, 0))):
        model.set({Symbol("i"): index})
        assert model.call("outputs") == 0
        assert (model.get(Symbol("y")), model.get(Symbol("z"))) == expected


def test_tables_pass_parameters_in_a_row_copies_and_constants_alike(emitted: Emitter) -> None:
    made = Maker()
    graph = made.graph
    xs = [made.parameter(f"xs[{k}]", float(k)) for k in (1, 2, 3)]
    ys = [made.parameter(f"ys[{k}]", float(k * k)) for k in (1, 2, 3)]
    u = made.variable("u", Role.INPUT)
    fixed = [graph.constant(k) for k in (1.0, 2.0, 3.0)]
    axes = {"row": xs, "copy": [x * 1.0 for x in (xs[0], xs[1] + 0.0, xs[2] / 1.0)], "numbers": fixed}
    axes["copy"] = [xs[0], graph.node("divide", (xs[1], graph.variable("ys[1]"))), xs[2]]
    zero, hold = graph.constant(0), graph.constant(1)
    for name, axis in axes.items():
        made.variable(name, is_output=True)
        operands = (zero, u, graph.array(axis, (3,)), graph.array(ys, (3,)), zero, hold)
        made.put("outputs", explicit(name, graph.call("table1", operands)))
    model = emitted(made.solved())
    for u_now, expected in ((0.0, 1.0), (1.5, 2.5), (2.5, 6.5), (9.0, 9.0)):
        model.start()
        model.set({Symbol("u"): u_now})
        assert model.call("outputs") == 0
        assert [model.get(Symbol(name)) for name in axes] == [expected] * 3
    model.library.test_start()
    model.set({Symbol("xs[2]"): 3.0})
    text = model.text("failure", model.call("parameters"))
    assert (
        text == "the axis of a table (xs[1], …, xs[3]) must have at least two numbers, each greater than the one before"
    )


def test_a_table_that_must_not_extrapolate_fails_by_name(emitted: Emitter) -> None:
    made = Maker()
    graph = made.graph
    u = made.variable("u", Role.INPUT)
    made.variable("y", is_output=True)
    numbers = [graph.constant(k) for k in (1.0, 2.0)]
    operands = (
        graph.constant(0),
        u,
        graph.array(numbers, (2,)),
        graph.array(numbers, (2,)),
        graph.constant(0),
        graph.constant(3),
    )
    made.put("outputs", explicit("y", graph.call("table1", operands)))
    model = emitted(made.solved())
    model.set({Symbol("u"): 2.5})
    text = model.text("failure", model.call("outputs"))
    assert text == "a table is read outside of its axis, where that is an error: in the equation for y"


def test_an_axis_of_numbers_that_does_not_increase_is_refused_at_once() -> None:
    made = Maker()
    graph = made.graph
    made.variable("y", is_output=True)
    numbers = graph.array([graph.constant(k) for k in (1.0, 1.0)], (2,))
    operands = (graph.constant(0), graph.constant(1), numbers, numbers, graph.constant(0), graph.constant(1))
    made.put("outputs", explicit("y", graph.call("table1", operands)))
    solved = made.solved()
    with pytest.raises(DseError, match="each greater than the one before"):
        emit(solved, variables(solved), "")


def test_an_array_that_follows_from_parameters_is_copied_when_they_are_set_not_in_every_step(emitted: Emitter) -> None:
    made = Maker()
    graph = made.graph
    values = [made.parameter(f"p[{k}]", float(k)) for k in range(1, 501)]
    i = made.variable("i", Role.INPUT, ScalarType.INTEGER)
    made.variable("y", is_output=True)
    doubled = graph.array([2.0 * value for value in values], (500,))
    made.put("outputs", explicit("y", graph.make("select", doubled, i)))
    model = emitted(made.solved())
    text = model.files["model.h"].decode()
    hot = text[text.index("int model_outputs(") : text.index("int model_event(")]
    assert "#define DSE_DATA 500" in text
    assert len(hot.splitlines()) < 20
    model.start(**{"p[1]": 7.0, "p[500]": -3.0})
    for index, expected in ((1, 14.0), (2, 4.0), (499, 998.0), (500, -6.0)):
        model.set({Symbol("i"): float(index)})
        assert model.call("outputs") == 0
        assert model.get(Symbol("y")) == expected
