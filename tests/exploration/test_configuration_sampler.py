"""Samplers that choose configurations themselves and ask once: uniform, stratified, combinations."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from optimized import Array, brief, variables

from dse.domain.sampler import Brief, Candidate, DesignVariable, Outcomes, Role, Sampler
from dse.errors import DseError
from dse.exploration.samplers.combinations import Combinations
from dse.exploration.samplers.stratified import Stratified
from dse.exploration.samplers.uniform import Uniform
from dse.loading import Workspace
from dse.space import OpenedSpace, open_space
from dse.units import DIMENSIONLESS

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def acc() -> OpenedSpace:
    return open_space(Workspace(ROOT).design("acc_vehicle"))


def asked(sampler: Sampler, given: Brief) -> list[Candidate]:
    return list(sampler.start(given).ask())


def points(candidates: list[Candidate]) -> Array:
    return np.array([candidate.point for candidate in candidates])


def stratum(values: Array, number: int) -> list[int]:
    return np.sort(np.floor(values * number).astype(int)).tolist()


def test_uniform_configurations_are_different_ones_and_all_points_together_fill_the_ranges(acc: OpenedSpace) -> None:
    candidates = asked(Uniform(configurations=50, samples=4), brief(variables(2), space=acc.architectures()))
    assert len(candidates) == 200
    assert set(Counter(name for name, _ in candidates).values()) == {4}
    for column in points(candidates).T:
        assert stratum(column, 200) == list(range(200))
        for start in range(0, 200, 4):
            assert stratum(column[start : start + 4], 4) == [0, 1, 2, 3]


@pytest.mark.parametrize(
    "sampler", [Uniform(configurations=5), Stratified(configurations=5), Combinations(choices=["sensor"])]
)
def test_configurations_alone_can_be_asked_for_where_nothing_else_is_varied(sampler: Sampler, acc: OpenedSpace) -> None:
    candidates = asked(sampler, brief((), space=acc.architectures()))
    assert len({name for name, _ in candidates}) == len(candidates) >= 4
    assert {tuple(point) for _, point in candidates} == {()}


def test_of_more_configurations_than_there_are_all_are_taken(acc: OpenedSpace) -> None:
    candidates = asked(Uniform(configurations=400), brief(variables(1), space=acc.architectures()))
    assert {name for name, _ in candidates} == {configuration.id for configuration in acc.configurations()}
    assert len(candidates) == 227


def test_stratified_configurations_are_in_equal_shares_and_come_again_with_other_points(acc: OpenedSpace) -> None:
    architectures = acc.architectures()
    candidates = asked(Stratified(configurations=140, samples=2), brief(variables(1), space=architectures))
    chosen = [architectures.configuration(name).choices["powertrain"] for name, _ in candidates]
    shares = Counter(chosen)
    assert max(shares.values()) - min(shares.values()) <= 2
    assert len(set(candidates)) == len(candidates) == 280


@pytest.mark.parametrize("kind", [Uniform, Stratified])
def test_more_configurations_keep_those_that_are_there_and_their_points(kind: type[Uniform], acc: OpenedSpace) -> None:
    given = brief(variables(2), space=acc.architectures())
    first = asked(kind(configurations=20, samples=3), given)
    there = replace(given, earlier=outcomes(first))
    more = asked(kind(configurations=20, samples=5), there)
    assert set(first) <= set(more)
    assert set(asked(Uniform(configurations=40, samples=3), there)) >= (set(first) if kind is Uniform else set())


def test_every_valid_combination_comes_once_with_the_same_points(acc: OpenedSpace) -> None:
    candidates = asked(Combinations(samples=3), brief(variables(2), space=acc.architectures()))
    by_name = Counter(name for name, _ in candidates)
    assert set(by_name) == {configuration.id for configuration in acc.configurations()}
    assert set(by_name.values()) == {3}
    assert len({point for _, point in candidates}) == 3


def test_combinations_of_some_places_are_those_that_valid_configurations_have(acc: OpenedSpace) -> None:
    architectures = acc.architectures()
    given = brief((), space=architectures)
    candidates = asked(Combinations(choices=["sensor", "powertrain"]), given)
    found = [architectures.configuration(name).choices for name, _ in candidates]
    wanted = {(c.choices["sensor"], c.choices["powertrain"]) for c in acc.configurations()}
    assert len(found) == len(wanted)
    assert {(each["sensor"], each["powertrain"]) for each in found} == wanted


def test_an_unknown_place_is_refused_by_name(acc: OpenedSpace) -> None:
    with pytest.raises(DseError, match="there is no 'senso' to choose at") as refused:
        asked(Combinations(choices=["senso"]), brief((), space=acc.architectures()))
    assert "did you mean 'sensor'?" in str(refused.value)


@pytest.mark.parametrize(
    "sampler", [Uniform(configurations=5), Stratified(configurations=5), Combinations(choices=["sensor"])]
)
def test_each_design_is_asked_for_at_every_condition_where_it_is_allowed(sampler: Sampler, acc: OpenedSpace) -> None:
    slope = DesignVariable("road.slope", 0.0, 1.0, 2, 0.0, DIMENSIONLESS, role=Role.CONDITION)
    given = brief((slope, *variables(1)), space=acc.architectures(), conditions=((0.0,), (1.0,)))
    candidates = asked(sampler, given)
    assert Counter(point[0] for _, point in candidates) == {0.0: len(candidates) // 2, 1.0: len(candidates) // 2}
    some = asked(sampler, replace(given, allowed=lambda points: points[:, 0] < 0.5))
    assert some == [candidate for candidate in candidates if candidate.point[0] == 0.0]


def test_a_study_without_a_design_space_is_refused() -> None:
    with pytest.raises(DseError, match="has no design space to choose from"):
        asked(Uniform(configurations=5), brief(variables(1), space=None))


def outcomes(candidates: list[Candidate]) -> Outcomes:
    columns = {variable.name: points(candidates)[:, i] for i, variable in enumerate(variables(2))}
    names = tuple(name for name, _ in candidates)
    return Outcomes(names, columns, np.ones(len(candidates), bool), {}, {}, {})
