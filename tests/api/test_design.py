"""Questions to a design space from Python: the answers are those of the command line."""

from __future__ import annotations

import pytest

import dse
from dse.domain.component import Component, Interface
from dse.domain.design import Alternative, Compound, DesignSpace, Part

EXCLUDED = {
    "sensor": "lidar_905nm",
    "video": "absent",
    "controller": "idm_acc",
    "brake": "hydraulic_booster",
    "powertrain": "combustion_ideal",
}


@pytest.fixture(scope="module")
def design(ws):
    return ws.designs["acc_vehicle"]


def test_a_count_is_a_number(design):
    assert design.count() == 227
    assert design.count(exact=True) == 227
    assert design.total == 624


def test_a_count_that_takes_long_is_an_estimate_that_says_so(design, monkeypatch):
    monkeypatch.setattr("dse.space.methods.engine.Engine.exact_count", lambda engine, most_work=0.0: None)
    found = design.count()
    assert isinstance(found, dse.Tally)
    assert found.low <= 227 <= found.high
    assert found.low <= int(found) <= found.high
    assert str(found).startswith("≈ ")


def test_a_question_is_narrowed_as_on_the_command_line(design):
    assert design.count(choose={"sensor": "radar_77ghz_mid"}, where="sum(mass) <= 280 kg") == 36
    with pytest.raises(dse.DseError, match="sensor"):
        design.count(choose={"sensr": "radar_77ghz_mid"})


def test_iterating_gives_every_configuration_in_the_order_of_the_file(design):
    every = [configuration.id for configuration in design]
    assert len(set(every)) == 227
    assert [configuration.id for configuration in design.list(3)] == every[:3]
    assert [configuration.id for configuration in design.list()] == every


def test_a_listed_configuration_can_be_narrowed_and_found_again(design):
    (first,) = design.list(1, choose={"sensor": "lidar_905nm"})
    assert first.choices["sensor"] == "lidar_905nm"
    assert design.configuration(first.id).choices == first.choices
    assert "connections" not in repr(first)


def test_draws_are_the_same_for_the_same_seed(design):
    drawn = [configuration.id for configuration in design.sample(5, seed=1)]
    assert drawn == [configuration.id for configuration in design.sample(5, seed=1)]
    assert drawn != [configuration.id for configuration in design.sample(5, seed=2)]


def test_the_best_is_what_no_other_beats(design):
    best = design.best("sum(cost)", n=2)
    cheapest = min(configuration.total("cost") for configuration in design)
    assert float(best[0].values[0]) == cheapest == 5150
    assert [unit.symbol for unit in best.units] == ["EUR"]
    (dearest,) = design.best(maximize="sum(cost)", n=1)
    assert float(dearest.values[0]) == max(configuration.total("cost") for configuration in design)
    assert "<td>5150 EUR</td>" in best._repr_html_()


def test_one_objective_is_for_best_and_several_are_for_pareto(design):
    with pytest.raises(dse.DseError, match="one objective"):
        design.best("sum(cost)", maximize="sum(power)")
    with pytest.raises(dse.DseError, match="two objectives"):
        design.pareto("sum(cost)")


def test_a_product_is_shown_in_the_units_it_is_written_in(design):
    frame = design.best("sum(power) * 2 h", n=1).to_pandas()
    watts = min(configuration.total("power") for configuration in design)
    assert (frame.iloc[0, 0], frame.attrs["units"]) == (2 * watts, {"sum(power) * 2 h": "W.h"})


def test_a_ranking_is_a_frame_with_units(design):
    frame = design.pareto("sum(cost)", "sum(power)").to_pandas()
    assert frame.loc["lmhuzsgxvx", "sum(cost)"] == 5150
    assert frame["sum(cost)"].is_monotonic_increasing
    assert frame.attrs["units"] == {"sum(cost)": "EUR", "sum(power)": "W"}


def test_an_excluded_configuration_is_explained(design):
    found = design.explain(EXCLUDED)
    assert not found.is_valid
    assert [entry.constraint.name for entry in found.broken] == ["stopping_sight"]
    assert found.nearest
    assert [change.path for change in found.nearest.changes] == ["sensor"]
    assert repr(found) == "<Explanation of 4ibagbspql: breaks stopping_sight>"


def test_some_choices_can_be_completed_or_say_what_stands_in_the_way(design):
    assert design.explain({"sensor": "lidar_905nm"}).is_valid
    found = design.explain({"sensor": "lidar_905nm", "brake": "hydraulic_booster"})
    assert not found.is_valid
    assert [constraint.name for constraint in found.conflict] == ["stopping_sight", "lidar_computing"]


def test_there_is_no_conflict_where_something_is_left(design):
    assert design.conflict() == ()
    blamed = design.conflict(choose={"sensor": "lidar_905nm", "brake": "hydraulic_booster"})
    assert [constraint.name for constraint in blamed] == ["stopping_sight", "lidar_computing"]


def test_constraints_and_choices_tell_what_they_do(design):
    assert [entry.constraint.name for entry in design.constraints() if entry.is_redundant] == [
        "budget",
        "no_model_on_camera",
    ]
    assert [entry.after.value for entry in design.constraints("mass")] == [566]
    dead = [entry.choice for entry in design.choices(choose={"controller": "pi_time_gap_acc"}) if entry.dead]
    assert "lidar_905nm" in dead


def test_a_refined_design_has_the_configurations_it_kept(design):
    smaller = design.refine({"sensor": ["radar_77ghz_mid", "radar_77ghz_long"], "video": ["absent"]})
    kept = {c.id for c in design if c.choices["sensor"].startswith("radar") and "video" not in c.choices}
    assert {configuration.id for configuration in smaller} == kept
    assert design.compare(smaller).common.value == len(kept)


def test_configurations_are_a_frame_with_units(design):
    frame = design.to_pandas()
    assert len(frame) == 227
    assert frame.attrs["units"]["sum(cost)"] == "EUR"
    first = next(iter(design))
    assert frame.index[0] == first.id
    assert frame.loc[first.id, "sensor"] == first.choices["sensor"]
    assert frame.loc[first.id, "sum(cost)"] == first.total("cost")
    assert list(design.to_pandas(2).index) == list(frame.index[:2])


def test_names_from_files_are_escaped_in_tables():
    part = Part(Component("<b>x</b>", Interface("i", ()), None, {}, ()))
    space = DesignSpace("<i>", Compound("<i>", {"a": Alternative((part, part))}))
    assert "&lt;b&gt;x&lt;/b&gt;" in dse.Design.of(space)._repr_html_()
    assert "<b>" not in dse.Design.of(space)._repr_html_()
