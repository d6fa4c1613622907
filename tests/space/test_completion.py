"""Rows that meet preferences: against all rows of small random spaces, and by the statistics of what is left open."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence

import numpy as np
import pytest
from hypothesis import assume, given, strategies as st
from question_spaces import EXAMPLES, Answers, asked, without_diagram
from scipy.stats import chisquare

from dse.space.decisions import alternatives
from dse.space.methods.completion.completion import Completion, DiagramCompletion, NarrowedCompletion
from dse.space.methods.completion.layers import LayeredCompletion
from dse.space.methods.completion.preferences import Preference, PreferenceReader
from dse.space.methods.dnnf.trim import UnsupportedError
from dse.space.methods.engine import Engine

Way = Callable[[Engine], Completion]


def layered(engine: Engine) -> Completion:
    assert engine.expanded is not None
    return LayeredCompletion(engine.expanded)


def beside_sums(engine: Engine) -> Completion:
    assert engine.diagram is not None
    return DiagramCompletion(engine, engine.diagram)


def narrowed_without_a_diagram(engine: Engine) -> Completion:
    """As where rules fit into nothing."""
    return NarrowedCompletion(without_diagram(engine))


WAYS: tuple[Way, ...] = (layered, beside_sums, NarrowedCompletion, narrowed_without_a_diagram)


@pytest.mark.parametrize("way", WAYS, ids=lambda way: way.__name__)
@EXAMPLES
@given(data=st.data(), found=asked())
def test_preferences_are_met_in_their_order_wherever_a_row_has_them(
    way: Way, found: Answers, data: st.DataObject
) -> None:
    preferences = _preferences(data.draw, found)
    completion = _completion(way, found)
    for seed in range(3):
        row = completion.row(preferences, np.random.default_rng(seed))
        assert row.tolist() in _meeting(found, preferences)


@pytest.mark.thorough
@pytest.mark.parametrize("way", WAYS, ids=lambda way: way.__name__)
@EXAMPLES
@given(data=st.data(), found=asked())
def test_what_is_left_open_is_drawn_uniformly(way: Way, found: Answers, data: st.DataObject) -> None:
    """A false alarm in a million."""
    preferences = _preferences(data.draw, found)[:1]
    wanted = [tuple(row) for row in _meeting(found, preferences)]
    assume(1 < len(wanted) < 6)
    completion = _completion(way, found)
    random = np.random.default_rng(1)
    drawn = Counter(tuple(completion.row(preferences, random).tolist()) for _ in range(15 * len(wanted)))
    assert set(drawn) <= set(wanted)
    assert chisquare([drawn[row] for row in wanted]).pvalue > 1e-6


def _completion(way: Way, found: Answers) -> Completion:
    assume(found.valid().any())
    try:
        return way(found.engine)
    except UnsupportedError:
        assume(False)
        raise


def _preferences(draw: st.DrawFn, found: Answers) -> list[Preference]:
    every = [(path, choice) for path, choices in alternatives(found.space).items() for choice in (*choices, None)]
    wanted = draw(st.lists(st.sampled_from([*every, ("nowhere", "a")]), max_size=12))
    return PreferenceReader(found.engine.flat).read(wanted)


def _meeting(found: Answers, preferences: Sequence[Preference]) -> list[list[int]]:
    """Preference after preference, those valid rows that have it, if there is one."""
    rows = found.rows[found.valid()]
    for preference in preferences:
        having = [preference.is_met(row) for row in rows]
        rows = rows[having] if any(having) else rows
    found_rows: list[list[int]] = rows.tolist()
    return found_rows
