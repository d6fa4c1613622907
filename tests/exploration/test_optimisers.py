"""Samplers that look for the best designs: no run twice, an end, failures, conditions; and each on what is known."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from optimized import Array, Runs, brief, drive, variables
from scipy.integrate import quad
from scipy.stats import norm

from dse.domain.sampler import DesignVariable, Role
from dse.errors import DseError
from dse.exploration.optimization.expected_improvement import scalar
from dse.exploration.optimization.optimizing_sampler import OptimizingSampler
from dse.exploration.samplers.local import Local
from dse.exploration.samplers.mixed_gp import MixedGp
from dse.exploration.samplers.nsga2 import Nsga2
from dse.exploration.samplers.nsga3 import Nsga3
from dse.exploration.samplers.tpe import Tpe
from dse.loading import Workspace
from dse.space import OpenedSpace, open_space
from dse.testing.samplers import Chosen
from dse.units import DIMENSIONLESS

ROOT = Path(__file__).parents[2]
SMALL: Mapping[type[OptimizingSampler], Mapping[str, int]] = {
    Nsga2: {"population": 8},
    Nsga3: {"population": 8},
    Tpe: {"first": 8},
    MixedGp: {"first": 8},
    Local: {"samples": 4},
}
EVERY = pytest.mark.parametrize("kind", SMALL)
PROPOSING = pytest.mark.parametrize("kind", [kind for kind in SMALL if kind.proposes])


def made(kind: type[OptimizingSampler], evaluations: int, **more: object) -> OptimizingSampler:
    return kind.model_validate({**SMALL[kind], "evaluations": evaluations, **more})


def has(name: str) -> Sequence[bool]:
    """The second variable is absent without *s*."""
    return True, "x" in name or "y" in name, True


def bowls(names: Sequence[str], points: Array) -> Runs:
    """Each configuration has its own; a third of the runs fail, and a margin is sometimes not a number."""
    depth = np.array([sum(map(ord, name)) % 7 for name in names], dtype=np.float64)
    far = ((points - depth[:, None] / 7) ** 2).sum(axis=1)
    failing = np.modf(np.abs(points.sum(axis=1)) * 1000)[0] < 0.3
    margin = np.where(points[:, 0] < 0.1, np.nan, 0.9 - points[:, 0])
    return {"f": np.where(failing, np.nan, far), "g": np.where(failing, np.nan, depth - far)}, {"R": margin}


@EVERY
@pytest.mark.parametrize(
    "seed", [0, *(pytest.param(n, marks=pytest.mark.thorough if n < 3 else pytest.mark.nightly) for n in range(1, 8))]
)
def test_no_run_is_made_twice_also_when_a_study_is_extended(kind: type[OptimizingSampler], seed: int) -> None:
    """A third of the runs fail; some variables are absent; a longer study begins as the shorter one."""
    some = (*variables(2), replace(variables(3)[2], values=(0.0, 0.25, 1.0)))
    given = replace(brief(some, "f", "g", seed=seed, space=Chosen()), configurations=("xu", "u"))
    short, long = (drive(made(kind, number), given, bowls, has).candidates for number in (30, 44))
    assert len(short) == len(set(short)) <= 30
    assert len(long) == len(set(long)) <= 44
    assert set(short) <= set(long)


@EVERY
def test_a_study_in_which_everything_fails_comes_to_its_end(kind: type[OptimizingSampler]) -> None:
    given = replace(brief(variables(2), "f", "g", space=Chosen()), configurations=("xu",))
    driven = drive(made(kind, 25), given, lambda _, p: ({"f": p[:, 0] * np.nan, "g": p[:, 0] * np.nan}, {}))
    assert 0 < len(driven.candidates) <= 25


@EVERY
def test_designs_that_fail_a_condition_are_not_run_at_others(kind: type[OptimizingSampler]) -> None:
    slope = DesignVariable("road.slope", 0.0, 3.0, 4, 0.0, DIMENSIONLESS, role=Role.CONDITION)

    def run(names: Sequence[str], points: Array) -> Runs:
        x, at = points.T
        return {"f": x + at, "g": -x}, {"R": np.where(at == 0.0, x - 0.5, 1.0)}

    given = brief((*variables(1), slope), "f", "g", conditions=((0.0,), (1.0,), (2.0,), (3.0,)))
    driven = drive(made(kind, 80), replace(given, configurations=("only",)), run)
    runs = Counter(point[0] for _, point in driven.candidates[:40])
    assert any(number == 4 for number in runs.values())
    assert all(number == 1 for x, number in runs.items() if x < 0.5)


@PROPOSING
def test_a_space_that_is_all_asked_for_ends_the_study(kind: type[OptimizingSampler]) -> None:
    driven = drive(made(kind, 500), brief((), "f", "g", space=Chosen()), bowls_without)
    assert sorted(name for name, _ in driven.candidates) == ["u", "xu", "xv", "yu", "yv"]


def bowls_without(names: Sequence[str], _: Array) -> Runs:
    values = np.array([float(len(name)) for name in names])
    return {"f": values, "g": -values}, {}


@PROPOSING
def test_no_proposal_is_invalid(kind: type[OptimizingSampler], acc: OpenedSpace) -> None:
    valid = {configuration.id for configuration in acc.configurations()}
    driven = drive(made(kind, 40), brief(variables(2), "f", "g", space=acc.architectures()), bowls)
    assert {name for name, _ in driven.candidates} <= valid


@EVERY
def test_without_an_objective_or_an_allowed_design_it_is_refused(kind: type[OptimizingSampler]) -> None:
    with pytest.raises(DseError, match=f"'{kind.name}' needs something to be as small"):
        made(kind, 10).start(brief(variables(1)))


def rosenbrock(_: Sequence[str], points: Array) -> Runs:
    """Beyond the line x + y = 1 it is forbidden: the least is 0.1457, at (0.618, 0.382), in coordinates of -2 … 2."""
    x, y = (4 * points - 2).T
    return {"f": 100 * (y - x**2) ** 2 + (1 - x) ** 2}, {"R": 1 - x - y}


def best(driven: object, requirement: str = "R") -> float:
    margins, values = driven.margins(requirement), driven.column("f")  # type: ignore[attr-defined]
    return float(np.nanmin(np.where(margins >= 0, values, np.nan)))


@pytest.mark.thorough
def test_local_searches_end_at_the_least_of_every_configuration() -> None:
    """Before all evaluations are used up."""

    def run(names: Sequence[str], points: Array) -> Runs:
        centre = np.array([{"a": 0.2, "b": 0.8}[name] for name in names])
        return {"f": ((points - centre[:, None]) ** 2).sum(axis=1)}, {}

    driven = drive(Local(evaluations=2000), replace(brief(variables(3), "f"), configurations=("a", "b")), run)
    assert len(driven.candidates) < 1500
    for name in ("a", "b"):
        own = np.array([one == name for one, _ in driven.candidates])
        assert driven.column("f")[own].min() < 1e-5


@pytest.mark.thorough
def test_a_local_search_goes_down_a_valley_to_a_bound_that_is_required() -> None:
    driven = drive(
        Local(evaluations=600, starts=3), replace(brief(variables(2), "f"), configurations=("a",)), rosenbrock
    )
    assert best(driven) == pytest.approx(0.1457, abs=2e-3)


def test_a_local_search_stays_where_points_are_allowed() -> None:
    given = replace(brief(variables(2), "f"), configurations=("a",), allowed=lambda p: p.sum(axis=1) > 0.8)
    driven = drive(Local(evaluations=300), given, lambda _, p: ({"f": (p**2).sum(axis=1)}, {}))
    assert driven.column("f").min() == pytest.approx(0.32, abs=1e-3)
    assert all(sum(point) > 0.8 for _, point in driven.candidates)


@pytest.mark.thorough
def test_processes_find_the_least_in_few_runs() -> None:
    driven = drive(MixedGp(evaluations=60, first=12, batch=2), brief(variables(2), "f"), rosenbrock)
    assert best(driven) == pytest.approx(0.1457, abs=0.06)


@pytest.mark.thorough
@pytest.mark.parametrize("sampler", [MixedGp(evaluations=60, first=20), Tpe(evaluations=200)], ids=lambda s: s.name)
def test_the_best_of_many_configurations_is_found_with_its_gain(sampler: OptimizingSampler, acc: OpenedSpace) -> None:
    """What is chosen costs; a gain has to fit to it."""
    prices = {one.id: float(sum(map(len, one.choices.values()))) for one in acc.configurations()}
    least = min(prices.values())

    def run(names: Sequence[str], points: Array) -> Runs:
        base = np.array([prices[name] for name in names])
        return {"f": base - least + 50 * (points[:, 0] - 0.3) ** 2}, {}

    driven = drive(sampler, brief(variables(1), "f", space=acc.architectures()), run)
    found = driven.column("f")
    assert found.min() < 1.5
    # It also asks for what it knows little of; but more and more for what is good.
    assert np.quantile(found[-20:], 0.3) < np.quantile(found[:20], 0.3) / 2


def test_an_expected_improvement_is_what_its_integral_says() -> None:
    """Also far out, where it underflows."""
    from dse.exploration.optimization.expected_improvement import _log_improvement

    z = np.array([-30.0, -9.0, -7.5, -1.0, 0.0, 2.0])
    found = _log_improvement(z)
    for place, value in zip(z[2:].tolist(), found[2:].tolist(), strict=True):
        whole = quad(lambda x, place=place: (place - x) * norm.pdf(x), place - 12, place, epsabs=0, limit=400)[0]
        assert value == pytest.approx(np.log(whole), abs=1e-5)
    assert found[1] == pytest.approx(norm.logpdf(9) - 2 * np.log(9), abs=1e-9)
    assert np.isfinite(found).all()
    assert (np.diff(found) > 0).all()


def test_several_objectives_become_one_that_no_dominated_design_has_least() -> None:
    values = np.array([[0.0, 10.0], [10.0, 0.0], [4.0, 4.0], [11.0, 11.0], [np.nan, 1.0]])
    found = scalar(values, np.array([0.5, 0.5]))
    assert np.isnan(found[-1])
    assert found[3] == np.nanmax(found)
    assert np.nanargmin(found) == 2


@pytest.fixture(scope="module")
def acc() -> OpenedSpace:
    return open_space(Workspace(ROOT).design("acc_vehicle"))
