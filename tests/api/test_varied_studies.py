"""Studies that vary more than ranges, as a user would run them."""

from __future__ import annotations

import shutil
from dataclasses import replace
from pathlib import Path

import pytest

import dse
from dse.api import Towards, refine, what_if_run
from dse.api.studies.bench import Bench
from dse.testbench.study import with_values
from dse.units import parse_unit

STUDY = """study: varied
testbench: acc_following
configurations: {where: "brake is hydraulic_booster and powertrain is combustion_ideal and sensor is radar_77ghz_mid
  and video is absent"}
design_variables:
  controller.kp_speed: {range: [0.1 1/s, 3 1/s], scale: log}
  controller.kd_speed: {values: [0, 0.5, 1]}
  controller.kp_gap: {range: [0.05 1/s2, 0.3 1/s2]}
  controller.kd_gap: {derived: 5 s * controller.kp_gap}
constraints: [controller.kp_speed < 2 1/s or controller.kd_speed > 0.2]
conditions:
  world.lead_speed: {values: [50 km/h, 60 km/h]}
uncertain:
  world.mass: {normal: {mean: 1500 kg, sd: 50 kg}}
objectives: [minimize sum(cost), minimize gap_undershoot]
sampler: {sobol: {samples: 4}}
keep_waveforms: none
seed: 3
"""


@pytest.fixture(scope="module")
def varied(folder: Path, tmp_path_factory: pytest.TempPathFactory):
    place = shutil.copytree(folder, tmp_path_factory.mktemp("varied") / "work")
    (place / "testbenches" / "varied.pet.yaml").write_text(STUDY, encoding="utf-8")
    study = dse.open(place).studies["varied"]
    return study, study.explore(place / "out" / "varied", workers=1)


@pytest.mark.thorough
def test_a_study_varies_what_there_is_in_each_configuration(varied):
    study, results = varied
    frame = results.to_pandas()
    assert set(frame["world.lead_speed"]) == {50, 60}
    assert set(frame["controller.kd_speed"].dropna()) <= {0.0, 0.5, 1.0}
    kinds = frame.groupby("configuration")[["controller.kp_speed", "controller.kp_gap"]].agg(lambda v: v.isna().all())
    assert len(kinds) == 3
    assert sorted(map(tuple, kinds.to_numpy().tolist())) == [(False, False), (False, True), (True, True)]
    # What a configuration does not have does not multiply its runs.
    assert not frame.duplicated(["configuration", *(each.name for each in study.noun.variables)]).any()
    number = int(frame.index[frame["controller.kp_gap"].notna()][0])
    assert "controller.kp_gap" in results.run(number).point
    assert "controller.kp_gap" not in results.run(int(frame.index[frame["controller.kp_gap"].isna()][0])).point


@pytest.mark.thorough
def test_a_derived_parameter_is_what_it_would_be_if_it_were_given(varied):
    study, results = varied
    frame = results.to_pandas("si")
    row = frame[frame["controller.kp_gap"].notna()].iloc[0]
    point = {name: row[name] for name in (each.name for each in study.noun.variables)}
    given = {**point, "controller.kd_gap": 5 * point["controller.kp_gap"]}
    bench = with_values(replace(study.bench.noun, derived=()), {name: float(value) for name, value in given.items()})
    run = Bench.of(bench).simulate(row["configuration"])
    assert run.metrics["gap_undershoot"] == row["gap_undershoot"]
    assert run.metrics["consumption"] == row["consumption"]


def test_designs_are_ranked_over_their_conditions(varied):
    _, results = varied
    found = results.best(3, minimize=["consumption"])
    values = [each.values[0] for each in found.best]
    assert values == sorted(values)
    frame = results.to_pandas()
    for each in found.best:
        runs = frame.loc[list(each.runs)]
        assert set(runs["world.lead_speed"]) == {50, 60}
        assert not runs[["R1.verdict", "R2.verdict"]].isin(["fail"]).any(axis=None)
        assert each.values[0] == results.to_pandas("si").loc[runs["consumption"].idxmax(), "consumption"]


@pytest.mark.parametrize("towards", [Towards.AROUND, Towards.FRONT, Towards.BAND])
def test_the_next_study_can_be_read_and_lies_within_the_last(varied, towards, monkeypatch):
    study, results = varied
    place = results.folder.parents[1]
    monkeypatch.chdir(place)
    (place / "testbenches" / "next.pet.yaml").write_text(refine(results.folder, "next", towards, run=0, share=0.2))
    narrowed = dse.open(place).studies["next"].noun
    wide = {variable.name: variable for variable in study.noun.variables}
    assert [variable.name for variable in narrowed.variables] == [*wide]
    for variable in narrowed.variables:
        assert wide[variable.name].low <= variable.low <= variable.high <= wide[variable.name].high
    assert narrowed.selection.ids
    assert [each.expression.text for each in narrowed.bench.derived] == ["5 s * controller.kp_gap"]
    assert (narrowed.sampler.name == "boundary") == (towards is Towards.BAND)


@pytest.mark.thorough
def test_a_point_of_every_configuration_can_be_tried_again(varied):
    _, results = varied
    units = {each.name: parse_unit(each.unit) for each in results.definition.variables}
    frame = results.to_pandas()
    for number in frame.groupby("configuration").head(1).index.tolist():
        run = results.run(number)
        shown = {name: units[name].from_si(float(value)) for name, value in run.point.items()}
        tried = what_if_run(results.definition, run.configuration, shown, workspace=results.folder)
        assert tried.changed == ()
        assert tried.run.metrics.keys() == run.metrics.keys()
        # What is shown may be a rounding away from what was simulated.
        for name, value in run.metrics.items():
            assert tried.run.metrics[name] == pytest.approx(value, rel=1e-6, abs=1e-9, nan_ok=True)


SEARCH = """study: search
testbench: acc_following
design_variables: {controller.kp_speed: {range: [0.1 1/s, 3 1/s], scale: log}}
objectives: ["minimize sum(cost) + 1000 EUR/kWh * consumption * 10 km"]
sampler: {nsga2: {population: 4, evaluations: 7}}
keep_waveforms: none
"""


QUICK = """constraints:
  quick: {require: powertrain is combustion_ideal or powertrain is bev_ideal, because: they are built at once}
"""


@pytest.mark.thorough
def test_a_search_over_the_whole_space_goes_on_where_it_was(folder, tmp_path):
    """What it looks for is known only when configurations are."""
    place = shutil.copytree(folder, tmp_path / "work")
    design = place / "designs" / "acc_vehicle.yaml"
    text = design.read_text(encoding="utf-8")
    assert text.count("\nconstraints:\n") == 1
    design.write_text(text.replace("constraints:\n", QUICK), encoding="utf-8")
    (place / "testbenches" / "search.pet.yaml").write_text(SEARCH, encoding="utf-8")
    study = dse.open(place).studies["search"]
    results = study.explore(place / "out" / "search", workers=1)
    first = results.to_pandas("si")
    assert 4 <= len(first) <= 7
    assert len(set(first["configuration"])) == len(results.definition.configurations) > 1
    again = study.explore(place / "out" / "search", workers=1)
    assert again.explored is not None
    assert again.explored.simulated == 0
    assert again.to_pandas("si").equals(first)
    fused = study.explore(place / "out" / "fused", workers=1, fuse=True, fresh=True)
    assert fused.explored is not None
    assert fused.explored.simulated == len(first)
    assert fused.to_pandas("si").equals(first)
    totals = {each.id: each.totals["cost"].value for each in results.definition.configurations}
    for each in results.best().best:
        consumption = first.loc[each.runs[0], "consumption"]
        assert each.values[0] == pytest.approx(totals[each.configuration] + 1000 / 3.6e6 * consumption * 1e4)
