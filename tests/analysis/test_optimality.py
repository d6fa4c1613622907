"""How strong an optimisation's claim is: what bounds it, and how it came about."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from known_functions import study, variable

from dse.analysis import ranked, stages, static_bound, strength
from dse.domain.definition import DefinedTotal
from dse.domain.sampler import Objective
from dse.loading import Workspace
from dse.space import OpenedSpace, open_space
from dse.storage import RunTable

ROOT = Path(__file__).parents[2]
USE, COST = Objective("use"), Objective("cost", is_total=True)
RUNS = [
    (0.2, 0, 5.0, 0.1),
    (0.2, 1, 6.0, 0.2),
    (0.4, 0, 4.0, 0.3),
    (0.4, 1, 5.5, 0.4),
    (0.6, 0, 3.0, 0.1),
    (0.6, 1, 3.5, 0.8),
]
"""Gain, slope, use and slip, which has to be at most 0.5."""


def _table(runs: Sequence[tuple[float, ...]]) -> RunTable:
    gain, slope, use, slip = np.array(runs, dtype=np.float64).T
    variables = [variable("gain"), variable("slope", role="condition", values=(0.0, 1.0))]
    table = study(np.array([gain, slope]).T, {"use": use, "slip": slip}, {"slip": 0.5}, variables=variables)
    definition = table.header.definition
    priced = tuple(replace(each, totals={"cost": DefinedTotal(100.0, "EUR")}) for each in definition.configurations)
    return replace(table, header=replace(table.header, definition=replace(definition, configurations=priced)))


@pytest.fixture(scope="module")
def acc() -> OpenedSpace:
    return open_space(Workspace(ROOT).design("acc_vehicle"))


def test_the_bound_of_a_sum_is_the_best_of_all_configurations(acc: OpenedSpace) -> None:
    costs = [sum(part.properties["cost"].si for part in one.parts.values() if "cost" in part.properties)
             for one in acc.configurations()]  # fmt: skip
    assert static_bound(acc, COST) == float(min(costs, default=Fraction(0)))
    assert static_bound(acc, Objective("cost", maximize=True, is_total=True)) == float(max(costs))


def test_nothing_bounds_a_metric(acc: OpenedSpace) -> None:
    assert static_bound(acc, USE) is None


def test_a_claim_says_of_how_much_it_is_the_best_and_what_bounds_it() -> None:
    table = _table(RUNS)
    found = ranked(table, [USE, COST], 5)
    definition = table.header.definition
    assert strength(found, 6, (None, 80.0), definition) == (
        "best of 6 runs of 3 designs; nothing but simulation bounds use; "
        "no configuration has less than sum(cost) = 80 EUR"
    )
    assert strength(found, 6, (None, 100.0), definition).endswith("100 EUR, which is reached")


def test_the_volume_grows_with_the_runs_to_all_there_is() -> None:
    """The second design is feasible once its second run is there."""
    found = stages(_table(RUNS), [USE], (1, 2, 4, 6))
    assert [(each.runs, each.feasible) for each in found] == [(1, 0), (2, 1), (4, 2), (6, 2)]
    assert [each.volume for each in found] == [0.0, 0.0, 1.0, 1.0]


def test_of_two_objectives_the_volume_is_what_both_dominate() -> None:
    use, slip = np.array([4.0, 2.0, 1.0, 3.0]), np.array([0.1, 0.2, 0.4, 0.4])
    rows = [(0.1 * n, 0, u, s) for n, (u, s) in enumerate(zip(use, slip, strict=True))]
    found = stages(_table(rows), [USE, Objective("slip")], (1, 2, 3, 4))
    assert [each.volume for each in found] == pytest.approx([0.0, 1.0, 1.0, 1.0])


def test_without_a_feasible_design_there_is_no_volume() -> None:
    (found,) = stages(_table([(0.2, 1, 3.5, 0.8)]), [USE], (1,))
    assert (found.feasible, np.isnan(found.volume)) == (0, True)
