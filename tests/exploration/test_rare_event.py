"""Importance sampling against limit states whose probability is known in closed form."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

import numpy as np
import pytest
from scipy.stats import norm

from dse.domain.bench import Verdict
from dse.domain.sampler import Brief, DesignVariable, Outcomes
from dse.errors import DseError
from dse.exploration.rare_event import Probability, RareEvent
from dse.exploration.samplers.rare_failures import RareFailures
from dse.exploration.surrogate import single_threaded
from dse.units import DIMENSIONLESS

Score = Callable[[np.ndarray], np.ndarray]


def estimated(score: Score, dimension: int, seed: int, **more: int) -> tuple[Probability, int]:
    """The estimate, and how many runs it took."""
    event = RareEvent(dimension, more.get("batch", 200), more.get("last", 400), 15, np.random.default_rng(seed))
    runs = 0
    while len(points := event.ask()):
        runs += len(points)
        event.tell(points, score(points))
    assert event.probability is not None
    return event.probability, runs


def linear(share: float, dimension: int) -> Score:
    """Fails beyond a plane, which all numbers decide alike: the share is Φ(-β)."""
    beta = -norm.ppf(share)
    return lambda points: beta - points.sum(axis=1) / math.sqrt(dimension)


def either_side(share: float) -> Score:
    """Fails beyond two planes that are opposite: each has half of the share."""
    beta = -norm.ppf(share / 2)
    return lambda points: beta - np.abs(points[:, 0])


def uneven(share: float) -> Score:
    """Two planes at right angles with 70 and 30 % of the share; towards the second one the score decreases thrice as
    fast, so that the search meets the first one earlier."""
    one, other = -norm.ppf(0.7 * share), -norm.ppf(0.3 * share)
    return lambda points: np.minimum(one - points[:, 0], 3 * (other - points[:, 1]))


def cases() -> Iterator[tuple[str, Score, int, float]]:
    for share in (1e-3, 1e-4, 1e-5):
        yield f"linear 2 {share:g}", linear(share, 2), 2, share
        yield f"linear 5 {share:g}", linear(share, 5), 5, share
        yield f"either side {share:g}", either_side(share), 3, share
        yield f"uneven {share:g}", uneven(share), 2, 1 - (1 - 0.7 * share) * (1 - 0.3 * share)


CASES = list(cases())


@pytest.mark.parametrize(("score", "dimension", "share"), [each[1:] for each in CASES], ids=[each[0] for each in CASES])
@pytest.mark.sampled(6)
def test_the_estimate_is_near_the_closed_form_with_few_runs(score: Score, dimension: int, share: float) -> None:
    with single_threaded():
        found, runs = estimated(score, dimension, 1)
    # The intervals are ±15 % or so; four times that is beyond any chance.
    assert abs(math.log(found.value / share)) < 0.6
    assert found.low < found.value < found.high
    assert runs < 3000
    assert found.failing > 100


@pytest.mark.thorough
@pytest.mark.parametrize(
    "name",
    ["linear 5 0.001", "either side 0.001", "linear 5 0.0001", "uneven 1e-05", "linear 2 1e-05", "either side 1e-05"],
)
def test_the_interval_holds_the_closed_form_in_nine_seeds_of_ten(name: str) -> None:
    score, dimension, share = next(each[1:] for each in CASES if each[0] == name)
    with single_threaded():
        found = [estimated(score, dimension, seed)[0] for seed in range(100)]
    # 95 % of 100 is 95, with a standard deviation of 2.2.
    assert sum(each.low <= share <= each.high for each in found) >= 90
    assert float(np.mean([each.value for each in found])) == pytest.approx(share, rel=0.05)


def test_half_of_the_space_is_half() -> None:
    found, _ = estimated(lambda points: points[:, 0] + points[:, 1], 2, 3)
    assert found.low <= 0.5 <= found.high


def test_a_failure_without_a_score_that_leads_to_it_is_found_by_the_wide_density() -> None:
    share = float(norm.sf(2.5))  # all that pass score alike
    found, _ = estimated(lambda points: np.where(points[:, 0] > 2.5, -1.0, 1e-320), 2, 1)
    assert found.low <= share <= found.high


def test_without_any_failure_the_share_has_a_bound() -> None:
    found, runs = estimated(lambda points: 100.0 - points[:, 0], 2, 1)
    assert (found.value, found.low, found.failing, runs) == (0.0, 0.0, 0, 15 * 200)
    # Rule of three over the half of the first batch that is drawn from the space itself.
    assert found.high == pytest.approx(2 * (1 - 0.05 ** (1 / 200)))
    unknown, _ = estimated(lambda points: np.full(len(points), np.inf), 2, 1)
    assert unknown.failing == 0


X = DesignVariable("part.x", 0.0, 10.0, 0, 5.0, DIMENSIONLESS)
Y = DesignVariable("part.y", -1.0, 1.0, 0, 0.0, DIMENSIONLESS)


def outcomes(candidates: list, limit: float) -> Outcomes:
    """x beyond *limit* fails R; the margin is flat where it passes, the metric ``left`` is not."""
    points = np.array([point for _, point in candidates]).reshape(-1, 2)
    left = limit - points[:, 0]
    verdicts = tuple(Verdict.FAIL if value < 0 else Verdict.PASS for value in left)
    return Outcomes(
        tuple(name for name, _ in candidates),
        {"part.x": points[:, 0], "part.y": points[:, 1]},
        np.ones(len(points), dtype=np.bool_),
        {"left": left},
        {"R": np.minimum(left, 0.0), "S": left},
        {"R": verdicts, "S": verdicts},
    )


def brief(**more: object) -> Brief:
    return Brief((X, Y), ("a", "b"), 1, outcomes([], 9.0), **more)  # type: ignore[arg-type]


def test_the_share_of_a_range_and_its_mildest_failure() -> None:
    search = RareFailures(requirement="R", along="left").start(brief())
    while candidates := search.ask():
        search.tell(outcomes(candidates, 9.995))
    for name in ("a", "b"):
        found = search.probability(name)
        assert found is not None
        assert found.low <= 5e-4 <= found.high
        x, y = search.mildest(name) or (0.0, 0.0)
        # The nearest failure to the middle of the ranges; y does not matter.
        assert 9.995 < x < 9.997
        assert abs(y) < 0.2
    assert search.probability("a") != search.probability("b")


@pytest.mark.parametrize(
    ("options", "more", "what"),
    [
        ({}, {}, "needs a requirement, one of R, S"),
        ({"requirement": "T"}, {}, "needs a requirement"),
        ({"requirement": "R", "along": "right"}, {}, "unknown metric 'right'"),
        ({"requirement": "R"}, {"conditions": ((1.0,),)}, "no meaning with conditions"),
        ({"requirement": "R"}, {"allowed": lambda points: points[:, 0] > 0}, "no meaning with conditions"),
    ],
)
def test_what_it_cannot_estimate_is_refused(options: dict, more: dict, what: str) -> None:
    with pytest.raises(DseError, match=what):
        RareFailures(**options).start(brief(**more))
