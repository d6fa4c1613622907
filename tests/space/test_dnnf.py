"""The decision-DNNF against counting by hand, on small random spaces of every construct it takes."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from dse.space.flat import ABSENT, Bools, Clause, FlatSpace, Fold, Gather, Linear, Rows, Rule, Table, Variable, Wide
from dse.space.methods.dnnf.cnf import MOST_STATES
from dse.space.methods.dnnf.compile import compile_dnnf
from dse.space.methods.dnnf.queries import count, occurrences
from dse.space.methods.dnnf.rows import rows, sample
from dse.space.methods.dnnf.trim import UnsupportedError, trim
from dse.space.methods.mdd.growth import TooWideError
from dse.space.methods.solver.answers import conflict, first


def space(variables: list[Variable], *rules: Rule) -> FlatSpace:
    return FlatSpace("test", tuple(variables), (), rules)


def choice(name: str, values: int, parent: tuple[int, int] | None = None, optional: bool = False) -> Variable:
    left_out: tuple[str | None, ...] = (None,) if optional else ()
    return Variable(name, (*(f"{name}{value}" for value in range(values)), *left_out), parent)


def holds(rule: Rule, row: tuple[int, ...]) -> bool:
    match rule:
        case Table():
            return bool(rule.allowed[tuple(row[number] for number in rule.scope)])
        case Clause():
            return any(bool(mask[row[number]]) for number, mask in rule.literals)
        case Linear():
            total = sum(int(weights[row[number]]) for number, weights in rule.weights.items())
            return (rule.low is None or rule.low <= total) and (rule.high is None or total <= rule.high)
        case _:
            raise TypeError(rule)


def every_row(flat: FlatSpace) -> list[tuple[int, ...]]:
    def exists(row: tuple[int, ...], variable: Variable) -> bool:
        return variable.parent is None or row[variable.parent[0]] == variable.parent[1]

    ranges = [range(ABSENT, len(variable.values)) for variable in flat.variables]
    return [
        row
        for row in product(*ranges)
        if all((value != ABSENT) == exists(row, variable) for value, variable in zip(row, flat.variables, strict=True))
        and all(holds(rule, row) for rule in flat.rules)
    ]


def listed(found: Rows) -> list[tuple[int, ...]]:
    return [tuple(row) for row in found.tolist()]


@st.composite
def masks(draw: st.DrawFn, variable: Variable) -> Bools:
    size = len(variable.values) + 1
    return np.array(draw(st.lists(st.booleans(), min_size=size, max_size=size)))


@st.composite
def rule_of(draw: st.DrawFn, variables: list[Variable], owner: int) -> Rule:
    numbers = draw(st.sets(st.integers(0, len(variables) - 1), min_size=1, max_size=min(4, len(variables))))
    scope = tuple(sorted(numbers))
    kind = draw(st.sampled_from(["table", "clause", "clause", "linear"]))
    if kind == "clause":
        return Clause(tuple((number, draw(masks(variables[number]))) for number in scope), owner)
    if kind == "linear":
        weights = {
            number: np.array([*(draw(st.integers(-1, 2)) for _ in variables[number].values), 0], np.int64)
            for number in scope
        }
        low = draw(st.none() | st.integers(-2, 3))
        high = draw(st.none() | st.integers(0, 4))
        return Linear(weights, low, high, owner)
    shape = tuple(len(variables[number].values) + 1 for number in scope[:3])
    random = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    return Table(scope[:3], random.random(shape) < draw(st.sampled_from([0.3, 0.7, 0.9])), owner)


@st.composite
def spaces(draw: st.DrawFn) -> FlatSpace:
    variables: list[Variable] = []
    for number in range(draw(st.integers(1, 6))):
        parents = [
            (above, value)
            for above, variable in enumerate(variables)
            for value, name in enumerate(variable.values)
            if name is not None
        ]
        parent = draw(st.none() | st.sampled_from(parents)) if parents else None
        variables.append(choice(f"v{number}", draw(st.integers(1, 3)), parent, draw(st.booleans())))
    rules = [draw(rule_of(variables, owner)) for owner in range(draw(st.integers(0, 4)))]
    return space(variables, *rules)


@given(spaces())
def test_the_list_is_the_rows_of_brute_force(flat: FlatSpace) -> None:
    found = [row for block in rows(compile_dnnf(flat)) for row in listed(block)]
    assert sorted(found) == every_row(flat)


@given(spaces())
def test_count_and_occurrences_are_those_of_brute_force(flat: FlatSpace) -> None:
    dnnf = compile_dnnf(flat)
    expected = every_row(flat)
    assert count(dnnf) == len(expected)
    amounts = occurrences(dnnf)
    for number, variable in enumerate(flat.variables):
        counted = [sum(row[number] == value for row in expected) for value in [*range(len(variable.values)), ABSENT]]
        assert list(amounts[number]) == counted


@given(spaces())
def test_the_solver_finds_a_row_iff_there_is_one(flat: FlatSpace) -> None:
    row = first(flat)
    expected = every_row(flat)
    assert (row is not None) == bool(expected)
    assert row is None or tuple(row.tolist()) in expected
    start = next(rows(compile_dnnf(flat)), None)
    assert (start is not None) == bool(expected)


@settings(max_examples=400)  # most small spaces have a row, and then there is nothing to blame
@given(spaces())
def test_a_conflict_has_no_row_and_loses_it_with_any_of_its_members(flat: FlatSpace) -> None:
    blamed = conflict(flat)
    assert (blamed is None) == bool(every_row(flat))
    if blamed is None:
        return
    assert not every_row(flat.only(blamed))
    for owner in blamed:
        assert every_row(flat.only([other for other in blamed if other != owner]))


def test_every_row_is_drawn_equally_often() -> None:
    flat = space(
        [choice("a", 3), choice("b", 2, (0, 0), optional=True), choice("c", 4, (0, 1)), choice("d", 2, optional=True)],
        Clause(((0, np.array([True, True, False, False])), (3, np.array([False, True, True, False])))),
    )
    expected = every_row(flat)
    drawn = listed(sample(compile_dnnf(flat), 20_000, seed=4))
    mean = len(drawn) / len(expected)
    chi_square = sum((drawn.count(row) - mean) ** 2 / mean for row in expected)
    freedom = len(expected) - 1
    # 4.5 standard deviations of the statistic; a wrong share of one row in fifty would exceed it by far.
    assert abs(chi_square - freedom) < 4.5 * (2 * freedom) ** 0.5
    assert set(drawn) == set(expected)


def test_samples_are_the_same_for_a_seed() -> None:
    dnnf = compile_dnnf(space([choice(f"v{number}", 3) for number in range(40)]))
    assert np.array_equal(sample(dnnf, 50, 7), sample(dnnf, 50, 7))
    assert not np.array_equal(sample(dnnf, 50, 7), sample(dnnf, 50, 8))


def test_what_no_rule_looks_at_never_reaches_the_clauses() -> None:
    mask = np.array([True, False, False, False])
    flat = space([choice("seen", 3), choice("under", 3, (0, 2)), choice("apart", 3)], Clause(((0, mask),)))
    trimmed = trim(flat)
    assert trimmed.kept == (0,)
    assert trimmed.classes == (((0,), (1, 2)),)
    assert count(compile_dnnf(space(list(flat.variables)))) == (2 + 3) * 3


@pytest.mark.thorough
def test_two_thousand_free_decisions_are_counted_and_listed() -> None:
    size = 2_000
    pairs = [
        Clause(((number, np.array([True, False, False])), (number + 1, np.array([False, True, False]))))
        for number in range(0, size, 2)
    ]
    dnnf = compile_dnnf(space([choice(f"v{number}", 2) for number in range(size)], *pairs))
    total = count(dnnf)
    assert total == 3 ** (size // 2)
    blocks = [block for block, _ in zip(rows(dnnf), range(9), strict=False)]
    assert len({tuple(row) for block in blocks for row in listed(block)}) == sum(map(len, blocks)) > 10_000


def test_many_values_of_a_decision_stay_one_to_one_with_models() -> None:
    size = 60
    other = Table((0, 1), np.tri(size + 1, size + 1, dtype=bool))
    dnnf = compile_dnnf(space([choice("a", size), choice("b", size)], other))
    assert count(dnnf) == size * (size + 1) // 2


def test_k_of_n_is_counted_as_binomials_say() -> None:
    numbers = range(12)
    weights = {number: np.array([1, 0, 0], np.int64) for number in numbers}
    flat = space([choice(f"v{number}", 1, optional=True) for number in numbers], Linear(weights, 3, 4))
    assert count(compile_dnnf(flat)) == 220 + 495


def test_a_sum_of_many_distinct_values_is_refused_by_its_owner() -> None:
    weights = {number: np.array([3**number, 0, 0], np.int64) for number in range(12)}
    flat = space([choice(f"v{number}", 2) for number in range(12)], Linear(weights, 1000, 90_000, owner=7))
    assert MOST_STATES < 2**11
    with pytest.raises(UnsupportedError, match="rule 7"):
        compile_dnnf(flat)


def test_a_wide_rule_is_refused_by_its_owner() -> None:
    class Never:
        def bounds(self, low: object, high: object) -> tuple[Bools, Bools]:
            raise AssertionError

        def holds(self, folds: object) -> bool:
            raise AssertionError

    fold = Fold(Gather.PRODUCT, {0: np.array([2, 3, 1], np.int64)}, 1)
    with pytest.raises(UnsupportedError, match="rule 3"):
        compile_dnnf(space([choice("a", 2)], Wide((fold,), Never(), owner=3)))


def test_too_many_components_are_refused() -> None:
    random = np.random.default_rng(1)
    clauses = [
        Clause(tuple((int(n), np.array([*np.eye(2, dtype=bool)[random.integers(2)], False])) for n in sorted(scope)))
        for scope in (random.choice(40, 3, replace=False) for _ in range(80))
    ]
    with pytest.raises(TooWideError):
        compile_dnnf(space([choice(f"v{number}", 2) for number in range(40)], *clauses), most_nodes=5)


@given(spaces(), st.integers(0, 300))
def test_a_sample_starts_with_the_rows_of_a_smaller_one(flat: FlatSpace, number: int) -> None:
    dnnf = compile_dnnf(flat)
    assert listed(sample(dnnf, 300, 5))[:number] == listed(sample(dnnf, number, 5))
