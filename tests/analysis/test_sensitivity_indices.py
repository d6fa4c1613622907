from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from known_functions import ISHIGAMI, g_function, g_indices, ishigami, study, variable

from dse.analysis import Topic, findings, morris_effects, sobol_indices, study_data
from dse.domain.definition import DefinedSampler
from dse.domain.sampler import Brief, DesignVariable, Outcomes
from dse.errors import DseError
from dse.loading import SAMPLERS
from dse.units import DIMENSIONLESS

_UNIT = DesignVariable("x", 0.0, 1.0, 0, 0.5, DIMENSIONLESS)


def _points(kind, width, **options):
    variables = tuple(replace(_UNIT, name=f"x{number + 1}") for number in range(width))
    nothing = Outcomes((), {each.name: np.zeros(0) for each in variables}, np.zeros(0, dtype=np.bool_), {}, {}, {})
    sampler = SAMPLERS.get(kind).model_validate(options)
    return np.array(sampler.values(Brief(variables, (), 1, nothing))), DefinedSampler(kind, sampler.options())


def _sobol(function, width, base, *, lacking=0, second=False):
    points, sampler = _points("sobol_indices", width, base=base, second_order=second)
    done = np.ones(len(points), dtype=np.bool_)
    done[np.random.default_rng(0).permutation(len(points))[:lacking]] = False
    return study_data(study(points, {"y": function(points)}, sampler=sampler, done=done))


def test_designed_indices_of_ishigami_are_the_published_ones():
    """Within 0.03 at 1,024 blocks: SALib's own intervals are 0.03 … 0.09 wide."""
    found = sobol_indices(_sobol(ishigami, 3, 1024), "y")
    assert (found.blocks, found.lacking) == (1024, 0)
    for each, (first, total) in zip(found.factors, ISHIGAMI.values(), strict=True):
        assert each.first.value == pytest.approx(first, abs=0.03)
        assert each.total.value == pytest.approx(total, abs=0.03)
        assert each.total.low < total < each.total.high


def test_designed_indices_of_the_g_function_are_the_published_ones():
    found = sobol_indices(_sobol(g_function, 4, 1024), "y")
    for each, (first, total) in zip(found.factors, g_indices(), strict=True):
        assert each.first.value == pytest.approx(first, abs=0.03)
        assert each.total.value == pytest.approx(total, abs=0.03)


@pytest.mark.parametrize("second", [False, True])
def test_they_are_what_salib_makes_of_its_own_design(second):
    """The same design straight from SALib, analysed by SALib: no run is mixed up on the way."""
    from SALib.analyze import sobol as analysis
    from SALib.sample import sobol

    problem = {"num_vars": 3, "names": ["x1", "x2", "x3"], "bounds": [[0.0, 1.0]] * 3}
    points = sobol.sample(problem, 64, calc_second_order=second, seed=2)
    theirs = analysis.analyze(problem, ishigami(points), calc_second_order=second, seed=1)
    ours = sobol_indices(_sobol(ishigami, 3, 64, second=second), "y")
    assert [each.first.value for each in ours.factors] == pytest.approx(theirs["S1"].tolist(), rel=1e-12)
    assert [each.total.value for each in ours.factors] == pytest.approx(theirs["ST"].tolist(), rel=1e-12)


def test_designed_indices_are_told():
    points, sampler = _points("sobol_indices", 3, base=256)
    found = findings(study(points, {"y": ishigami(points)}, {"y": 3.0}, sampler=sampler))
    (text,) = [each.text for each in found if each.topic is Topic.TOGETHER]
    assert text.startswith("y: x1 6")
    assert re.search(r", first-order \d+ %\), x2 ", text)
    assert text.endswith("; Sobol' indices of 256 blocks")


def test_elementary_effects_are_told_in_the_unit_of_the_metric():
    points, sampler = _points("morris", 2, trajectories=8)
    found = findings(study(points, {"y": 3 * points[:, 0]}, {"y": 1.0}, sampler=sampler))
    (text,) = [each.text for each in found if each.topic is Topic.TOGETHER]
    assert text.startswith("y changes by 3 (± ")
    assert " over the range of x1, " in text
    assert text.endswith("; 8 trajectories")


def test_the_order_of_the_runs_does_not_matter():
    """As in a study that was extended, or whose shards were merged."""
    data = _sobol(ishigami, 3, 64)
    mixed = data.part(np.random.default_rng(1).permutation(len(data)))
    assert sobol_indices(mixed, "y") == sobol_indices(data, "y")


def test_a_logarithmic_variable_has_the_indices_of_its_logarithm():
    unit, sampler = _points("sobol_indices", 3, base=64)
    points = unit.copy()
    points[:, 0] = np.exp(unit[:, 0] * np.log(1000.0))
    variables = [variable("x1", low=1.0, high=1000.0, scale="log"), variable("x2"), variable("x3")]
    table = study(points, {"y": ishigami(unit)}, sampler=sampler, variables=variables)
    plain = sobol_indices(_sobol(ishigami, 3, 64), "y")
    found = sobol_indices(study_data(table), "y")
    assert [each.total.value for each in found.factors] == pytest.approx([e.total.value for e in plain.factors])


def test_a_few_lacking_blocks_are_left_out_and_counted():
    found = sobol_indices(_sobol(ishigami, 3, 512, lacking=3), "y")
    assert (found.blocks, found.lacking) == (509, 3)
    assert found.factors[1].total.value == pytest.approx(ISHIGAMI["x2"][1], abs=0.06)


def test_indices_are_withheld_where_failed_runs_would_distort_them():
    with pytest.raises(DseError, match=r"y: 2\d\d of 256 blocks .* \(384 runs failed\): .* distorted"):
        sobol_indices(_sobol(ishigami, 3, 256, lacking=384), "y")


def test_indices_of_a_constant_are_withheld():
    with pytest.raises(DseError, match="y: it is the same in every run"):
        sobol_indices(_sobol(lambda points: np.ones(len(points)), 3, 16), "y")


def test_half_a_design_is_no_design():
    data = _sobol(ishigami, 3, 64)
    with pytest.raises(DseError, match="160 of 320 runs of the design are not there"):
        sobol_indices(data.part(np.arange(160)), "y")


def test_another_sampler_has_no_design():
    points = np.random.default_rng(0).random((40, 2))
    with pytest.raises(DseError, match="the study's sampler is 'sobol'"):
        sobol_indices(study_data(study(points, {"y": points[:, 0]})), "y")


def test_elementary_effects_of_a_plane_are_its_slopes():
    points, sampler = _points("morris", 3, trajectories=8)
    data = study_data(study(points, {"y": points @ np.array([3.0, -2.0, 0.0])}, sampler=sampler))
    found = morris_effects(data, "y")
    assert [each.size.value for each in found.factors] == pytest.approx([3.0, 2.0, 0.0])
    assert [each.spread for each in found.factors] == pytest.approx([0.0, 0.0, 0.0], abs=1e-12)


def test_elementary_effects_tell_what_acts_with_others_by_their_spread():
    points, sampler = _points("morris", 3, trajectories=20)
    data = study_data(study(points, {"y": points[:, 0] * points[:, 1] + points[:, 2]}, sampler=sampler))
    first, _, third = morris_effects(data, "y").factors
    assert first.spread > 0.2
    assert third.spread == pytest.approx(0.0, abs=1e-12)


def test_correlated_variables_are_refused_by_the_design():
    variables = (replace(_UNIT, name="x1"), replace(_UNIT, name="x2"))
    nothing = Outcomes((), {"x1": np.zeros(0), "x2": np.zeros(0)}, np.zeros(0, dtype=np.bool_), {}, {}, {})
    brief = Brief(variables, (), 1, nothing, correlations={("x1", "x2"): 0.5})
    for kind, options in (("sobol_indices", {"base": 4}), ("morris", {"trajectories": 4})):
        with pytest.raises(DseError, match="some are correlated"):
            SAMPLERS.get(kind).model_validate(options).values(brief)


@pytest.mark.parametrize(
    ("kind", "options", "why"),
    [
        ("sobol_indices", {"base": 100}, "not a power of two: take 64"),
        ("morris", {"trajectories": 4, "levels": 5}, "odd"),
    ],
)
def test_options_that_make_no_design_are_refused(kind, options, why):
    with pytest.raises(ValueError, match=why):
        SAMPLERS.get(kind).model_validate(options)
