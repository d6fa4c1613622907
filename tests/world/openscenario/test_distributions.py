"""Distributions of the parameters of a scenario become cases."""

from __future__ import annotations

from pathlib import Path

import pytest
from scenario_texts import listed, ranged, scenario, single, stochastic, together, variation

from dse.errors import DseError
from dse.world import Variation, is_variation, read_scenario, read_variation

NCAP = Path(__file__).parents[4] / "shared" / "data" / "ncap" / "OpenSCENARIO" / "NCAP"
needs_ncap = pytest.mark.skipif(not NCAP.is_dir(), reason="the Euro NCAP files are not beside the project")


def read(tmp_path: Path, text: str) -> Variation:
    (tmp_path / "base.xosc").write_text(scenario(), encoding="utf-8")
    (tmp_path / "variation.xosc").write_text(text, encoding="utf-8")
    return read_variation(tmp_path / "variation.xosc")


def test_cases_are_all_combinations_and_the_last_distribution_varies_fastest(tmp_path: Path) -> None:
    found = read(tmp_path, variation("base.xosc", listed("a", 1, "x"), together({"b": 1, "c": 2}, {"b": 3, "c": 4})))
    assert found.scenario == tmp_path / "base.xosc"
    assert found.cases == (
        {"a": "1", "b": "1", "c": "2"},
        {"a": "1", "b": "3", "c": "4"},
        {"a": "x", "b": "1", "c": "2"},
        {"a": "x", "b": "3", "c": "4"},
    )


def test_a_range_has_both_ends_as_they_are_written(tmp_path: Path) -> None:
    found = read(tmp_path, variation("base.xosc", ranged("a", 0.1, 0.5, 0.1)))
    assert [case["a"] for case in found.cases] == ["0.1", "0.2", "0.3", "0.4", "0.5"]
    open_end = read(tmp_path, variation("base.xosc", ranged("a", -1, 1e1, 4)))
    assert [case["a"] for case in open_end.cases] == ["-1", "3", "7"]


def test_distributions_that_a_study_has_are_uncertain_parameters(tmp_path: Path) -> None:
    limits = '<Range lowerLimit="1" upperLimit="5"/>'
    found = read(
        tmp_path,
        variation(
            "base.xosc",
            stochastic("a", f'<NormalDistribution expectedValue="3" variance="4">{limits}</NormalDistribution>'),
            stochastic("b", f"<UniformDistribution>{limits}</UniformDistribution>"),
            stochastic("c", '<LogNormalDistribution expectedValue="2" variance="0.25"/>'),
            stochastic=20,
        ),
    )
    assert (found.runs, found.cases) == (20, ({},))
    shown = {name: (each.distribution.kind, dict(each.distribution.numbers), each.low, each.high)
             for name, each in found.uncertain.items()}  # fmt: skip
    assert shown == {
        "a": ("normal", {"mean": 3.0, "sd": 2.0}, 1.0, 5.0),
        "b": ("uniform", {"low": 1.0, "high": 5.0}, 1.0, 5.0),
        "c": ("lognormal", {"mean": 2.0, "sd": 0.5}, None, None),
    }


REFUSED = {
    "twice": (variation("base.xosc", listed("a", 1), together({"a": 1})), "the parameter 'a' is distributed twice", 7),
    "in a set twice": (
        variation("base.xosc", "<DeterministicMultiParameterDistribution><ValueSetDistribution><ParameterValueSet>"
                  '<ParameterAssignment parameterRef="a" value="1"/>\n<ParameterAssignment parameterRef="a" value="2"/>'
                  "</ParameterValueSet></ValueSetDistribution></DeterministicMultiParameterDistribution>"),
        "the parameter 'a' is assigned twice", 7),
    "own": (variation("base.xosc", single("a", '<UserDefinedDistribution type="t"/>')),
            "<UserDefinedDistribution> is not supported", 6),
    "no step": (variation("base.xosc", ranged("a", 0, 1, 0)), "'stepWidth' is 0, not above 0", 6),
    "a step of NaN": (variation("base.xosc", ranged("a", 0, 1, "NaN")), "'stepWidth' is 'NaN', not a number", 6),
    "an endless range": (variation("base.xosc", ranged("a", 0, "INF", 1)), "'upperLimit' is infinite", 6),
    "a fine step": (variation("base.xosc", ranged("a", 0, 1, 1e-9)), "1,000,000,001 values: at most 100,000", 6),
    "a range upside down": (variation("base.xosc", ranged("a", 1, 0, 1)), "'upperLimit' is below 'lowerLimit'", 6),
    "no values": (variation("base.xosc", listed("a")), "has no values", 6),
    "too many": (variation("base.xosc", *(ranged(n, 1, 99, 1) for n in "abcd")), "96,059,601 cases: at most", 5),
    "no file": (variation("other.xosc", listed("a", 1)), "the scenario 'other.xosc' does not exist", 4),
    "no kind": (variation("base.xosc").replace("Deterministic", "Random"),
                "has no <Deterministic> or <Stochastic>", 3),
    "a scenario": (scenario(), "has no <ParameterValueDistribution>", 2),
    "histogram": (variation("base.xosc", stochastic("a", "<Histogram/>"), stochastic=1),
                  "<Histogram> is not supported", 6),
    "no variance": (variation("base.xosc", stochastic("a", '<NormalDistribution expectedValue="1" variance="-1"/>'),
                              stochastic=1), "its standard deviation must be above 0", 6),
    "no runs": (variation("base.xosc", stochastic=1).replace('"1">', '"0">'), "'numberOfTestRuns' is 0, not 1 to", 5),
}  # fmt: skip


@pytest.mark.parametrize("case", REFUSED)
def test_what_is_wrong_is_one_problem_at_its_line(tmp_path: Path, case: str) -> None:
    text, what, line = REFUSED[case]
    with pytest.raises(DseError) as error:
        read(tmp_path, text)
    (problem,) = error.value.problems
    assert what in problem.what
    assert problem.where is not None
    assert problem.where.file.endswith("variation.xosc")
    assert problem.where.line == line


def test_a_scenario_outside_the_workspace_is_refused(tmp_path: Path) -> None:
    (tmp_path / "inner").mkdir()
    (tmp_path / "base.xosc").write_text(scenario(), encoding="utf-8")
    path = tmp_path / "inner" / "variation.xosc"
    path.write_text(variation("../base.xosc", listed("a", 1)), encoding="utf-8")
    with pytest.raises(DseError, match="is outside the workspace"):
        read_variation(path, tmp_path / "inner")
    assert read_variation(path, tmp_path).cases == ({"a": "1"},)


# Two files have two lists of value sets over different parameters, speeds (8) and sides (2): 16 cases each.
@needs_ncap
def test_the_variations_of_euro_ncap_expand_to_their_cases() -> None:
    files = [path for path in sorted(NCAP.rglob("*.xosc")) if "Variations" in path.parts]
    counts = {"/".join(path.parts[-2:]): len(read_variation(path).cases) for path in files}
    assert all(map(is_variation, files))
    assert (len(files), sum(counts.values())) == (109, 1183)
    assert counts["ExtendedRange/CCCscp.xosc"] == 8 * 2
    assert counts["StandardRange/CCCscp.xosc"] == 5 * 5 * 2
    assert counts["Variations/NCAP_AEB_C2C_CCRs_FCW_Variation_2023.xosc"] == 6 * 5
    assert counts["Variations/NCAP_AEB_C2C_CCRm_Variation_2023.xosc"] == 11 * 5


@needs_ncap
@pytest.mark.thorough
def test_each_case_of_euro_ncap_is_a_scenario() -> None:
    for path in sorted(path for path in NCAP.rglob("*.xosc") if "Variations" in path.parts):
        found = read_variation(path)
        for case in found.cases:
            made = read_scenario(found.scenario, case)
            known = {each.name for each in made.parameters} | made.decided.keys()
            assert case.keys() <= known
