"""Two designs in the same draws: what they differ in, and how few draws show it."""

from __future__ import annotations

import numpy as np
import pytest

from dse.analysis.paired import PairedDraws, _counts


def drawn(n: int, rates: tuple[float, float], *, common: bool, seed: int) -> tuple[np.ndarray, np.ndarray]:  # type: ignore[type-arg]  # of truth values
    random = np.random.default_rng(seed)
    first = random.random(n)
    second = first if common else random.random(n)
    return first < rates[0], second < rates[1]


def paired(first: np.ndarray, second: np.ndarray, *, random: bool = True) -> PairedDraws:  # type: ignore[type-arg]
    counted = _counts(first, second, random=random)
    return PairedDraws("R", (), "", *counted[:4], 0.0, 0.0, *counted[4:])


def test_draws_are_counted_by_who_meets_them() -> None:
    first, second = np.array([True, True, True, False, False]), np.array([True, False, False, True, False])
    found = paired(first, second)
    assert (found.both, found.first, found.second, found.neither) == (1, 2, 1, 1)
    assert found.difference == pytest.approx(0.2)
    # Agresti and Min: (b - c) / (n + 2) = 1/7, half a width of 1.96 sqrt(b + c + 1 - (b - c)^2 / (n + 2)) / (n + 2).
    assert (found.low + found.high) / 2 == pytest.approx(1 / 7)
    assert found.high - found.low == pytest.approx(2 * 1.96 * np.sqrt(4 - 1 / 7) / 7, rel=1e-4)


def test_designs_that_always_agree_are_not_told_apart() -> None:
    same = np.ones(20, dtype=np.bool_)
    found = paired(same, same)
    assert found.low < 0 < found.high
    assert not found.is_certain
    exact = paired(same, ~same, random=False)
    assert exact.low == exact.high == exact.difference == 1


def test_a_difference_of_3_percent_is_found_with_a_third_of_the_draws_of_independent_streams() -> None:
    n, rates = 700, (0.53, 0.5)
    together = [paired(*drawn(n, rates, common=True, seed=s)).is_certain for s in range(200)]
    apart = [paired(*drawn(3 * n, rates, common=False, seed=s)).is_certain for s in range(200)]
    assert np.mean(together) > 0.95
    assert np.mean(apart) < 0.7


@pytest.mark.parametrize("rates", [(0.9, 0.9), (0.6, 0.5)])
def test_the_interval_covers_the_difference(rates: tuple[float, float]) -> None:
    covered = []
    for seed in range(600):
        found = paired(*drawn(40, rates, common=seed % 2 == 0, seed=seed))
        covered.append(found.low <= rates[0] - rates[1] <= found.high)
    # It is approximate: the standard error of 600 tries is 0.9 %.
    assert np.mean(covered) >= 0.915
