"""Whether outputs settle as something is made finer, and how far it has to go."""

from __future__ import annotations

from math import inf

import numpy as np
import pytest

from dse.cosim.probing.convergence import grid_of, moves, settling_of

TIME = np.linspace(0.0, 1.0, 11)[:, None]


def tables(*errors: float) -> list[np.ndarray]:
    return [np.sin(3 * TIME) + error * TIME for error in errors]


@pytest.mark.parametrize("order", [1, 2, 4])
def test_an_error_of_any_order_shows_after_one_halving(order):
    found = settling_of(tables(*(0.1 * 2.0 ** (-order * k) for k in range(9))), least=1e-9)
    assert (found.at, found.place) == (1, 0)
    assert found.change > 0.0


def test_an_inner_step_shows_where_outputs_begin_to_answer():
    found = settling_of(tables(0.1, 0.1, 0.1, 0.1, 0.05, 0.025, 0.0125, 0.00625), least=1e-9)
    assert (found.at, found.place) == (4, 3)


def test_small_changes_before_a_large_one_are_not_taken_for_it():
    found = settling_of(tables(0.1, 0.1 + 1e-6, 0.1 - 1e-6, 0.05, 0.025, 0.0125), least=1e-9)
    assert found.at == 3


@pytest.mark.parametrize("errors", [(0.1, 0.11, 0.1, 0.11), (0.1, 0.2, 0.4, 0.8), (0.1, 0.1, 0.1, 0.05)])
def test_what_does_not_become_smaller_has_not_settled(errors):
    found = settling_of(tables(*errors), least=1e-9)
    assert found.reacts
    assert not found.settles


def test_rounding_is_no_answer():
    found = settling_of(tables(0.0, 1e-15, -1e-15, 2e-15), least=1e-9)
    assert not found.reacts
    assert not settling_of(tables(0.1), least=1e-9).reacts


def test_all_outputs_that_answer_have_to_settle():
    good, bad = tables(0.1, 0.05, 0.025, 0.0125), tables(0.1, 0.2, 0.1, 0.2)
    together = [np.hstack(pair) for pair in zip(good, bad, strict=True)]
    assert not settling_of(together, least=1e-9).settles


def test_outputs_that_stand_still_between_changes_have_a_grid():
    stairs = np.floor(np.arange(101) / 10)[:, None]
    assert grid_of(stairs, 0.01) == pytest.approx(0.1)
    assert grid_of(TIME, 0.1) == inf
    now_and_then = np.searchsorted([3, 20, 27, 60, 64, 90], np.arange(101))[:, None].astype(float)
    assert grid_of(now_and_then, 0.01) == inf


def test_a_first_step_is_no_movement():
    still = np.ones((5, 1))
    still[0] = 0.0
    assert not moves(still)
    assert moves(TIME)
