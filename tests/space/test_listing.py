from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from itertools import islice

import numpy as np
import pytest

from dse.domain.design import Constraint
from dse.domain.expression import Expression, Truth
from dse.space.flat import FlatSpace, Linear, Table, Variable
from dse.space.methods.listing.blocks import blocks, first
from dse.space.methods.mdd.diagram import compile_diagram


def places(number: int, values: int) -> FlatSpace:
    names = tuple(f"v{value}" for value in range(values))
    return FlatSpace("places", tuple(Variable(f"p{n}", names) for n in range(number)), (), ())


def each(flat: FlatSpace, weight: int = 1) -> dict[int, np.ndarray]:
    """The value numbers, times *weight*."""
    return {
        number: weight * np.array([*range(len(variable.values)), 0], np.int64)
        for number, variable in enumerate(flat.variables)
    }


def test_the_first_blocks_of_a_huge_space_are_small_and_later_ones_full() -> None:
    sizes = [len(rows) for rows in islice(blocks(compile_diagram(places(60, 6)), 4096), 12)]
    assert sizes[0] <= 256
    assert sizes[-1] > 2048
    assert max(sizes) <= 4096


def test_a_space_without_decisions_has_one_empty_row() -> None:
    assert [rows.shape for rows in blocks(compile_diagram(places(0, 1)))] == [(1, 0)]


def test_rows_far_from_any_random_one_are_found() -> None:
    flat = places(60, 6)
    flat = flat.having(Linear(each(flat), None, 2), Linear(each(flat), 2, None))
    rows = np.concatenate(list(blocks(compile_diagram(flat))))
    assert len(rows) == 60 + 60 * 59 // 2
    assert (rows.sum(axis=1) == 2).all()


def test_bounds_that_contradict_each_other_prove_a_huge_space_empty() -> None:
    flat = places(60, 6)
    flat = flat.having(Linear(each(flat), None, 149), Linear(each(flat), 150, None))
    diagram = compile_diagram(flat)
    assert first(diagram) is None
    assert list(blocks(diagram)) == []


def test_sums_too_large_for_fast_arithmetic_are_still_exact() -> None:
    flat = places(4, 3)
    most = 1 << 58
    flat = flat.having(Linear(each(flat, most), 7 * most, 7 * most + 1))
    rows = np.concatenate(list(blocks(compile_diagram(flat))))
    assert sorted(map(tuple, rows.tolist())) == sorted({(1, 2, 2, 2), (2, 1, 2, 2), (2, 2, 1, 2), (2, 2, 2, 1)})


def test_a_row_that_breaks_a_constraint_is_never_listed_but_reported_by_its_name() -> None:
    flat = places(2, 2)
    constraint = Constraint("twins", Expression("true", Truth(True, (0, 4))))
    strict = FlatSpace(flat.name, flat.variables, (constraint,), (Table((0, 1), np.eye(3, dtype=np.bool_), 0),))
    faulty = replace(compile_diagram(flat), flat=strict)
    with pytest.raises(RuntimeError, match="constraint 'twins'"):
        list(blocks(faulty))


def test_the_scale_of_a_sum_does_not_matter() -> None:
    flat = places(3, 3)
    rules = [Linear(each(flat), 2, 3, scale=scale) for scale in (Fraction(1), Fraction(1, 1000))]
    listed = [np.concatenate(list(blocks(compile_diagram(flat.having(rule))))).tolist() for rule in rules]
    assert listed[0] == listed[1]
