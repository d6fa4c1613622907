from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from paths import contains

from dse.space.flat import ABSENT, Bools, Clause, FlatSpace, Table, Variable
from dse.space.methods.mdd.diagram import (
    compile_diagram,
    completions,
    count,
    extremes,
    occurrences,
    restrict,
)
from dse.space.methods.mdd.growth import TooWideError

EVERYTHING = settings(max_examples=120, deadline=None)


def named(values: int) -> tuple[str, ...]:
    return tuple(f"v{value}" for value in range(values))


def brute_force(space: FlatSpace) -> set[tuple[int, ...]]:
    rows = set()
    for row in product(*(range(-1, len(variable.values)) for variable in space.variables)):
        exists = [v.parent is None or row[v.parent[0]] == v.parent[1] for v in space.variables]
        if all(there == (value != ABSENT) for there, value in zip(exists, row, strict=True)) and all(
            bool(rule.allowed[tuple(row[number] for number in rule.scope)])
            if isinstance(rule, Table)
            else any(mask[row[number]] for number, mask in rule.literals)
            for rule in (*space.tables(), *space.clauses())
        ):
            rows.add(row)
    return rows


def masks(size: int) -> st.SearchStrategy[Bools]:
    return st.lists(st.booleans(), min_size=size, max_size=size).map(lambda bits: np.array(bits, np.bool_))


@st.composite
def spaces(draw: st.DrawFn) -> FlatSpace:
    variables: list[Variable] = []
    for number in range(draw(st.integers(0, 6))):
        parent = None
        candidates = [n for n, v in enumerate(variables) if v.values]
        if candidates and draw(st.booleans()):
            above = draw(st.sampled_from(candidates))
            parent = above, draw(st.integers(0, len(variables[above].values) - 1))
        variables.append(Variable(f"x{number}", named(draw(st.integers(0 if number == 5 else 1, 3))), parent))
    rules: list[Table | Clause] = []
    for _ in range(draw(st.integers(0, 5))):
        scope = (
            tuple(sorted(draw(st.sets(st.integers(0, max(0, len(variables) - 1)), max_size=4)))) if variables else ()
        )
        sizes = [len(variables[number].values) + 1 for number in scope]
        if draw(st.booleans()):
            # Mostly allowed: otherwise nearly every space is empty.
            forbidden = draw(st.lists(st.tuples(*(st.integers(0, size - 1) for size in sizes)), max_size=6))
            allowed = np.ones(sizes, np.bool_)
            for entry in forbidden:
                allowed[entry] = False
            rules.append(Table(scope, allowed))
        elif scope:
            rules.append(Clause(tuple((number, draw(masks(size))) for number, size in zip(scope, sizes, strict=True))))
    return FlatSpace("random", tuple(variables), (), tuple(rules))


def orders(space: FlatSpace, draw: st.DrawFn) -> tuple[int, ...]:
    """Any order with parents first."""
    place = draw(st.permutations(range(len(space.variables))))
    order: list[int] = []
    for number in place:
        chain = [number]
        while (parent := space.variables[chain[-1]].parent) is not None:
            chain.append(parent[0])
        order += [above for above in reversed(chain) if above not in order]
    return tuple(order)


@EVERYTHING
@given(spaces(), st.data())
def test_the_paths_are_the_rows_that_meet_hierarchy_tables_and_clauses(space: FlatSpace, data: st.DataObject) -> None:
    rows = brute_force(space)
    for order in (None, orders(space, data.draw)):
        diagram = compile_diagram(space, order)
        assert count(diagram) == len(rows)
        assert diagram.empty == (not rows)
        for row in product(*(range(-1, len(variable.values)) for variable in space.variables)):
            assert contains(diagram, row) == (row in rows)


@EVERYTHING
@given(spaces(), st.data())
def test_every_node_is_alive_reachable_and_different_from_the_others(space: FlatSpace, data: st.DataObject) -> None:
    diagram = compile_diagram(space, orders(space, data.draw))
    assert len(diagram.layers) == len(space.variables)
    if diagram.empty:
        assert not any(len(layer) for layer in diagram.layers)
        return
    reached = {0}
    for depth, layer in enumerate(diagram.layers):
        after = len(diagram.layers[depth + 1]) if depth + 1 < len(diagram.layers) else 1
        assert reached == set(range(len(layer)))
        assert (layer >= 0).any(axis=1).all()
        assert layer.max() < after
        assert len({tuple(node) for node in layer.tolist()}) == len(layer)
        reached = set(layer[layer >= 0].tolist())


@EVERYTHING
@given(spaces())
def test_spaces_with_the_same_rows_have_the_same_layers(space: FlatSpace) -> None:
    # One table over everything says the same as all the rules.
    everything = np.zeros([len(variable.values) + 1 for variable in space.variables], np.bool_)
    for row in brute_force(space):
        everything[row] = True
    table = Table(tuple(range(len(space.variables))), everything)
    one, other = (compile_diagram(s) for s in (space, FlatSpace("table", space.variables, (), (table,))))
    assert all(np.array_equal(a, b) for a, b in zip(one.layers, other.layers, strict=True))
    assert one.empty == other.empty


@EVERYTHING
@given(spaces())
def test_occurrences_count_the_rows_of_every_value(space: FlatSpace) -> None:
    rows = brute_force(space)
    expected = tuple(
        tuple(sum(row[number] == value for row in rows) for value in [*range(len(variable.values)), ABSENT])
        for number, variable in enumerate(space.variables)
    )
    assert occurrences(compile_diagram(space)) == expected


@EVERYTHING
@given(spaces(), st.data())
def test_restricting_is_compiling_with_the_masks_as_rules(space: FlatSpace, data: st.DataObject) -> None:
    wanted = {
        number: data.draw(masks(len(variable.values) + 1))
        for number, variable in enumerate(space.variables)
        if data.draw(st.booleans())
    }
    narrowed = restrict(compile_diagram(space), wanted)
    again = compile_diagram(space.having(*(Table((number,), mask) for number, mask in wanted.items())))
    assert narrowed.empty == again.empty
    assert all(np.array_equal(a, b) for a, b in zip(narrowed.layers, again.layers, strict=True))


@EVERYTHING
@given(spaces(), st.data())
def test_extremes_bound_the_sums_of_all_rows(space: FlatSpace, data: st.DataObject) -> None:
    weights = {
        number: np.array([*data.draw(st.lists(st.integers(-9, 9), min_size=len(v.values), max_size=len(v.values))), 0])
        for number, v in enumerate(space.variables)
        if data.draw(st.booleans())
    }
    low, high = extremes(compile_diagram(space), weights)
    sums = [sum(int(weight[row[number]]) for number, weight in weights.items()) for row in brute_force(space)]
    assert low[0].tolist() == ([min(sums)] if sums else [])
    assert high[0].tolist() == ([max(sums)] if sums else [])
    assert low[-1].tolist() == high[-1].tolist() == ([0] if sums else [])


def test_a_space_without_decisions_has_one_row_unless_nothing_is_allowed() -> None:
    nothing_to_decide = FlatSpace("none", (), (), ())
    assert count(compile_diagram(nothing_to_decide)) == 1
    assert count(compile_diagram(nothing_to_decide.having(Table((), np.array(False))))) == 0


def test_counts_are_exact_beyond_machine_integers() -> None:
    space = FlatSpace("wide", tuple(Variable(f"x{n}", named(7)) for n in range(400)), (), ())
    diagram = compile_diagram(space)
    assert count(diagram) == 7**400
    assert occurrences(diagram)[399] == (7**399,) * 7 + (0,)
    assert [int(numbers[0]) for numbers in completions(diagram)][:2] == [7**400, 7**399]


def test_more_pending_rules_than_a_machine_word_has_bits_stay_exact() -> None:
    # x0..x79 must equal y0..y79, and only one of the x may be chosen: 80 rules pend at the middle.
    pairs = 80
    variables = tuple(Variable(f"{name}{n}", named(2)) for name in "xy" for n in range(pairs))
    equal = np.eye(3, dtype=np.bool_)
    at_most_one = np.array([[True, True, False], [True, False, False], [False, False, False]])
    rules = [Table((n, pairs + n), equal) for n in range(pairs)]
    rules += [Table((n, m), at_most_one) for m in range(pairs) for n in range(m)]
    assert count(compile_diagram(FlatSpace("pairs", variables, (), tuple(rules)))) == pairs + 1


def test_a_diagram_that_grows_too_wide_is_given_up() -> None:
    pairs = 40
    variables = tuple(Variable(f"{name}{n}", named(2)) for name in "xy" for n in range(pairs))
    rules = tuple(Table((n, pairs + n), np.eye(3, dtype=np.bool_)) for n in range(pairs))
    space = FlatSpace("pairs", variables, (), rules)
    with pytest.raises(TooWideError):
        compile_diagram(space, most_nodes=10_000)
    assert count(compile_diagram(space, [n for k in range(pairs) for n in (k, pairs + k)], most_nodes=10_000)) == 2**40


def test_an_alternative_of_very_many_values_is_one_layer() -> None:
    variables = (Variable("x", named(300)), Variable("y", named(300)), Variable("z", named(2), (1, 299)))
    equal = np.eye(301, dtype=np.bool_)
    diagram = compile_diagram(FlatSpace("many", variables, (), (Table((0, 1), equal),)), most_nodes=3000)
    assert count(diagram) == 301


def test_an_order_must_name_every_variable_once_and_parents_first() -> None:
    space = FlatSpace("tree", (Variable("x", named(2)), Variable("y", named(2), (0, 1))), (), ())
    for order in ((0,), (0, 0), (1, 0)):
        with pytest.raises(ValueError, match="order must name"):
            compile_diagram(space, order)


def test_a_layer_expanded_in_many_blocks_is_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    draw = np.random.default_rng(7)
    variables = tuple(Variable(f"x{n}", named(4)) for n in range(12))
    rules = tuple(Table((n, n + 3), draw.random((5, 5)) < 0.7) for n in range(9))
    space = FlatSpace("blocks", variables, (), rules)
    at_once = compile_diagram(space)
    monkeypatch.setattr("dse.space.methods.mdd.growth._BLOCK", 40)
    in_blocks = compile_diagram(space)
    assert max(len(layer) for layer in at_once.layers) > 40
    assert all(np.array_equal(a, b) for a, b in zip(at_once.layers, in_blocks.layers, strict=True))
