"""The engine against brute force over all combinations, with a diagram and without."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, strategies as st
from question_spaces import EXAMPLES, asked, listed, without_diagram

from dse.errors import DseError


def engines(found):
    return (found.engine, without_diagram(found.engine))


@EXAMPLES
@given(asked())
def test_what_is_listed_is_what_is_valid_and_is_counted(found):
    wanted = sorted(map(tuple, found.rows[found.valid()].tolist()))
    for engine in engines(found):
        assert sorted(listed(engine)) == wanted
        tally = engine.count()
        assert tally.exact
        assert tally.value == engine.exactly() == len(wanted)
        assert engine.is_empty() == (not wanted)
    assert list(listed(found.engine)) == wanted


@EXAMPLES
@given(asked())
def test_the_first_row_and_the_drawn_rows_are_valid(found):
    wanted = set(map(tuple, found.rows[found.valid()].tolist()))
    for engine in engines(found):
        row = engine.first()
        assert (row is None) == (not wanted)
        if not wanted:
            with pytest.raises(DseError, match="no valid configuration"):
                engine.sample(3, 1)
            continue
        assert tuple(row.tolist()) in wanted
        drawn = engine.sample(5, 1)
        assert len(drawn) == 5
        assert set(map(tuple, drawn.tolist())) <= wanted
        assert (engine.sample(5, 1) == drawn).all()


@EXAMPLES
@given(asked())
def test_the_shares_are_those_of_the_list(found):
    rows = found.rows[found.valid()]
    for engine in engines(found):
        if not len(rows):
            with pytest.raises(DseError, match="no valid configuration"):
                engine.shares()
            continue
        shares = engine.shares()
        for number, variable in enumerate(engine.flat.variables):
            length = len(variable.values) + 1
            times = np.bincount(rows[:, number] % length, minlength=length)
            if not shares.half_widths[number].any():
                assert np.allclose(shares.shares[number], times / len(rows))
            else:
                assert (shares.shares[number][times == 0] == 0).all()


@EXAMPLES
@given(asked(), st.integers(0, 4), st.integers(0, 3))
def test_a_constraint_never_adds_a_configuration(found, start, step):
    owners = range(len(found.space.constraints))
    fewer, more = owners[:start], owners[: start + step]
    assert found.engine.only(more).count().value <= found.engine.only(fewer).count().value
    assert found.engine.only(more).count().value == found.holds[:, list(more)].all(axis=1).sum()
