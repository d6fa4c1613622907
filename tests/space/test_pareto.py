from __future__ import annotations

from functools import partial

import numpy as np
import pytest

from dse.errors import DseError
from dse.space.flat import FlatSpace, Ints, Linear, Variable
from dse.space.methods.mdd.diagram import compile_diagram
from dse.space.methods.optimum.optimizer import Optimizer
from dse.space.methods.optimum.pareto import pareto


def places(number: int) -> FlatSpace:
    return FlatSpace("places", tuple(Variable(f"p{n}", ("cheap", "light")) for n in range(number)), (), ())


def price_and_mass(number: int) -> tuple[dict[int, Ints], dict[int, Ints]]:
    return (
        {n: np.array([1, 3, 0], np.int64) for n in range(number)},
        {n: np.array([5, 4, 0], np.int64) for n in range(number)},
    )


@pytest.mark.thorough
def test_a_trade_off_gives_one_point_for_each_step() -> None:
    price, mass = price_and_mass(30)
    front = pareto(partial(Optimizer, compile_diagram(places(30))), [price, mass])
    assert front.values == tuple((30 + 2 * n, 150 - n) for n in range(31))
    assert front.rows[3].tolist() == [0] * 27 + [1] * 3


def test_constraints_cut_the_pareto_set() -> None:
    price, mass = price_and_mass(30)
    front = pareto(partial(Optimizer, compile_diagram(places(30).having(Linear(price, 40, 45)))), [price, mass])
    assert front.values == ((40, 145), (42, 144), (44, 143))


def test_objectives_that_agree_have_one_point() -> None:
    price, _ = price_and_mass(10)
    assert pareto(partial(Optimizer, compile_diagram(places(10))), [price, price, price]).values == ((10, 10, 10),)


def test_what_shall_be_largest_is_written_as_it_is() -> None:
    price, mass = price_and_mass(2)
    assert pareto(partial(Optimizer, compile_diagram(places(2))), [price, mass], [False, True]).values == ((2, 10),)


def test_too_many_points_are_refused() -> None:
    price, mass = price_and_mass(30)
    with pytest.raises(DseError, match="more than 20 configurations are Pareto-optimal"):
        pareto(partial(Optimizer, compile_diagram(places(30))), [price, mass], most_points=20)
