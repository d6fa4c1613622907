from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from fake_runners import study_of
from first_asks import first_ask, points
from hypothesis import given, strategies as st

from dse.domain.sampler import Brief, DesignVariable, Outcomes
from dse.domain.study import Study
from dse.errors import DseError
from dse.exploration.samplers.central_composite import CentralComposite
from dse.exploration.samplers.csv import Csv
from dse.exploration.samplers.full_factorial import FullFactorial
from dse.exploration.samplers.halton import Halton
from dse.exploration.samplers.latin_hypercube import LatinHypercube
from dse.exploration.samplers.sobol import Sobol
from dse.exploration.variables import levels
from dse.formats.yaml import read_yaml
from dse.loading.extensions import Surroundings
from dse.units import DIMENSIONLESS, parse_unit


def variable(low: float, high: float, count: int = 5, nominal: float = 0.0) -> DesignVariable:
    return DesignVariable("part.x", low, high, count, nominal, DIMENSIONLESS)


def rows(study: Study) -> list[tuple[float, ...]]:
    return [tuple(map(float, point.values())) for point in points(study)]


def after(study: Study, there: list[tuple[float, ...]]) -> list[tuple[float, ...]]:
    """What *study* asks for when the points *there* have been simulated before."""
    columns = {v.name: np.array([point[i] for point in there]) for i, v in enumerate(study.variables)}
    outcomes = Outcomes(("a",) * len(there), columns, np.ones(len(there), dtype=np.bool_), {}, {}, {})
    brief = Brief(study.variables, ("a",), study.seed, outcomes)
    return [candidate.point for candidate in study.sampler.start(brief).ask()]


@pytest.mark.parametrize(
    ("sampler", "count"),
    [
        (FullFactorial(), 4**3),
        (FullFactorial(slices=[["part.x0", "part.x1"], ["part.x2"]]), 4 * 4 + 4),
        (LatinHypercube(samples=37), 37),
        (LatinHypercube(samples=1), 1),
        (LatinHypercube(samples=37, optimize=True), 37),
        (CentralComposite(), 1 + 2 * 3 + 2**3),
        (CentralComposite(corners="faced"), 1 + 2 * 3 + 2**3),
        (Sobol(samples=37), 37),
        (Halton(samples=37), 37),
    ],
    ids=str,
)
def test_a_sampler_gives_the_number_of_points_it_promises(sampler: FullFactorial, count: int) -> None:
    study = study_of(sampler, levels=4, variables=3)
    assert len(points(study)) == count
    assert list(points(study)[0]) == ["part.x0", "part.x1", "part.x2"]


def test_a_study_without_variables_is_one_run_per_configuration() -> None:
    made = first_ask(study_of(variables=0), ("a", "b"))
    assert [(r.number, r.configuration, r.point) for r in made] == [(0, "a", {}), (1, "b", {})]


def test_runs_are_numbered_by_configuration_then_by_point() -> None:
    made = first_ask(study_of(levels=2, variables=2), ("b", "a"))
    assert [r.number for r in made] == list(range(8))
    assert [r.configuration for r in made] == ["b"] * 4 + ["a"] * 4
    corners = [(0.0, 0.0), (0.0, 1.0), (1.0, 0.0), (1.0, 1.0)]
    assert [tuple(r.point.values()) for r in made] == corners * 2


def test_a_rotatable_design_has_its_points_on_a_sphere_and_a_faced_one_on_the_faces() -> None:
    for count in (2, 3, 5):
        centre, *others = np.array(rows(study_of(CentralComposite(), variables=count))) * 2 - 1
        assert not centre.any()
        # Corners at 2^(-k/4): their distance is that times the root of k, as in Box and Hunter 1957 for the axes at 1.
        distances = np.linalg.norm(others, axis=1)
        assert distances[: 2 * count] == pytest.approx(1.0, abs=1e-12)
        assert distances[2 * count :] == pytest.approx(math.sqrt(count) * 2 ** (-count / 4), abs=1e-12)
        faced = np.array(rows(study_of(CentralComposite(corners="faced"), variables=count))) * 2 - 1
        assert set(np.abs(faced).max(axis=1)) == {0.0, 1.0}


def test_the_fourth_moments_of_a_rotatable_design_are_those_of_a_sphere() -> None:
    points_there = np.array(rows(study_of(CentralComposite(), variables=3))) * 2 - 1
    # Box and Hunter 1957: sum x_i^4 is three times sum x_i^2 x_j^2.
    assert (points_there**4).sum(axis=0) == pytest.approx(3 * (points_there[:, 0] ** 2 * points_there[:, 1] ** 2).sum())


def test_an_optimised_hypercube_is_more_even_than_chance_and_stays_one_when_it_grows() -> None:
    from scipy.stats.qmc import discrepancy

    def unevenness(there: list[tuple[float, ...]], **options: object) -> float:
        study = study_of(LatinHypercube.model_validate({"samples": 24, **options}), variables=3)
        found = after(study, there) if there else rows(study)
        strata = np.sort((np.array(found) * 24).astype(int), axis=0)
        assert (strata == np.arange(24)[:, None]).all()
        assert found[: len(there)] == there
        return float(discrepancy(np.array(found)))

    assert unevenness([], optimize=True) < 0.8 * unevenness([])
    first = rows(study_of(LatinHypercube(samples=24), variables=3))[:12]
    assert unevenness(first, optimize=True) < 0.9 * unevenness(first)


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
    found = rows(study_of(FullFactorial(slices=[["part.x0"], ["part.x1"]]), levels=11, variables=2))
    # 0.3 is a level of both, so the two lines cross in a point of the grid.
    assert len(found) == 11 + 11 - 1
    assert found[:11] == [(level, 0.3) for level in levels(variable(0.0, 1.0, 11))]
    assert all(x0 == 0.3 for x0, _ in found[11:])


@given(st.integers(1, 60), st.integers(1, 4), st.integers(0, 2**32))
def test_a_latin_hypercube_has_one_point_in_each_stratum_of_each_variable(samples: int, count: int, seed: int) -> None:
    for column in np.array(rows(study_of(LatinHypercube(samples=samples), variables=count, seed=seed))).T:
        assert sorted(np.floor(column * samples).astype(int).tolist()) == list(range(samples))


@given(st.integers(1, 40), st.integers(1, 3), st.integers(0, 2**32))
def test_an_extended_latin_hypercube_keeps_its_points_and_fills_the_empty_strata(
    samples: int, count: int, seed: int
) -> None:
    there = rows(study_of(LatinHypercube(samples=samples), variables=count, seed=seed))
    # Twice as many strata: each has at most one of the points that are there, so that the whole is a Latin hypercube.
    more = after(study_of(LatinHypercube(samples=2 * samples), variables=count, seed=seed), there)
    assert more[:samples] == there
    for column in np.array(more).T:
        assert sorted(np.floor(column * 2 * samples).astype(int).tolist()) == list(range(2 * samples))


def test_points_outside_of_a_new_range_or_of_one_configuration_only_are_no_part_of_an_extended_hypercube() -> None:
    study = study_of(LatinHypercube(samples=6), variables=1)
    assert len(after(study, [(0.5,), (7.0,)])) == 6
    assert (7.0,) not in after(study, [(0.5,), (7.0,)])
    brief = Brief(
        study.variables,
        ("a", "b"),
        1,
        Outcomes(("a", "a", "b"), {"part.x0": np.array([0.1, 0.9, 0.9])}, np.ones(3, dtype=np.bool_), {}, {}, {}),
    )
    found = {candidate.point for candidate in study.sampler.start(brief).ask()}
    assert (0.9,) in found
    assert (0.1,) not in found


@pytest.mark.parametrize("scramble", [True, False])
@pytest.mark.parametrize("kind", [Sobol, Halton])
def test_more_samples_of_a_sequence_go_on_with_it(kind: type[Sobol], scramble: bool) -> None:
    few, many = (rows(study_of(kind(samples=n, scramble=scramble), variables=3)) for n in (11, 64))
    assert many[:11] == few


def test_sobol_points_are_those_of_the_published_sequence() -> None:
    # Joe and Kuo, 2008, new-joe-kuo-6.21201, with the origin first, in Gray code order.
    found = rows(study_of(Sobol(samples=4, scramble=False), variables=3))
    assert found == [(0.0, 0.0, 0.0), (0.5, 0.5, 0.5), (0.75, 0.25, 0.25), (0.25, 0.75, 0.75)]


def test_halton_points_are_radical_inverses() -> None:
    found = rows(study_of(Halton(samples=5, scramble=False), variables=2))
    # Halton, 1960: digits of the number in base 2 and 3, mirrored at the point.
    assert [x for x, _ in found] == [0.0, 1 / 2, 1 / 4, 3 / 4, 1 / 8]
    assert [y for _, y in found] == pytest.approx([0.0, 1 / 3, 2 / 3, 1 / 9, 4 / 9], abs=1e-15)


@pytest.mark.parametrize("sampler", [LatinHypercube(samples=5), Sobol(samples=5), Halton(samples=5)], ids=str)
def test_random_points_depend_on_the_seed(sampler: Sobol) -> None:
    one, two = (rows(study_of(sampler, seed=seed)) for seed in (1, 2))
    assert one != two


def test_a_latin_hypercube_keeps_its_points_from_release_to_release() -> None:
    found = [value for point in rows(study_of(LatinHypercube(samples=3), seed=1)) for value in point]
    expected = [0.10032182, 0.94188816, 0.45162716, 0.55993254, 0.96771296, 0.0624739]
    assert found == pytest.approx(expected, abs=1e-8)


@pytest.mark.thorough
def test_a_study_that_would_never_end_is_refused_before_it_is_laid_out() -> None:
    with pytest.raises(DseError, match=r"244,140,625 runs[\s\S]*another sampler"):
        points(study_of(levels=25, variables=6))


SPEED, PLAIN = (
    DesignVariable("world.speed", 0.0, 20.0, 0, 10.0, parse_unit("km/h")),
    DesignVariable("controller.k", -1.0, 1.0, 0, 0.0, parse_unit("1/s")),
)


def table(folder: Path, text: str) -> Csv:
    (folder / "points.csv").write_text(text, encoding="utf-8")
    return Csv(file="points.csv").settled(around(folder, SPEED, PLAIN))


def around(folder: Path, *variables: DesignVariable) -> Surroundings:
    (folder / "s.pet.yaml").write_text("study: s\n", encoding="utf-8")
    names = frozenset(variable.name for variable in variables)
    return Surroundings(read_yaml(folder / "s.pet.yaml").top["sampler"]["csv"], names, variables, folder)


def test_a_table_is_read_in_the_units_of_its_head_and_rows_that_repeat_are_one(tmp_path: Path) -> None:
    text = "\ufeffcontroller.k, world.speed [km/h]\n0.5,36\n\n-1,7.2\n0.5,36\n"
    assert table(tmp_path, text).rows == ((10.0, 0.5), (2.0, -1.0))


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "is empty"),
        ("controller.k,world.speed [km/h]\n", "has no row below its head"),
        ("controller.k\n1\n", r"points\.csv:1:1: there is no column 'world\.speed'"),
        ("controller.k;world.speed [m/s]\n1;1\n", "separated by ';'"),
        ("controller.k,world.speed\n1,1\n", r"may be in km/h or in SI[\s\S]*head it 'world\.speed \[km/h\]'"),
        ("controller.k,world.speed [kg]\n1,1\n", "is in kg, the variable in km/h"),
        ("controller.k,controller.k,world.speed [m/s]\n1,1,1\n", "two columns are headed 'controller.k'"),
        ("controller.kk,controller.k,world.speed [m/s]\n1,1,1\n", "did you mean 'controller.k'"),
        ("controller.k,world.speed [m/s]\n1,1\n1,fast\n", r"points\.csv:3:1: 'fast' is not a number for world\.speed"),
        ("controller.k,world.speed [m/s]\nnan,1\n1,21\n", r"k = nan is outside[\s\S]*speed = 21 is outside"),
        ("controller.k,world.speed [m/s]\n1\n", "'' is not a number for world.speed"),
    ],
)
def test_what_is_wrong_with_a_table_is_told_at_its_line(tmp_path: Path, text: str, told: str) -> None:
    with pytest.raises(DseError, match=told):
        table(tmp_path, text)


def test_a_table_lies_in_the_workspace_and_its_rows_stand_in_it(tmp_path: Path) -> None:
    with pytest.raises(DseError, match="outside the workspace"):
        Csv(file="../points.csv").settled(around(tmp_path, PLAIN))
    with pytest.raises(DseError, match="unknown key 'rows'"):
        Csv(file="points.csv", rows=((1.0,),)).settled(around(tmp_path, PLAIN))
