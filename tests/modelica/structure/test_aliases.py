from __future__ import annotations

import pytest
from modelica.structure.interpreter import Building, Machine, symbol

from dse.errors import DseError
from dse.graphs import components, joined
from dse.modelica.flat_model import Relation
from dse.modelica.structure.graphs import Matching
from dse.modelica.structure.solve import solve


def test_chains_of_equal_and_opposite_variables_have_one_representative() -> None:
    b = Building()
    x, y, z, w = b.reals("x y z w")
    b.equal(b.der("z"), 1.0 - z)
    b.equal(x, -y)
    b.equal(y + z, 0.0)
    b.equal(0.0 - w, x)
    solved = solve(b.flat())
    assert solved.aliases == {"x": (symbol("z"), 1), "y": (symbol("z"), -1), "w": (symbol("z"), -1)}
    assert len(solved.derivatives) == 1


def test_an_input_is_kept_rather_than_what_equals_it() -> None:
    b = Building()
    u, x, y = b.input("u"), b.real("x"), b.real("y", is_output=True)
    b.equal(x, u)
    b.equal(y, -x)
    solved = solve(b.flat())
    assert solved.aliases == {"x": (symbol("u"), 1), "y": (symbol("u"), -1)}
    assert solved.dependencies == {"y": {"u"}}


def test_two_inputs_cannot_be_equal() -> None:
    b = Building()
    u, v = b.input("u"), b.input("v")
    x = b.real("x")
    b.equal(x, u)
    b.equal(x, v)
    with pytest.raises(DseError):
        solve(b.flat())


def test_a_variable_that_is_opposite_to_itself_is_zero() -> None:
    b = Building()
    x, y, z = b.reals("x y z")
    b.equal(x, y)
    b.equal(x, -y)
    b.equal(z, x + 1.0)
    machine = Machine(solve(b.flat()))
    machine.start()
    machine.run(machine.solved.outputs)
    assert (machine.value("x"), machine.value("z")) == (0.0, 1.0)


def test_the_same_equation_twice_is_refused() -> None:
    b = Building()
    x, y = b.reals("x y")
    b.equal(x, y)
    b.equal(y, x)
    with pytest.raises(DseError, match="contains no unknown"):
        solve(b.flat())


def test_numbers_spread_and_have_no_derivative() -> None:
    b = Building()
    ground, v, x = b.real("ground"), b.real("v"), b.real("x", start=2.0, is_fixed=True)
    b.equal(ground, 0.0)
    b.equal(v, x - ground)
    b.equal(b.der("x"), b.der("ground") - v)
    solved = solve(b.flat())
    assert solved.aliases == {"v": (symbol("x"), 1)}
    machine = Machine(solved)
    machine.start()
    assert machine.value("ground") == 0.0


def test_a_fixed_start_that_contradicts_a_number_is_refused() -> None:
    b = Building()
    x = b.real("x", start=2.0, is_fixed=True)
    b.equal(x, 3.0)
    with pytest.raises(DseError, match="'x' starts fixed at 2, but the equations make it 3"):
        solve(b.flat())


def test_flows_that_cancel_are_not_taken_for_unknowns() -> None:
    b = Building()
    i, j, k, u = b.reals("i j k u")
    b.equal(j, -i)
    b.equal((i + k) + j, 0.0)
    b.equal(u, 2.0 * i + b.time)
    b.equal(u, 5.0 + k)
    machine = Machine(solve(b.flat()))
    machine.start()
    machine.run(machine.solved.outputs)
    assert machine.value("k") == 0.0
    assert machine.value("i") == 2.5


def test_relations_speak_of_kept_variables_only() -> None:
    b = Building()
    x, y = b.real("x", start=1.0, is_fixed=True), b.real("y")
    b.equal(b.der("x"), -x)
    b.equal(y, -x)
    b.relations = [Relation(b.graph.make("greater", y, b.graph.constant(-0.5)))]
    (relation,) = solve(b.flat()).flat.relations
    assert relation.truth.operands[0] is -x


def test_a_divisor_that_starts_at_zero_is_avoided() -> None:
    b = Building()
    r, g = b.parameter("r", 0.0), b.parameter("g", 2.0)
    u, i, v = b.reals("u i v")
    b.equal(u, r * i)
    b.equal(i, g * v)
    b.equal(v, 3.0 - u)
    machine = Machine(solve(b.flat()))
    machine.start()
    machine.run(machine.solved.outputs)
    assert (machine.value("u"), machine.value("i")) == (0.0, 6.0)


def test_a_matching_moves_what_stands_in_the_way() -> None:
    matching = Matching()
    columns = [[0], [0, 1], [1, 2], [2]]
    assert not any(matching.match(row, columns) for row in range(3))
    assert matching.column_of == {0: 0, 1: 1, 2: 2}
    assert matching.match(3, columns) == {0, 1, 2, 3}


def test_components_come_after_what_they_need() -> None:
    assert components([[1], [2], [1], [0, 2], []]) == [[1, 2], [0], [3], [4]]


def test_what_shares_an_element_is_joined_by_way_of_others() -> None:
    assert joined(["ab", "c", "bd", "", "ec", "d"]) == [[0, 2, 5], [1, 4], [3]]


def test_a_chain_longer_than_any_recursion_is_sorted() -> None:
    count = 20_000
    needs = [[k + 1] for k in range(count - 1)] + [[]]
    assert [one[0] for one in components(needs)] == list(range(count - 1, -1, -1))
    ring = [[(k + 1) % count] for k in range(count)]
    assert components(ring) == [list(range(count))]
