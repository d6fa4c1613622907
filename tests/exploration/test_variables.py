"""Variables on their scales, in values and distributions, and the unit cube."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, strategies as st

from dse.domain.distribution import Distribution, cumulative, median, quantile, support
from dse.domain.sampler import Brief, DesignVariable, Role, Scale
from dse.exploration.variables import at_conditions, conditions_of, levels, scaled, unit_of
from dse.testing.samplers import outcomes
from dse.units import DIMENSIONLESS

PLAIN = DesignVariable("a.x", 2.0, 8.0, 4, 3.0, DIMENSIONLESS)
LOG = replace(PLAIN, name="a.y", low=0.01, high=100.0, levels=5, scale=Scale.LOG)
FEW = replace(PLAIN, name="a.z", low=1.0, high=7.0, levels=3, values=(1.0, 2.0, 7.0))
KINDS = {
    "normal": Distribution("normal", {"mean": 3.0, "sd": 0.5}),
    "lognormal": Distribution("lognormal", {"mean": 3.0, "sd": 0.5}),
    "uniform": Distribution("uniform", {"low": 1.0, "high": 4.0}),
    "triangular": Distribution("triangular", {"low": 1.0, "mode": 2.0, "high": 4.0}),
    "beta": Distribution("beta", {"alpha": 2.0, "beta": 3.0, "low": 1.0, "high": 4.0}),
    "empirical": Distribution("empirical", values=(1.0, 2.0, 2.5, 7.0)),
}


def test_levels_on_a_logarithmic_scale_have_equal_ratios():
    assert levels(LOG) == pytest.approx((0.01, 0.1, 1.0, 10.0, 100.0), rel=1e-12)
    assert levels(LOG)[0] == 0.01
    assert levels(LOG)[-1] == 100.0


def test_values_share_the_side_of_the_cube_equally():
    unit = np.array([[0.0], [0.33], [0.34], [0.66], [0.67], [1.0]])
    assert scaled(unit, (FEW,)).ravel().tolist() == [1.0, 1.0, 2.0, 2.0, 7.0, 7.0]


@given(st.lists(st.tuples(*[st.floats(0, 1)] * 4), min_size=1, max_size=20), st.sampled_from(sorted(KINDS)))
def test_the_way_back_from_a_point_leads_to_the_same_point(unit, kind):
    low, high = support(KINDS[kind])
    uncertain = replace(PLAIN, name="a.u", low=low, high=high, role=Role.UNCERTAIN, distribution=KINDS[kind])
    variables = (PLAIN, LOG, FEW, uncertain)
    points = scaled(np.array(unit), variables)
    for column, variable in enumerate(variables):
        assert ((points[:, column] >= variable.low) & (points[:, column] <= variable.high)).all()
    again = scaled(unit_of(points, variables), variables)
    np.testing.assert_allclose(again, points, rtol=1e-7, atol=1e-7)


@pytest.mark.parametrize("kind", sorted(set(KINDS) - {"empirical"}))
def test_what_is_drawn_has_the_mean_and_deviation_of_its_distribution(kind):
    known = {"normal": (3.0, 0.5), "lognormal": (3.0, 0.5), "uniform": (2.5, 3 / math.sqrt(12))}
    known["triangular"] = ((1 + 2 + 4) / 3, math.sqrt((1 + 4 + 16 - 2 - 4 - 8) / 18))
    known["beta"] = (1 + 3 * 2 / 5, 3 * math.sqrt(2 * 3 / (25 * 6)))
    mean, deviation = known[kind]
    drawn = quantile(KINDS[kind], *support(KINDS[kind]), (np.arange(20_000) + 0.5) / 20_000)
    # The midpoint rule over 20,000 strata: what lies in the tails' last strata is missing.
    assert drawn.mean() == pytest.approx(mean, rel=1e-4)
    assert drawn.std() == pytest.approx(deviation, rel=1e-3)
    assert float(cumulative(KINDS[kind], *support(KINDS[kind]), np.array([median(KINDS[kind])]))[0]) == pytest.approx(
        0.5
    )


def test_correlated_variables_have_the_correlation_of_the_normal_ones_behind_them():
    uncertain = [
        replace(PLAIN, name=name, low=-9.0, high=9.0, role=Role.UNCERTAIN, distribution=Distribution("normal", numbers))
        for name, numbers in (("a.u", {"mean": 0.0, "sd": 1.0}), ("a.v", {"mean": 0.0, "sd": 1.0}))
    ]
    unit = np.random.default_rng(1).random((20_000, 3))
    points = scaled(unit, (PLAIN, *uncertain), {("a.u", "a.v"): -0.7})
    # The standard error of a correlation of n normal pairs is (1 - r^2) / sqrt(n), here 0.0036: four of it.
    assert np.corrcoef(points[:, 1], points[:, 2])[0, 1] == pytest.approx(-0.7, abs=0.015)
    assert abs(np.corrcoef(points[:, 0], points[:, 1])[0, 1]) < 0.03
    assert points[:, 0].tolist() == scaled(unit[:, :1], (PLAIN,)).ravel().tolist()


def test_every_point_meets_every_condition_in_the_order_of_the_variables():
    road, load = (replace(FEW, name=name, role=Role.CONDITION) for name in ("b.road", "b.load"))
    load = replace(load, values=(5.0, 6.0))
    variables = (road, PLAIN, load)
    brief = Brief(variables, (), 0, outcomes([]), conditions=conditions_of(variables))
    points = at_conditions(np.array([[2.5], [3.5]]), brief)
    assert points[:6].tolist() == [[r, 2.5, w] for r in (1.0, 2.0, 7.0) for w in (5.0, 6.0)]
    assert points[6:, 1].tolist() == [3.5] * 6
