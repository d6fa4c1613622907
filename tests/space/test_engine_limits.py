"""What the engine does where there is nothing, and where there is too much."""

from __future__ import annotations

import numpy as np
import pytest

from dse.errors import DseError
from dse.space.flat import FlatSpace, Linear, Table, Variable
from dse.space.methods import enumeration
from dse.space.methods.engine import Engine
from dse.space.methods.sampling.tilt import TooRareError
from dse.space.methods.tally import Tally


def coins(number, *rules):
    return FlatSpace("coins", tuple(Variable(f"c{i}", ("no", "yes")) for i in range(number)), (), rules)


def heads(number, low, high):
    return Linear({i: np.array([0, 1, 0], np.int64) for i in range(number)}, low, high)


def never(*_args, **_kwargs):
    raise AssertionError("asked for nothing")


def too_rare(*_args, **_kwargs):
    raise TooRareError


def test_what_a_bound_proves_empty_is_neither_expanded_nor_counted(monkeypatch):
    monkeypatch.setattr("dse.space.methods.mdd.expand.expand", never)
    monkeypatch.setattr("dse.space.methods.grid.exact.exact_count", never)
    assert Engine(coins(40, heads(40, None, 15), heads(40, 18, None))).count() == Tally(0)


def test_rows_to_draw_from_are_kept_up_to_so_many_decisions(monkeypatch):
    monkeypatch.setattr("dse.space.methods.sampling.sample.sample", too_rare)
    space = coins(10, heads(10, 1, 1))
    monkeypatch.setattr(enumeration, "_KEPT_CELLS", 100)
    assert Engine(space).sample(5).sum(axis=1).tolist() == [1] * 5
    monkeypatch.setattr(enumeration, "_KEPT_CELLS", 99)
    with pytest.raises(DseError, match="too rare to be drawn"):
        Engine(space).sample(5)


def test_a_narrowed_engine_compiles_nothing_before_it_is_asked(monkeypatch):
    monkeypatch.setattr("dse.space.methods.mdd.ordering.compile_best", never)
    engine = Engine(coins(3, Table((0, 1), np.ones((3, 3), np.bool_), 0)))
    assert engine.only([]).flat.rules == ()
