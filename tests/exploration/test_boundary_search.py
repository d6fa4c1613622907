"""The sampler `boundary` on functions whose boundary is known."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from judged_points import believed, believed_wrong, classes, predicted
from numpy.typing import NDArray
from scipy.stats import qmc

from dse.domain.bench import Verdict
from dse.domain.sampler import Brief, Candidate, DesignVariable, Outcomes, Role
from dse.errors import DseError
from dse.exploration.level_set import LevelSet, likeliest
from dse.exploration.samplers.boundary import Boundary
from dse.formats import read_yaml
from dse.loading import Surroundings
from dse.units import DIMENSIONLESS

Array = NDArray[np.float64]
Margins = Callable[[Array], Mapping[str, Array]]
"""Of points (n, d) of the unit cube, by requirement; NaN where it is not exercised."""

VARIABLES = tuple(DesignVariable(f"part.{name}", 0.0, 1.0, 2, 0.5, DIMENSIONLESS) for name in "xy")
Variables = tuple[DesignVariable, ...]
LINE = (np.arange(100) + 0.5) / 100
FINE = np.stack(np.meshgrid(LINE, LINE), axis=-1).reshape(-1, 2)


def circle(points: Array) -> Mapping[str, Array]:
    return {"R": 0.3**2 - ((points - 0.5) ** 2).sum(axis=1)}


def two(points: Array) -> Mapping[str, Array]:
    x, y = points.T
    return {"A": x * y - 0.2, "B": 0.8 - x**2 - 0.3 * y}


def hole(points: Array) -> Mapping[str, Array]:
    x, y = points.T
    return {"R": np.where(x + 0.3 * y > 0.8, np.nan, y - 0.3 - 0.2 * np.sin(5 * x))}


def outcomes(candidates: list[Candidate], margins: Margins, variables: Variables = VARIABLES) -> Outcomes:
    points = np.array([candidate.point for candidate in candidates], dtype=np.float64).reshape(-1, len(variables))
    told = margins(points)
    verdicts = {name: tuple(verdict(margin) for margin in column.tolist()) for name, column in told.items()}
    columns = {v.name: points[:, i] for i, v in enumerate(variables)}
    names = tuple(candidate.configuration for candidate in candidates)
    return Outcomes(names, columns, np.ones(len(points), dtype=np.bool_), {}, told, verdicts)


def verdict(margin: float) -> Verdict:
    return Verdict.NOT_EXERCISED if np.isnan(margin) else Verdict.PASS if margin >= 0 else Verdict.FAIL


def brief(margins: Margins, earlier: list[Candidate] | None = None) -> Brief:
    return Brief(VARIABLES, ("a",), 1, outcomes(earlier or [], margins))


Settle = Callable[[Mapping[str, Any]], Boundary]


@pytest.fixture
def settle(tmp_path: Path) -> Settle:
    """The sampler with options as a study file has them."""

    def settled(options: Mapping[str, Any]) -> Boundary:
        (tmp_path / "study.pet.yaml").write_text(f"sampler: {dict(options)}\n", encoding="utf-8")
        entry = read_yaml(tmp_path / "study.pet.yaml").top["sampler"]
        around = Surroundings(entry, frozenset(v.name for v in VARIABLES), VARIABLES, tmp_path)
        return Boundary.model_validate(options).settled(around)

    return settled


def searched(
    margins: Margins, samples: int, given: Brief | None = None, noise: float = 0.0, accuracy: float = 0.0
) -> list[Candidate]:
    """What is asked for; margins are told with a relative error of *noise*."""
    given = given or brief(margins)
    search = Boundary(samples=samples, accuracy=accuracy).start(given)
    random = np.random.default_rng(0)

    def disturbed(points: Array) -> Mapping[str, Array]:
        told = margins(points)
        return {name: column * (1 + noise * random.uniform(-1, 1, len(column))) for name, column in told.items()}

    made: list[Candidate] = []
    while asked := list(search.ask()):
        search.tell(outcomes(asked, disturbed, given.variables))
        made += asked
    return made


def wrong(points: Array, margins: Margins) -> float:
    """The share of the square that the runs at *points* misjudge."""
    return float(np.mean(predicted(points, margins(points), FINE) != classes(margins(FINE))))


def wrong_on_a_grid(count: int, margins: Margins) -> float:
    """The same of a grid of *count* by *count* runs, margins and the region's border interpolated linearly."""
    from scipy.interpolate import RegularGridInterpolator

    line = np.linspace(0, 1, count)
    nodes = np.stack(np.meshgrid(line, line, indexing="ij"), axis=-1)
    told = {}
    for name, column in margins(nodes.reshape(-1, 2)).items():
        grid = column.reshape(count, count)
        inside = RegularGridInterpolator((line, line), np.where(np.isnan(grid), -1.0, 1.0))(FINE)
        # Cells with a corner that has no margin take the sign of those that have one.
        surface = RegularGridInterpolator((line, line), np.nan_to_num(grid))(FINE)
        told[name] = np.where(inside < 0, np.nan, surface)
    return float(np.mean(classes(told) != classes(margins(FINE))))


def rows(candidates: list[Candidate]) -> Array:
    return np.array([candidate.point for candidate in candidates])


@pytest.mark.parametrize(
    ("margins", "samples", "most", "grid"), [(circle, 48, 0.002, 7), (two, 48, 0.002, 7), (hole, 64, 0.015, 8)]
)
def test_a_boundary_is_found_more_exactly_than_by_a_grid_of_as_many_runs(
    margins: Margins, samples: int, most: float, grid: int
) -> None:
    found = searched(margins, samples)
    assert len(set(found)) == samples <= grid**2
    assert wrong(rows(found), margins) < min(most, wrong_on_a_grid(grid, margins))


@pytest.mark.thorough
@pytest.mark.parametrize("margins", [circle, two, hole])
def test_160_runs_are_more_exact_than_a_grid_of_625(margins: Margins) -> None:
    assert wrong(rows(searched(margins, 160)), margins) <= wrong_on_a_grid(25, margins)


def four(points: Array) -> Mapping[str, Array]:
    a, b, c, d = points.T
    return {"A": a * b + 0.5 * c - 0.4 - 0.2 * d, "B": 1.1 - a**2 - 0.3 * b - 0.5 * c * d - 0.2 * d}


@pytest.mark.thorough
def test_256_runs_misjudge_less_than_a_thousandth_of_four_ranges() -> None:
    variables = tuple(replace(VARIABLES[0], name=f"part.{name}") for name in "abcd")
    fine = qmc.Sobol(4, scramble=False).random(8192)
    shares = []
    for seed in (1, 2, 3):
        found = rows(searched(four, 256, Brief(variables, ("a",), seed, outcomes([], four, variables))))
        shares.append(np.mean(predicted(found, four(found), fine) != classes(four(fine))))
    assert np.median(shares) < 0.001


def test_the_last_digits_of_results_do_not_change_what_is_asked() -> None:
    assert searched(two, 48, noise=1e-13) == searched(two, 48)


def test_more_samples_keep_the_points_that_are_there() -> None:
    there = searched(circle, 30)
    more = searched(circle, 40, brief(circle, there))
    assert more[:30] == there
    assert len(set(more)) == 40


def test_runs_are_wanted_where_the_other_requirement_does_not_surely_fail() -> None:
    points = rows(searched(two, 64))[16:]
    doubtful = points[np.arange(16, 64) % 8 != 0]
    assert np.mean(two(doubtful)["B"] > -0.1) > 0.9


@pytest.mark.parametrize("margin", [np.nan, 0.0, 1.0, -1.0])
def test_where_no_boundary_shows_the_ranges_are_filled(margin: float) -> None:
    points = rows(searched(lambda points: {"R": np.full(len(points), margin)}, 64))
    # Of 16 equal squares each has a run.
    assert len({tuple(square) for square in np.minimum(points * 4, 3).astype(int).tolist()}) == 16
    # They do not stand in columns.
    assert all(len(np.unique((column * 64).astype(int))) > 40 for column in points.T)


def test_the_process_goes_through_what_is_known_and_is_unsure_elsewhere() -> None:
    points = rows(searched(circle, 16))
    margins = circle(points)["R"]
    level_set = LevelSet.through(points, margins, likeliest(points, margins))
    known, apart = level_set.at(points), level_set.at(np.array([[9.0, 9.0]]))
    # A nugget of at most 1e-4 of the variance: a hundredth of the deviation.
    assert known.mean == pytest.approx(circle(points)["R"], abs=0.01 * level_set.deviation)
    assert known.deviation.max() < 0.011 * level_set.deviation < 0.1 * apart.deviation.min()
    apart.include(0)
    assert apart.deviation.max() < 0.011 * level_set.deviation


def test_a_bench_without_requirements_has_no_boundary() -> None:
    given = brief(circle)
    with pytest.raises(DseError, match="needs a requirement"):
        Boundary(samples=4).start(replace(given, earlier=replace(given.earlier, margins={}, verdicts={})))


def test_an_accuracy_ends_the_search_before_its_samples() -> None:
    for margins in (circle, two, hole):
        found = rows(searched(margins, 160, accuracy=0.01))
        assert 16 < len(found) < 100
        assert wrong(found, margins) < 0.01


@pytest.mark.thorough
@pytest.mark.parametrize("margins", [circle, two, hole])
@pytest.mark.parametrize("accuracy", [0.02, 0.005])
def test_what_is_believed_to_be_misjudged_is_on_average(margins: Margins, accuracy: float) -> None:
    """By a search that ends of itself: it ends when too little is believed rather than too much."""
    true, told = [], []
    for seed in range(1, 21):
        found = rows(searched(margins, 300, replace(brief(margins), seed=seed), accuracy=accuracy))
        assert len(found) < 300
        true.append(wrong(found, margins))
        told.append(believed_wrong(found, margins(found), FINE))
    assert np.mean(true) <= 1.2 * np.mean(told)
    assert np.mean(np.array(true) <= accuracy) >= 0.9


@pytest.mark.parametrize(("written", "number"), [("0.5 %", 0.005), (0.02, 0.02), (0, 0.0)])
def test_an_accuracy_is_a_share(settle: Settle, written: str | float, number: float) -> None:
    assert settle({"samples": 20, "accuracy": written}).options()["accuracy"] == number


@pytest.mark.parametrize("written", ["-1 %", "100 %", 1.5, "3 m", "exact"])
def test_what_is_no_share_is_refused_with_its_place(settle: Settle, written: str | float) -> None:
    with pytest.raises(DseError, match=r"study\.pet\.yaml:"):
        settle({"samples": 20, "accuracy": written})


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


def test_a_requirement_that_no_run_exercises_does_not_hide_the_other_boundary() -> None:
    def both(points: Array) -> Mapping[str, Array]:
        return {**circle(points), "never": np.full(len(points), np.nan)}

    found = rows(searched(both, 64))
    alone = believed(found, circle(found), FINE)[0].passing() > 0.5
    assert np.mean(alone != (circle(FINE)["R"] >= 0)) < 0.005


def scattered(share: float, margins: Margins) -> Margins:
    """*margins* of runs of which a *share* fails, here and there, always the same."""

    def told(points: Array) -> Mapping[str, Array]:
        # Neighbours differ: a hash of the point's bits.
        fails = np.array([hash(tuple(row)) % 1000 < 1000 * share for row in points.tolist()], dtype=np.bool_)
        return {name: np.where(fails, np.nan, column) for name, column in margins(points).items()}

    return told


def test_with_30_percent_of_failed_runs_the_boundary_is_still_found() -> None:
    margins = scattered(0.3, circle)
    found = rows(searched(margins, 96))
    told = margins(found)
    assert len(np.unique(found, axis=0)) == 96
    assert 0.15 < np.isnan(told["R"]).mean() < 0.5
    signs = believed(found, told, FINE)[0].margin.positive() > 0.5
    assert np.mean(signs != (circle(FINE)["R"] >= 0)) < 0.02


@given(
    st.sampled_from([circle, two, hole, scattered(0.3, two), lambda points: {"R": np.full(len(points), np.nan)}]),
    st.integers(0, 2**32),
    st.lists(st.integers(1, 20), min_size=1, max_size=3),
    st.booleans(),
)
@settings(max_examples=12)
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
