from __future__ import annotations

from itertools import islice

import numpy as np
import pytest

from dse.space.flat import Clause, FlatSpace, Linear, Table, Variable
from dse.space.methods.budget import TooMuchError
from dse.space.methods.listing.search import first, rows

ONE = np.array([False, True, False])


def switches(number: int) -> FlatSpace:
    return FlatSpace("switches", tuple(Variable(f"s{n}", ("off", "on")) for n in range(number)), (), ())


def pigeons(number: int) -> FlatSpace:
    """Each of *number* + 1 pigeons in one of *number* holes, no two in the same: impossible, and hard to see."""
    holes = tuple(f"h{n}" for n in range(number))
    flat = FlatSpace("pigeons", tuple(Variable(f"p{n}", holes) for n in range(number + 1)), (), ())
    apart = ~np.eye(number + 1, dtype=np.bool_)
    return flat.having(*(Table((a, b), apart) for b in range(number + 1) for a in range(b)))


def test_rules_across_a_thousand_switches_need_no_diagram() -> None:
    flat = switches(1000)
    crossed = [Clause(((n, ~ONE), (999 - n, ONE))) for n in range(500)]
    row = next(islice(rows(flat.having(*crossed, Clause(((0, ONE), (1, ONE))))), 3, None))
    assert row[1] == row[998] == 1
    assert row[0] == 0


def test_a_literal_that_is_left_alone_must_hold() -> None:
    flat = switches(3).having(Clause(((0, ONE), (1, ONE), (2, ONE))), Linear({0: np.array([0, 5, 0])}, None, 4))
    assert [tuple(row.tolist()) for row in rows(flat)] == [(0, 0, 1), (0, 1, 0), (0, 1, 1)]


def test_a_space_proven_empty_has_no_first_row() -> None:
    assert first(pigeons(4)) is None


def test_more_work_than_allowed_is_refused() -> None:
    with pytest.raises(TooMuchError):
        first(pigeons(6), most_nodes=50)


def test_a_rule_that_allows_nothing_empties_the_space() -> None:
    assert first(switches(2).having(Table((), np.array(False)))) is None
