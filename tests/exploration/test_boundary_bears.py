"""What the sampler `boundary` bears: failed runs, few values, conditions, absent variables, stops and extensions."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from judged_points import believed
from known_boundaries import (
    FINE,
    VARIABLES,
    Array,
    Margins,
    brief,
    circle,
    hole,
    outcomes,
    rows,
    scattered,
    searched,
    two,
)

from dse.domain.sampler import Candidate, Role
from dse.exploration.samplers.boundary import Boundary


def test_of_variables_with_a_few_values_every_point_is_asked_for_once() -> None:
    few = tuple(replace(v, values=tuple(np.linspace(0, 1, count))) for v, count in zip(VARIABLES, (5, 4), strict=True))
    found = searched(circle, 60, replace(brief(circle), variables=few))
    assert len(found) == len(set(found)) == 20


def test_runs_are_at_the_conditions_only_and_at_all_of_them() -> None:
    given = (VARIABLES[0], replace(VARIABLES[1], role=Role.CONDITION, levels=3))
    found = rows(searched(two, 40, replace(brief(two), variables=given, conditions=((0.0,), (0.5,), (1.0,)))))
    assert set(found[:, 1].tolist()) == {0.0, 0.5, 1.0}
    assert len(np.unique(found, axis=0)) == 40


def test_only_what_is_allowed_is_asked_for() -> None:
    found = rows(searched(two, 40, replace(brief(two), allowed=lambda points: points.sum(axis=1) <= 1)))
    assert len(found) == 40
    assert found.sum(axis=1).max() <= 1


def test_a_variable_that_a_configuration_does_not_have_is_left_at_its_nominal_value() -> None:
    """Only the first asks, before anything was told, do not know of it."""
    search = Boundary(samples=48).start(brief(circle))
    made: list[tuple[float, ...]] = []
    while asked := list(search.ask()):
        settled = [candidate._replace(point=(candidate.point[0], 0.5)) for candidate in asked]
        search.tell(outcomes(settled, circle))
        assert not made or settled == asked
        made += [candidate.point for candidate in settled]
    assert len(made) == len(set(made)) == 48
    along = np.array(made)[:, 0]
    # The circle ends at 0.2 and 0.8.
    assert min(abs(along - 0.2)) < 0.002
    assert min(abs(along - 0.8)) < 0.002


@pytest.mark.thorough
def test_a_requirement_that_no_run_exercises_does_not_hide_the_other_boundary() -> None:
    def both(points: Array) -> Mapping[str, Array]:
        return {**circle(points), "never": np.full(len(points), np.nan)}

    found = rows(searched(both, 64))
    alone = believed(found, circle(found), FINE)[0].passing() > 0.5
    assert np.mean(alone != (circle(FINE)["R"] >= 0)) < 0.005


@pytest.mark.thorough
def test_with_30_percent_of_failed_runs_the_boundary_is_still_found() -> None:
    margins = scattered(0.3, circle)
    found = rows(searched(margins, 64))
    told = margins(found)
    assert len(np.unique(found, axis=0)) == 64
    assert 0.15 < np.isnan(told["R"]).mean() < 0.5
    signs = believed(found, told, FINE)[0].margin.positive() > 0.5
    assert np.mean(signs != (circle(FINE)["R"] >= 0)) < 0.02


@given(
    st.sampled_from([circle, two, hole, scattered(0.3, two), lambda points: {"R": np.full(len(points), np.nan)}]),
    st.integers(0, 2**32),
    st.lists(st.integers(1, 20), min_size=1, max_size=2),
    st.booleans(),
)
@settings(max_examples=6)
def test_no_run_is_made_twice_however_often_a_study_is_stopped_and_extended(
    margins: Margins, seed: int, steps: list[int], few: bool
) -> None:
    """Stopped, it asks for the same again; extended by *steps*, all that was there is among its samples."""
    variables = tuple(replace(v, values=tuple(np.linspace(0, 1, 6))) for v in VARIABLES) if few else VARIABLES
    there: list[Candidate] = []
    samples = 0
    for step in steps:
        samples += step
        given = replace(brief(margins, there), seed=seed, variables=variables)
        made = searched(margins, samples, given)
        assert searched(margins, samples, given) == made
        assert made[: len(there)] == there
        assert len(made) == len(set(made)) == min(samples, 36 if few else samples)
        there = made
