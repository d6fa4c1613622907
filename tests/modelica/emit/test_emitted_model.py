"""Parameters, starts, aliases and the table of variables of hand-made models."""

from __future__ import annotations

import math

import pytest
from emitted_model import Emitter
from model_maker import Maker, explicit

from dse.errors import DseError, Location
from dse.modelica.algebra.symbol import Referent, Symbol
from dse.modelica.emit.model import emit
from dse.modelica.emit.variables import Causality, Variability, variables
from dse.modelica.flat_model import Role, ScalarType
from dse.modelica.solved_model import Block

_AT = Location("ball.mo", 7, 3)


def test_what_depends_on_parameters_only_follows_them_and_is_not_in_the_hot_function(emitted: Emitter) -> None:
    made = Maker()
    graph = made.graph
    p, x = made.parameter("p", 4.0), made.variable("x")
    made.variable("area", is_output=True)
    made.states.append(Symbol("x"))
    heavy = graph.make("exp", graph.make("sqrt", p))
    made.put("derivatives", explicit("area", heavy / 3.0), explicit("x", heavy * x, 1))
    made.put("guesses", explicit("x", p))
    model = emitted(made.solved())
    for value in (4.0, 9.0):
        model.start(p=value)
        assert model.call("derivatives") == 0
        assert model.get(Symbol("area")) == math.exp(math.sqrt(value)) / 3.0
        assert model.get(Symbol("x", 1)) == math.exp(math.sqrt(value)) * value
    text = model.files["model.h"].decode()
    hot = text[text.index("int model_derivatives(") : text.index("int model_outputs(")]
    assert "exp" not in hot
    assert "exp" in text


def test_other_starts_change_start_c_alone(emitted: Emitter) -> None:
    made = Maker()
    p, u = made.parameter("p", 4.0), made.variable("u", Role.INPUT, start=made.graph.variable("p"))
    made.parameter("twice", None, binding=p * 2.0)
    made.put("parameters", explicit("twice", p * 2.0))
    made.variable("y", is_output=True)
    made.put("outputs", explicit("y", u * p))
    solved = made.solved()
    first = emit(solved, variables(solved), "{one}")
    second = emit(solved, variables(solved, {"p": 5.0}), "{two}")
    assert first["model.h"] == second["model.h"]
    assert first["start.c"] != second["start.c"]
    model = emitted(solved, starts={"p": 5.0})
    assert model.text("token", 0) == "{token}"
    model.start()
    assert model.get(Symbol("twice")) == 10.0
    assert model.get(Symbol("u")) == 5.0
    assert first == emit(solved, variables(solved), "{one}")


def test_the_table_of_variables_says_what_each_is() -> None:
    made = Maker()
    p = made.parameter("p", 4.0, unit="m", minimum=made.graph.constant(0.0))
    made.parameter("d", None, binding=p * 2.0)
    made.parameter("n", 3.0, is_structural=True)
    made.put("parameters", explicit("d", p * 2.0))
    x = made.variable("x", nominal=made.graph.constant(10.0))
    made.variable("a", is_output=True)
    made.variable("b", is_output=True, kind=ScalarType.BOOLEAN, role=Role.DISCRETE)
    made.variable("e", Role.INPUT, ScalarType.ENUMERATION, items=("low", "high"))
    made.states += [Symbol("x"), Symbol("x", 1)]
    made.aliases = {"a": (Symbol("x", 1), 1), "minus": (Symbol("x"), -1)}
    made.variable("minus")
    made.put("derivatives", explicit("b", made.graph.make("less", x, p)), explicit("x", -x, 2))
    listed = {each.name: each for each in variables(made.solved())}
    assert [each.reference for each in listed.values()] == list(range(len(listed)))
    assert listed["p"].causality is Causality.PARAMETER
    assert (listed["p"].start, listed["p"].unit, listed["p"].minimum) == (4.0, "m", 0.0)
    assert listed["d"].causality is Causality.CALCULATED_PARAMETER
    assert listed["n"].variability is Variability.CONSTANT
    assert listed["e"].start == 1.0
    assert listed["e"].items == ("low", "high")
    assert listed["b"].variability is Variability.DISCRETE
    assert listed["a"].place == listed["der(x)"].place
    assert listed["a"].reference != listed["der(x)"].reference
    assert listed["der(x)"].derivative_of == listed["x"].reference
    assert listed["der(der(x))"].derivative_of == listed["der(x)"].reference
    assert listed["minus"].place not in {each.place for each in listed.values() if each.name != "minus"}


def test_a_start_is_refused_for_what_cannot_be_set_and_a_parameter_needs_a_value() -> None:
    made = Maker()
    made.parameter("p", None)
    made.variable("y", is_output=True)
    made.put("outputs", explicit("y", made.graph.variable("p")))
    with pytest.raises(DseError, match="parameter 'p' has no value"):
        variables(made.solved())
    with pytest.raises(DseError, match="'y' cannot be given a start"):
        variables(made.solved(), {"p": 1.0, "y": 2.0})
    with pytest.raises(DseError, match="the model has no variable 'q'"):
        variables(made.solved(), {"p": 1.0, "q": 2.0})
    with pytest.raises(DseError, match="not a finite number"):
        variables(made.solved(), {"p": math.nan})


def test_a_variable_that_nothing_computes_is_refused() -> None:
    made = Maker()
    made.variable("y", is_output=True)
    with pytest.raises(DseError, match="nothing computes the variable 'y'"):
        variables(made.solved())


def test_negated_aliases_and_those_of_time_get_places_of_their_own(emitted: Emitter) -> None:
    made = Maker()
    made.variable("u", Role.INPUT)
    for name in ("minus", "now"):
        made.variable(name, is_output=True)
    made.aliases = {"minus": (Symbol("u"), -1), "now": (Symbol(referent=Referent.TIME), 1)}
    model = emitted(made.solved())
    model.set({Symbol("u"): 3.0})
    model.library.test_time(2.5)
    model.call("aliases")
    v = model.doubles("v")
    assert (v[model.own["minus"]], v[model.own["now"]]) == (-3.0, 2.5)


@pytest.mark.thorough
def test_a_model_of_hundreds_of_equations_becomes_several_functions_with_the_same_result(emitted: Emitter) -> None:
    made = Maker()
    graph = made.graph
    last = made.variable("u", Role.INPUT)
    blocks: list[Block] = []
    for number in range(1200):
        new = made.variable(f"x{number}")
        blocks.append(explicit(f"x{number}", graph.make("sin", last + float(number)) + graph.make("abs", last) * 0.5))
        last = new
    made.put("outputs", *blocks)
    model = emitted(made.solved(), "-O0")
    model.set({Symbol("u"): 0.3})
    assert model.call("outputs") == 0
    value = 0.3
    for number in range(1200):
        value = math.sin(value + number) + abs(value) * 0.5
    assert model.get(Symbol("x1199")) == value


def test_an_if_in_an_if_as_deep_as_you_like_is_translated_without_recursion(emitted: Emitter) -> None:
    made = Maker()
    graph = made.graph
    u = made.variable("u", Role.INPUT)
    made.variable("y", is_output=True)
    value = graph.constant(-1.0)
    for number in range(120):
        truth = graph.make("less", u, graph.constant(120.0 - number))
        value = graph.make("if", truth, graph.make("exp", u * (1.0 / (number + 1))), value + 1.0)
    made.put("outputs", explicit("y", value))
    model = emitted(made.solved(), "-O0")
    model.set({Symbol("u"): 60.5})
    assert model.call("outputs") == 0
    expected = -1.0
    for number in range(120):
        expected = math.exp(60.5 * (1.0 / (number + 1))) if 120.0 - number > 60.5 else expected + 1.0
    assert model.get(Symbol("y")) == expected


def test_the_nominal_value_of_a_state_is_its_scale(emitted: Emitter) -> None:
    made = Maker()
    p = made.parameter("p", 50.0)
    made.variable("x", nominal=p * 2.0)
    made.variable("z")
    made.states += [Symbol("x"), Symbol("z")]
    made.put("derivatives", explicit("x", p, 1), explicit("z", p, 1))
    model = emitted(made.solved())
    assert [model.double("nominal", k) for k in (0, 1)] == [100.0, 1.0]
