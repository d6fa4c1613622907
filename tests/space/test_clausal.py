"""Spaces that no diagram and no graph of all rules hold: drawn under the logical rules, or searched."""

from __future__ import annotations

import numpy as np
import pytest

from dse.errors import DseError
from dse.space.flat import FlatSpace, Linear, Table, Variable
from dse.space.methods import clausal as module
from dse.space.methods.clausal import ClausalEngine
from dse.space.methods.sampling.tilt import EmptyError
from dse.space.methods.tally import Tally

NEVER = Table((), np.array(False))


class Graphless(ClausalEngine):
    graph = None


class Opaque(Graphless):
    _logical = None


def clausal(number, *rules):
    """Yes-or-no decisions, as if their rules had no graph together."""
    return Graphless(FlatSpace("coins", tuple(Variable(f"c{i}", ("no", "yes")) for i in range(number)), (), rules))


def heads(number, low, high):
    return Linear({i: np.array([0, 1, 0], np.int64) for i in range(number)}, low, high)


def pigeons(number):
    holes = tuple(f"h{n}" for n in range(number))
    apart = ~np.eye(number + 1, dtype=np.bool_)
    rules = tuple(Table((a, b), apart) for b in range(number + 1) for a in range(b))
    return Opaque(FlatSpace("pigeons", tuple(Variable(f"p{n}", holes) for n in range(number + 1)), (), rules))


def test_nothing_is_left_where_nothing_meets_the_logical_rules():
    empty = clausal(12, NEVER, heads(12, 3, None))
    assert empty.estimate(1) == Tally(0)
    with pytest.raises(EmptyError):
        empty.sample(3, 1)


def test_an_estimate_is_of_the_share_that_meets_the_sums():
    found = clausal(12, heads(12, 6, None)).estimate(1)
    assert found.low <= 2510 <= found.high


def test_a_sample_starts_with_the_rows_of_a_smaller_one():
    large = clausal(12, heads(12, 6, None)).sample(200, 7)
    assert (large.sum(axis=1) >= 6).all()
    for number in (0, 1, 63, 64, 65):
        assert clausal(12, heads(12, 6, None)).sample(number, 7).tolist() == large[:number].tolist()


def test_what_is_never_drawn_is_searched():
    row = [1] * 20
    assert clausal(20, heads(20, 20, None)).sample(2, 1).tolist() == [row, row]


def test_a_list_that_finds_nothing_for_too_long_gives_up(monkeypatch):
    monkeypatch.setattr(module, "SEARCH_WORK", 2_000)
    with pytest.raises(DseError, match="cannot list the configurations of 'pigeons'"):
        list(pigeons(8).blocks())
    assert pigeons(8).exact_count() is None


def test_a_list_goes_on_as_long_as_it_finds_rows(monkeypatch):
    monkeypatch.setattr(module, "SEARCH_WORK", 20_000)
    blocks = list(clausal(11, heads(11, 1, None)).blocks())
    assert sum(map(len, blocks)) == 2**11 - 1
