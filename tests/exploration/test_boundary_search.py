"""The sampler `boundary` on functions whose boundary is known."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
import pytest
from judged_points import classes, predicted
from numpy.typing import NDArray

from dse.domain.bench import Verdict
from dse.domain.sampler import Brief, Candidate, DesignVariable, Outcomes
from dse.errors import DseError
from dse.exploration.level_set import LevelSet
from dse.exploration.samplers.boundary import Boundary
from dse.units import DIMENSIONLESS

Array = NDArray[np.float64]
Margins = Callable[[Array], Mapping[str, Array]]
"""Of points (n, 2) of the unit square, by requirement; NaN where it is not exercised."""

VARIABLES = tuple(DesignVariable(f"part.{name}", 0.0, 1.0, 2, 0.5, DIMENSIONLESS) for name in "xy")
LINE = np.linspace(0, 1, 101)
FINE = np.stack(np.meshgrid(LINE, LINE), axis=-1).reshape(-1, 2)


def circle(points: Array) -> Mapping[str, Array]:
    return {"R": 0.3**2 - ((points - 0.5) ** 2).sum(axis=1)}


def two(points: Array) -> Mapping[str, Array]:
    x, y = points.T
    return {"A": x * y - 0.2, "B": 0.8 - x**2 - 0.3 * y}


def hole(points: Array) -> Mapping[str, Array]:
    x, y = points.T
    return {"R": np.where(x + 0.3 * y > 0.8, np.nan, y - 0.3 - 0.2 * np.sin(5 * x))}


def outcomes(candidates: list[Candidate], margins: Margins) -> Outcomes:
    points = np.array([candidate.point for candidate in candidates], dtype=np.float64).reshape(-1, 2)
    told = margins(points)
    verdicts = {name: tuple(verdict(margin) for margin in column.tolist()) for name, column in told.items()}
    columns = {v.name: points[:, i] for i, v in enumerate(VARIABLES)}
    names = tuple(candidate.configuration for candidate in candidates)
    return Outcomes(names, columns, np.ones(len(points), dtype=np.bool_), {}, told, verdicts)


def verdict(margin: float) -> Verdict:
    return Verdict.NOT_EXERCISED if np.isnan(margin) else Verdict.PASS if margin >= 0 else Verdict.FAIL


def brief(margins: Margins, earlier: list[Candidate] | None = None) -> Brief:
    return Brief(VARIABLES, ("a",), 1, outcomes(earlier or [], margins))


def searched(margins: Margins, samples: int, given: Brief | None = None, noise: float = 0.0) -> list[Candidate]:
    """What is asked for; margins are told with a relative error of *noise*."""
    search = Boundary(samples=samples).start(given or brief(margins))
    random = np.random.default_rng(0)

    def disturbed(points: Array) -> Mapping[str, Array]:
        told = margins(points)
        return {name: column * (1 + noise * random.uniform(-1, 1, len(column))) for name, column in told.items()}

    made: list[Candidate] = []
    while asked := list(search.ask()):
        search.tell(outcomes(asked, disturbed))
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
    level_set = LevelSet(points, circle(points)["R"])
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
