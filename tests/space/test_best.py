from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
import pytest

from dse.errors import DseError
from dse.space.flat import FlatSpace, Fold, Gather, Ints, Linear, Variable
from dse.space.methods.budget import TooMuchError
from dse.space.methods.mdd.diagram import compile_diagram
from dse.space.methods.optimum.optimizer import best
from dse.space.methods.optimum.regions import best_valued


def places(number: int, values: int) -> FlatSpace:
    names = tuple(f"v{value}" for value in range(values))
    return FlatSpace("places", tuple(Variable(f"p{n}", names) for n in range(number)), (), ())


def each(flat: FlatSpace, weight: int = 1) -> dict[int, Ints]:
    """The value numbers, times *weight*."""
    return {
        number: weight * np.array([*range(len(variable.values)), 0], np.int64)
        for number, variable in enumerate(flat.variables)
    }


def test_of_equally_good_rows_those_come_first_that_the_list_has_first() -> None:
    flat = places(50, 8)
    nothing = {number: np.zeros(9, np.int64) for number in range(50)}
    found = best(compile_diagram(flat), nothing, 9)
    assert found.values == (0,) * 9
    assert found.rows[:, :48].max() == 0
    assert found.rows[:, 48:].tolist() == [*([0, value] for value in range(8)), [1, 0]]


def test_the_best_of_a_huge_space_keeps_its_bounds() -> None:
    flat = places(50, 8)
    flat = flat.having(Linear(each(flat), 100, 200))
    low, high = (best(compile_diagram(flat), each(flat, 3), 2, largest=largest) for largest in (False, True))
    assert low.values == (300, 300)
    assert high.values == (600, 600)
    assert low.rows[0].tolist() == [0] * 35 + [2] + [7] * 14


def test_an_objective_of_too_many_digits_is_refused() -> None:
    flat = places(3, 3)
    with pytest.raises(DseError, match="too many digits"):
        best(compile_diagram(flat), each(flat, 1 << 60), 1)


@dataclass(frozen=True)
class Product:
    """The first fold times the second, both at least 0."""

    folds: tuple[Fold, ...]

    def bounds(self, low: Sequence[Ints], high: Sequence[Ints]) -> tuple[np.ndarray, np.ndarray]:
        return low[0] * 1.0 * low[1], high[0] * 1.0 * high[1]

    def value(self, folds: Sequence[int]) -> Fraction | None:
        return Fraction(folds[0] * folds[1], 3)


def test_a_nonlinear_objective_gives_exact_values() -> None:
    flat = places(6, 5)
    rising = Fold(Gather.SUM, each(flat), 1)
    falling = Fold(Gather.SUM, {n: np.array([4, 3, 2, 1, 0, 0], np.int64) for n in range(6)}, 1)
    found = best_valued(compile_diagram(flat), Product((rising, falling)), 3, largest=True)
    assert found.values == (Fraction(13 * 13, 3),) * 3
    assert found.rows.sum(axis=1).tolist() == [12] * 3


def test_a_nonlinear_optimum_out_of_reach_is_refused_not_guessed() -> None:
    flat = places(60, 8)
    rising = Fold(Gather.SUM, each(flat), 1)
    falling = Fold(Gather.SUM, {n: np.array([7, 6, 5, 4, 3, 2, 1, 0, 0], np.int64) for n in range(60)}, 1)
    with pytest.raises(TooMuchError):
        best_valued(compile_diagram(flat), Product((rising, falling)), 1, largest=True, most_rounds=20)
