"""NSGA-II and NSGA-III: fronts that are known, requirements, conditions, failures, and every proposal valid."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from optimized import Array, Function, Runs, brief, drive, variables

from dse.domain.sampler import DesignVariable, Role
from dse.errors import DseError
from dse.exploration.designs import front_of
from dse.exploration.optimization.evolution import EvolutionSampler
from dse.exploration.optimization.front import hypervolume, knee
from dse.exploration.samplers.nsga2 import Nsga2
from dse.exploration.samplers.nsga3 import Nsga3
from dse.loading import Workspace
from dse.space import OpenedSpace, open_space
from dse.units import DIMENSIONLESS

ROOT = Path(__file__).parents[2]
thorough = partial(pytest.param, marks=pytest.mark.thorough)
BOTH = pytest.mark.parametrize("kind", [Nsga2, Nsga3])


def zdt1(names: Sequence[str], points: Array) -> Runs:
    """Zitzler, Deb and Thiele 2000; the front is f2 = 1 - sqrt(f1)."""
    first, g = points[:, 0], 1 + 9 * points[:, 1:].mean(axis=1)
    return {"f1": first, "f2": g * (1 - np.sqrt(first / g))}, {}


def zdt2(names: Sequence[str], points: Array) -> Runs:
    first, g = points[:, 0], 1 + 9 * points[:, 1:].mean(axis=1)
    return {"f1": first, "f2": g * (1 - (first / g) ** 2)}, {}


def zdt3(names: Sequence[str], points: Array) -> Runs:
    first, g = points[:, 0], 1 + 9 * points[:, 1:].mean(axis=1)
    return {"f1": first, "f2": g * (1 - np.sqrt(first / g) - first / g * np.sin(10 * np.pi * first))}, {}


def dtlz2(names: Sequence[str], points: Array) -> Runs:
    radius = 1 + ((points[:, 2:] - 0.5) ** 2).sum(axis=1)
    one, other = points[:, 0] * np.pi / 2, points[:, 1] * np.pi / 2
    first, second = radius * np.cos(one) * np.cos(other), radius * np.cos(one) * np.sin(other)
    return {"f1": first, "f2": second, "f3": radius * np.sin(one)}, {}


def constr_ex(names: Sequence[str], points: Array) -> Runs:
    """Deb 2001: x1 in 0.1 … 1, x2 in 0 … 5; part of the front lies on the first constraint."""
    x, y = points.T
    return {"f1": x, "f2": (1 + y) / x}, {"A": y + 9 * x - 6, "B": -y + 9 * x - 1}


CONSTR_EX = (
    DesignVariable("part.x", 0.1, 1.0, 2, 0.5, DIMENSIONLESS),
    DesignVariable("part.y", 0.0, 5.0, 2, 0.0, DIMENSIONLESS),
)


@pytest.mark.thorough
@pytest.mark.parametrize(("problem", "whole"), [(zdt1, 0.8765), thorough(zdt2, 0.5432), thorough(zdt3, 1.3315)])
def test_the_fronts_of_zdt_are_found(problem: Function, whole: float) -> None:
    """Six variables, the volume up to (1.1, 1.1) against that of the true front."""
    driven = drive(Nsga2(population=40, evaluations=2400), brief(variables(6), "f1", "f2"), problem)
    assert len(driven.candidates) == len(set(driven.candidates)) == 2400
    points = np.column_stack([driven.column("f1"), driven.column("f2")])
    assert 0.95 * whole < hypervolume(points.tolist(), (1.1, 1.1)) <= whole


@pytest.mark.thorough
def test_a_front_of_three_objectives_is_found_by_reference_directions() -> None:
    """DTLZ2 (Deb et al. 2002): an eighth of the unit sphere; evenly, the designs are near to it everywhere."""
    names = ("f1", "f2", "f3")
    driven = drive(Nsga3(population=48, evaluations=2400), brief(variables(5), *names), dtlz2)
    points = np.column_stack([driven.column(name) for name in names])
    best = points[front_of(points)]
    assert np.median(np.linalg.norm(best, axis=1)) < 1.03
    directions = np.array([[1, 1, 1], [1, 1, 0], [0, 1, 1], [1, 0, 1], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    cosines = (best / np.linalg.norm(best, axis=1)[:, None]) @ (
        directions / np.linalg.norm(directions, axis=1)[:, None]
    ).T
    assert cosines.max(axis=0).min() > 0.97


@pytest.mark.sampled(2)
@BOTH
def test_requirements_are_constraints(kind: type[EvolutionSampler]) -> None:
    """The volume of the true front of constr-Ex up to (1.1, 10), by integration."""
    driven = drive(kind(population=40, evaluations=1200), brief(CONSTR_EX, "f1", "f2"), constr_ex)
    met = (driven.margins("A") >= 0) & (driven.margins("B") >= 0)
    points = np.column_stack([driven.column("f1"), driven.column("f2")])[met]
    x = np.linspace(0.1, 1.0, 200_001)
    least = np.where(x < 7 / 18, np.nan, (1 + np.maximum(6 - 9 * x, 0.0)) / x)
    height = np.clip(10 - np.fmin.accumulate(least), 0.0, None)
    whole = float(np.trapezoid(np.nan_to_num(height), x) + 0.1 * np.nan_to_num(height)[-1])
    assert 0.94 * whole < hypervolume(points.tolist(), (1.1, 10.0)) <= whole


@pytest.mark.sampled(2)
@BOTH
def test_the_best_of_many_configurations_is_found_with_its_gain(kind: type[EvolutionSampler], acc: OpenedSpace) -> None:
    """Each configuration has a best gain of its own; a tenth of the runs of a grid do."""
    prices = {configuration.id: price(configuration.choices) for configuration in acc.configurations()}

    def run(names: Sequence[str], points: Array) -> Runs:
        base = np.array([prices[name] for name in names])
        return {"cost": base, "error": (points[:, 0] - base / 40) ** 2 + (40 - base) / 100}, {}

    given = brief(variables(1), "cost", "error", space=acc.architectures())
    driven = drive(kind(population=32, evaluations=640), given, run)
    found = {name for name, _ in driven.candidates}
    assert min(prices, key=lambda name: (prices[name], name)) in found
    assert found <= set(prices)


def price(choices: Mapping[str, str]) -> float:
    return float(sum(3 + 7 * index % 11 + len(name) % 5 for index, name in enumerate(sorted(choices.values()))))


@BOTH
def test_lost_designs_are_not_run_in_further_conditions(kind: type[EvolutionSampler]) -> None:
    """The condition in which most are lost comes first, once that is known."""
    slope = DesignVariable("road.slope", 0.0, 3.0, 4, 0.0, DIMENSIONLESS, role=Role.CONDITION)

    def run(names: Sequence[str], points: Array) -> Runs:
        x, at = points.T
        return {"f": x}, {"R": np.where(at == 3.0, x - 0.9, 1.0)}

    given = brief((*variables(1), slope), "f", conditions=((0.0,), (1.0,), (2.0,), (3.0,)))
    driven = drive(kind(population=16, evaluations=320), replace(given, objectives=given.objectives * 2), run)
    first = [{point[1] for _, point in ask} for ask in driven.asks]
    assert first[0] == {0.0}
    assert first[3] == {3.0}
    runs = Counter(point[0] for _, point in driven.candidates[64:])
    assert all(number == 1 for x, number in runs.items() if x < 0.9)
    best = min(x for x, number in runs.items() if number == 4)
    assert 0.9 <= best < 0.92


def test_what_is_never_exercised_is_not_met() -> None:
    def run(names: Sequence[str], points: Array) -> Runs:
        x = points[:, 0]
        return {"f": x}, {"R": np.where(x < 0.5, np.nan, x - 0.6)}

    driven = drive(Nsga2(population=10, evaluations=300), brief(variables(1), "f"), run)
    assert np.median(driven.column("f")[-50:]) == pytest.approx(0.6, abs=0.02)


def test_a_requirement_is_met_where_one_condition_exercises_it() -> None:
    at = DesignVariable("road.slope", 0.0, 1.0, 2, 0.0, DIMENSIONLESS, role=Role.CONDITION)

    def run(names: Sequence[str], points: Array) -> Runs:
        return {"f": points[:, 0]}, {"R": np.where(points[:, 1] == 0, np.nan, 1.0)}

    given = brief((*variables(1), at), "f", conditions=((0.0,), (1.0,)))
    assert drive(Nsga2(population=10, evaluations=300), given, run).column("f").min() < 0.01


def test_runs_that_fail_are_the_worst() -> None:
    """Of a region that does not run nothing is asked any more, though its objective would be the best."""

    def run(names: Sequence[str], points: Array) -> Runs:
        x = points[:, 0]
        return {"f": np.where(x < 0.3, np.nan, x)}, {}

    driven = drive(Nsga2(population=10, evaluations=300), brief(variables(1), "f"), run)
    assert np.nanmin(driven.column("f")) == pytest.approx(0.3, abs=0.01)


def test_a_study_in_which_everything_fails_comes_to_its_end() -> None:
    driven = drive(
        Nsga2(population=8, evaluations=100), brief(variables(2), "f"), lambda n, p: ({"f": p[:, 0] * np.nan}, {})
    )
    assert len(driven.candidates) == 100


def test_totals_are_objectives_of_their_own() -> None:
    """A property's sum is told beside the metrics."""
    driven = drive(Nsga2(population=8, evaluations=200), brief(variables(1), "-f"), lambda n, p: ({"f": p[:, 0]}, {}))
    assert driven.column("f").max() > 0.99


def test_a_point_that_is_not_allowed_is_not_asked_for() -> None:
    given = replace(brief(variables(2), "f"), allowed=lambda points: points.sum(axis=1) > 0.8)
    driven = drive(Nsga2(population=8, evaluations=200), given, lambda n, p: ({"f": p.sum(axis=1)}, {}))
    assert 0.8 < driven.column("f").min() < 0.85


def test_uncertain_variables_are_nominal_or_drawn_alike_for_all_designs() -> None:
    mass = DesignVariable("chassis.mass", 1.0, 2.0, 2, 1.5, DIMENSIONLESS, role=Role.UNCERTAIN)
    given = brief((*variables(1), mass), "f")

    def run(names: Sequence[str], points: Array) -> Runs:
        return {"f": points[:, 0] * points[:, 1]}, {}

    nominal = drive(Nsga2(population=8, evaluations=80), given, run)
    assert {point[1] for _, point in nominal.candidates} == {1.5}
    drawn = drive(Nsga2(population=8, evaluations=96, draws=3), given, run)
    assert len({point[1] for _, point in drawn.candidates}) == 3
    assert set(Counter(point[0] for _, point in drawn.candidates).values()) == {3}


@BOTH
def test_a_study_without_an_objective_is_refused(kind: type[EvolutionSampler]) -> None:
    with pytest.raises(DseError, match=f"'{kind.name}' needs something to be as small or as large as can be"):
        kind(evaluations=10).start(brief(variables(1)))


def test_one_objective_is_too_few_for_reference_directions() -> None:
    with pytest.raises(DseError, match="needs two objectives") as refused:
        Nsga3(evaluations=10).start(brief(variables(1), "f"))
    assert "take 'nsga2'" in str(refused.value)


@pytest.mark.thorough
@pytest.mark.parametrize(
    "evaluations",
    [1000, pytest.param(10_000, marks=pytest.mark.thorough), pytest.param(100_000, marks=pytest.mark.nightly)],
)
def test_no_proposal_is_invalid_and_none_is_made_twice(evaluations: int, acc: OpenedSpace) -> None:
    valid = {configuration.id for configuration in acc.configurations()}
    given = brief(variables(3), "f1", "f2", space=acc.architectures())
    driven = drive(Nsga2(population=50, evaluations=evaluations), given, zdt1)
    names = {name for name, _ in driven.candidates}
    assert names <= valid
    assert len(set(driven.candidates)) == len(driven.candidates) == evaluations


@pytest.mark.thorough
def test_a_space_that_is_all_asked_for_ends_the_study(acc: OpenedSpace) -> None:
    """227 configurations without variables: no more than so many runs."""
    order = {configuration.id: float(number) for number, configuration in enumerate(acc.configurations())}
    given = brief((), "f", space=acc.architectures())
    driven = drive(
        Nsga2(population=40, evaluations=5000), given, lambda n, p: ({"f": np.array([order[name] for name in n])}, {})
    )
    names = [name for name, _ in driven.candidates]
    assert len(names) == len(set(names)) <= 227
    assert min(order, key=order.__getitem__) in names


def test_the_volume_of_a_front_is_exact() -> None:
    values = [(1.0, 4.0), (2.0, 2.0), (2.0, 2.0), (3.0, 3.0), (4.0, 1.0), (0.0, 6.0)]
    assert hypervolume(values, (5.0, 5.0)) == 4 * 1 + 3 * 2 + 1 * 1
    boxes = [(1.0, 2.0, 3.0), (2.0, 1.0, 3.0), (3.0, 3.0, 1.0)]
    grid = np.stack(np.meshgrid(*[np.arange(0.5, 4.0)] * 3), axis=-1).reshape(-1, 3)
    covered = np.any([np.all(grid > box, axis=1) for box in boxes], axis=0)
    assert hypervolume(boxes, (4.0, 4.0, 4.0)) == covered.sum()


def test_the_knee_of_a_front_is_where_it_turns() -> None:
    assert knee([(0.0, 10.0), (1.0, 2.0), (5.0, 1.0), (10.0, 0.0)]) == 1
    assert knee([(0.0, 1.0), (1.0, 0.0)]) is None


@pytest.fixture(scope="module")
def acc() -> OpenedSpace:
    return open_space(Workspace(ROOT).design("acc_vehicle"))
