from __future__ import annotations

from collections.abc import Callable

import numpy as np
from fake_runners import definition_of, study_of
from first_asks import first_ask
from hypothesis import given, strategies as st

from dse.domain.study import Study
from dse.exploration.near_boundary import near_boundary as near_boundary_on
from dse.exploration.samplers.full_factorial import FullFactorial
from dse.exploration.samplers.latin_hypercube import LatinHypercube
from dse.storage.database.header import StudyHeader
from dse.storage.database.table import RunTable
from dse.storage.rows import RowBlock

Passes = Callable[..., bool]


def table_of(
    study: Study, passes: Passes, failed: frozenset[int] = frozenset(), names: tuple[str, ...] = ("a",)
) -> RunTable:
    """The study's runs, of which those pass R1 whose point *passes*."""
    made = first_ask(study, names)
    n = len(made)
    done = np.array([request.number not in failed for request in made], dtype=np.bool_)
    verdicts = np.zeros((n, 2), dtype=np.uint8)
    verdicts[:, 0] = [not passes(*request.point.values()) for request in made]
    verdicts[~done] = 3
    block = RowBlock(
        np.arange(n), done, np.zeros((n, 8)), verdicts, np.zeros((n, 2)), np.zeros(n), dict.fromkeys(failed, "x")
    )
    columns = {v.name: np.array([request.point[v.name] for request in made]) for v in study.variables}
    return RunTable(
        StudyHeader(definition_of(study, names)), block, tuple(request.configuration for request in made), columns
    )


def near_boundary(study: Study, table: RunTable) -> frozenset[int]:
    return near_boundary_on(study, table, study.sampler.grid)


def by_hand(table: RunTable, levels: int, passes: Passes) -> set[int]:
    """Neighbours of a full factorial of two variables from 0 to 1, straight from the definition."""
    points = list(
        zip(*(np.rint(column * (levels - 1)).astype(int).tolist() for column in table.points.values()), strict=True)
    )
    verdict = {point: passes(*(i / (levels - 1) for i in point)) for point in points}
    around = [(0, 1), (0, -1), (1, 0), (-1, 0)]
    return {
        number
        for number, (i, j) in enumerate(points)
        if any(verdict.get((i + a, j + b), verdict[i, j]) != verdict[i, j] for a, b in around)
    }


@given(st.integers(2, 9), st.floats(-0.5, 2.5), st.floats(-2.0, 2.0))
def test_in_a_factorial_the_runs_next_to_a_line_are_near_it(levels: int, offset: float, slope: float) -> None:
    def passes(x: float, y: float) -> bool:
        return y + slope * x < offset

    study = study_of(levels=levels)
    table = table_of(study, passes)
    assert near_boundary(study, table) == by_hand(table, levels, passes)


def test_where_all_verdicts_are_equal_there_is_no_boundary() -> None:
    for sampler in (FullFactorial(), LatinHypercube(samples=30)):
        study = study_of(sampler)
        assert near_boundary(study, table_of(study, lambda x, y: True)) == set()


def test_configurations_are_not_neighbours_of_each_other() -> None:
    study = study_of(levels=3, variables=1)
    table = table_of(study, lambda x: True, names=("a", "b"))
    table.block.verdicts[3:, 0] = 1
    assert near_boundary(study, table) == set()


def test_a_failed_run_makes_a_boundary_but_is_not_kept_itself() -> None:
    study = study_of(levels=5, variables=1)
    assert near_boundary(study, table_of(study, lambda x: True, failed=frozenset({2}))) == {1, 3}


def test_a_boundary_in_any_requirement_counts() -> None:
    study = study_of(levels=4, variables=1)
    table = table_of(study, lambda x: True)
    table.block.verdicts[:, 1] = [2, 2, 2, 0]
    assert near_boundary(study, table) == {2, 3}


def test_slices_find_the_boundary_within_each_slice() -> None:
    study = study_of(FullFactorial(slices=[["part.x0"], ["part.x1"]]), levels=5)
    table = table_of(study, lambda x, y: x < 0.6)
    points = [(x, y) for x, y in zip(*table.points.values(), strict=True)]
    near = {points[number] for number in near_boundary(study, table)}
    # Nominal is 0.3: along x0 the verdict changes between 0.5 and 0.75, along x1 it never does.
    assert near == {(0.5, 0.3), (0.75, 0.3)}


def test_in_a_latin_hypercube_the_nearest_runs_decide() -> None:
    study = study_of(LatinHypercube(samples=200), variables=2)
    table = table_of(study, lambda x, y: x < 0.5)
    near = near_boundary(study, table)
    x = table.points["part.x0"]
    assert 10 < len(near) < 100
    # 200 points in the unit square: the four nearest are within about 1 / sqrt(200 pi / 4) = 0.08, seldom twice that.
    assert all(abs(x[number] - 0.5) < 0.25 for number in near)
    closest = np.argsort(np.abs(x - 0.5))[:5]
    assert set(closest.tolist()) <= near


def test_variables_of_different_size_count_alike() -> None:
    study = study_of(LatinHypercube(samples=100), variables=2)
    table = table_of(study, lambda x, y: x < 0.5)
    from dataclasses import replace

    wide = replace(study, variables=(study.variables[0], replace(study.variables[1], high=1e6)))
    stretched = replace(table, points={"part.x0": table.points["part.x0"], "part.x1": table.points["part.x1"] * 1e6})
    assert near_boundary(wide, stretched) == near_boundary(study, table)


def test_a_study_without_variables_has_no_boundary() -> None:
    study = study_of(variables=0)
    assert near_boundary(study, table_of(study, lambda: True, names=("a", "b"))) == set()
