from __future__ import annotations

import math
from collections import Counter

import numpy as np
import pytest
from fake_executors import study_of
from hypothesis import given
from hypothesis import strategies as st

from dse.domain.study import DesignVariable, FullFactorial, LatinHypercube, Sampler, Study
from dse.errors import DseError
from dse.exploration.samplers import levels, points, requests
from dse.units import DIMENSIONLESS

SAMPLERS: list[tuple[Sampler, int]] = [
    (FullFactorial(), 4**3),
    (FullFactorial((("part.x0", "part.x1"), ("part.x2",))), 4 * 4 + 4),
    (LatinHypercube(37), 37),
    (LatinHypercube(1), 1),
]


def variable(low: float, high: float, count: int = 5, nominal: float = 0.0) -> DesignVariable:
    return DesignVariable("part.x", low, high, count, nominal, DIMENSIONLESS)


@pytest.fixture(params=SAMPLERS, ids=lambda entry: str(entry[0]))
def sampled(request: pytest.FixtureRequest) -> tuple[Study, int]:
    sampler, count = request.param
    return study_of(sampler, levels=4, variables=3), count


def test_every_kind_of_sampler_is_in_this_suite() -> None:
    from typing import get_args

    assert {type(sampler) for sampler, _ in SAMPLERS} == set(get_args(Sampler))


def test_a_sampler_gives_the_number_of_points_it_promises(sampled: tuple[Study, int]) -> None:
    study, count = sampled
    assert len(points(study)) == count


def test_every_point_names_every_variable_within_its_range(sampled: tuple[Study, int]) -> None:
    study, _ = sampled
    for point in points(study):
        assert list(point) == [v.name for v in study.variables]
        assert all(v.low <= point[v.name] <= v.high for v in study.variables)
        assert all(type(value) is float for value in point.values())


def test_a_sampler_always_gives_the_same_points(sampled: tuple[Study, int]) -> None:
    study, _ = sampled
    assert points(study) == points(study)


def test_no_point_is_given_twice(sampled: tuple[Study, int]) -> None:
    study, _ = sampled
    assert max(Counter(tuple(point.values()) for point in points(study)).values()) == 1


def test_a_study_without_variables_is_one_run_per_configuration() -> None:
    assert points(study_of(variables=0)) == [{}]
    assert points(study_of(LatinHypercube(9), variables=0)) == [{}]
    made = requests(study_of(variables=0), ("a", "b"))
    assert [(r.number, r.configuration, r.point) for r in made] == [(0, "a", {}), (1, "b", {})]


def test_runs_are_numbered_by_configuration_then_by_point() -> None:
    made = requests(study_of(levels=2, variables=2), ("b", "a"))
    assert [r.number for r in made] == list(range(8))
    assert [r.configuration for r in made] == ["b"] * 4 + ["a"] * 4
    corners = [(0.0, 0.0), (0.0, 1.0), (1.0, 0.0), (1.0, 1.0)]
    assert [tuple(r.point.values()) for r in made] == corners * 2


def test_a_single_level_is_the_nominal_value() -> None:
    assert levels(variable(0.0, 1.0, 1, nominal=0.3)) == (0.3,)


def test_levels_are_the_decimal_numbers_a_person_would_write() -> None:
    assert levels(variable(0.1, 0.7, 7)) == (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7)
    assert levels(variable(-1.0, 1.0, 5)) == (-1.0, -0.5, 0.0, 0.5, 1.0)


@given(st.floats(-1e9, 1e9), st.floats(0, 1e9), st.integers(2, 60))
def test_levels_are_equidistant_and_include_both_ends(low: float, width: float, count: int) -> None:
    high = low + width
    found = levels(variable(low, high, count))
    assert (found[0], found[-1], len(found)) == (low, high, count)
    assert list(found) == sorted(found)
    # Each is rounded once; two of them make up a distance.
    assert np.diff(found) == pytest.approx((high - low) / (count - 1), abs=2 * math.ulp(max(abs(low), abs(high))))


def test_slices_share_points_only_once_and_keep_the_others_nominal() -> None:
    study = study_of(FullFactorial((("part.x0",), ("part.x1",))), levels=11, variables=2)
    found = [tuple(point.values()) for point in points(study)]
    # 0.3 is a level of both, so the two lines cross in a point of the grid.
    assert len(found) == 11 + 11 - 1
    assert found[:11] == [(level, 0.3) for level in levels(variable(0.0, 1.0, 11))]
    assert all(x0 == 0.3 for x0, _ in found[11:])


@given(st.integers(1, 60), st.integers(1, 4), st.integers(0, 2**32))
def test_a_latin_hypercube_has_one_point_in_each_stratum_of_each_variable(samples: int, count: int, seed: int) -> None:
    study = study_of(LatinHypercube(samples), variables=count, seed=seed)
    columns = np.array([list(point.values()) for point in points(study)])
    for column in columns.T:
        assert sorted(np.floor(column * samples).astype(int).tolist()) == list(range(samples))


def test_a_latin_hypercube_depends_on_the_seed() -> None:
    one, two = (points(study_of(LatinHypercube(5), seed=seed)) for seed in (1, 2))
    assert one != two


def test_a_latin_hypercube_keeps_its_points_from_release_to_release() -> None:
    found = [value for point in points(study_of(LatinHypercube(3), seed=1)) for value in point.values()]
    expected = [0.10032182, 0.94188816, 0.45162716, 0.55993254, 0.96771296, 0.0624739]
    assert found == pytest.approx(expected, abs=1e-8)


@pytest.mark.thorough
def test_a_study_that_would_never_end_is_refused_before_it_is_laid_out() -> None:
    with pytest.raises(DseError, match=r"244,140,625 runs[\s\S]*latin_hypercube"):
        points(study_of(levels=25, variables=6))
    with pytest.raises(DseError, match="more than 5,000,000"):
        requests(study_of(levels=1000, variables=2), tuple("abcdef"))
