"""How exactly the sampler `boundary` finds boundaries that are known, and when it ends."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from judged_points import believed, believed_wrong, classes, predicted
from known_boundaries import (
    FINE,
    VARIABLES,
    Margins,
    ball,
    branin,
    brief,
    circle,
    creased,
    diamond,
    hole,
    rows,
    searched,
    two,
    wrong,
    wrong_on_a_grid,
)
from scipy.stats import qmc
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import ConstantKernel, Matern

from dse.errors import DseError
from dse.exploration.level_set import LevelSet, likeliest
from dse.exploration.samplers.boundary import Boundary
from dse.formats import read_yaml
from dse.loading import Surroundings

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


@pytest.mark.sampled(4)
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


@pytest.mark.thorough
@pytest.mark.filterwarnings("ignore::sklearn.exceptions.ConvergenceWarning")
@pytest.mark.parametrize(
    ("margins", "dimensions", "samples", "most"),
    [(branin, 2, 48, 0.0005), (ball, 4, 96, 0.001), (creased, 2, 64, 0.003), (diamond, 2, 64, 0.004)],
)
def test_a_search_misjudges_no_more_than_a_process_by_scikit_learn_on_its_runs(
    margins: Margins, dimensions: int, samples: int, most: float
) -> None:
    """Its length scales are the likeliest, too, its margins plain; slack of three of 16,384 points."""
    fine = qmc.Sobol(dimensions, scramble=False).random(16384)
    ours, theirs = [], []
    for seed in range(1, 6):
        found = rows(searched(margins, samples, brief(margins, dimensions=dimensions, seed=seed)))
        ours.append(np.mean(predicted(found, margins(found), fine) != classes(margins(fine))))
        kernel = ConstantKernel() * Matern(np.ones(dimensions), (0.01, 100.0), nu=2.5)
        plain = GaussianProcessRegressor(
            kernel, alpha=1e-8, normalize_y=True, n_restarts_optimizer=2, random_state=0
        ).fit(found, margins(found)["R"])
        theirs.append(np.mean((plain.predict(fine) < 0) != (margins(fine)["R"] < 0)))
    assert np.median(ours) <= min(most, np.median(theirs) + 3 / 16384)


@pytest.mark.parametrize("margins", [two, hole])
def test_the_last_digits_of_results_do_not_change_what_is_asked(margins: Margins) -> None:
    assert searched(margins, 40, noise=1e-13) == searched(margins, 40)


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


@pytest.mark.parametrize("unit", [1e-9, 1e6])
def test_margins_in_another_unit_tell_the_same(unit: float) -> None:
    points = qmc.Halton(2, scramble=False).random(24)
    margins = branin(points)["R"]
    one, other = (believed(points, {"R": margins * factor}, points[:8] + 0.01)[0].passing() for factor in (1, unit))
    assert other == pytest.approx(one, abs=1e-4)


def test_a_bench_without_requirements_has_no_boundary() -> None:
    given = brief(circle)
    with pytest.raises(DseError, match="needs a requirement"):
        Boundary(samples=4).start(replace(given, earlier=replace(given.earlier, margins={}, verdicts={})))


@pytest.mark.thorough
def test_an_accuracy_ends_the_search_before_its_samples() -> None:
    for margins in (circle, two, hole):
        found = rows(searched(margins, 160, accuracy=0.01))
        assert 16 < len(found) < 100
        assert wrong(found, margins) < 0.01


@pytest.mark.parametrize(
    ("margins", "accuracy"),
    [
        pytest.param(circle, 0.005, marks=pytest.mark.thorough),
        pytest.param(two, 0.005, marks=pytest.mark.thorough),
        pytest.param(hole, 0.02, marks=pytest.mark.thorough),
        *(pytest.param(*case, marks=pytest.mark.nightly) for case in ((circle, 0.02), (two, 0.02), (hole, 0.005))),
    ],
)
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
