"""Any point of a study, simulated now."""

from __future__ import annotations

from pathlib import Path

import pytest

import dse
from dse.api import what_if_run
from dse.errors import DseError
from dse.units import parse_unit


def shown(results: dse.Results, number: int) -> dict[str, float]:
    """The point of a run as a reader sees it."""
    point = results.run(number).point
    units = {each.name: parse_unit(each.unit) for each in results.definition.variables}
    return {name: units[name].from_si(float(value)) for name, value in point.items()}


@pytest.mark.thorough
def test_the_point_of_a_run_gives_its_run(results: dse.Results, folder: Path) -> None:
    run = results.run(2)
    tried = what_if_run(results.definition, run.configuration, shown(results, 2), workspace=folder)
    assert tried.changed == ()
    assert tried.run.metrics == run.metrics
    assert tried.run.verdicts == run.verdicts
    assert tried.run.waveforms["world.speed"].tolist() == run.waveforms["world.speed"].tolist()


@pytest.mark.thorough
def test_a_point_between_the_runs_gives_another(results: dse.Results, folder: Path) -> None:
    point = {**shown(results, 0), "controller.kp_speed": 1.0}
    tried = what_if_run(results.definition, results.run(0).configuration, point, workspace=folder)
    assert tried.run.is_done
    assert tried.run.metrics not in [results.run(number).metrics for number in range(len(results))]


@pytest.mark.thorough
def test_what_changed_in_the_workspace_is_told(results: dse.Results, folder: Path, tmp_path: Path) -> None:
    import shutil

    shutil.copytree(folder, tmp_path / "changed")
    bench = tmp_path / "changed" / "testbenches" / "acc_following.yaml"
    bench.write_text(bench.read_text("utf-8").replace("at_most: 0.1 %", "at_most: 1 %"), "utf-8")
    run = results.run(0)
    tried = what_if_run(results.definition, run.configuration, shown(results, 0), workspace=tmp_path / "changed")
    assert tried.changed == ("requirement R1",)


def test_what_is_no_point_is_refused_by_name(results: dse.Results, folder: Path) -> None:
    name = results.run(0).configuration
    with pytest.raises(DseError, match="no configuration 'nothing'"):
        what_if_run(results.definition, "nothing", {}, workspace=folder)
    with pytest.raises(DseError, match=r"there is no value for 'controller\.kd_speed'"):
        what_if_run(results.definition, name, {"controller.kp_speed": 1.0}, workspace=folder)
    with pytest.raises(DseError, match="'chassis' is not a design variable"):
        what_if_run(results.definition, name, {**shown(results, 0), "chassis": 1.0}, workspace=folder)


def test_what_a_component_does_not_take_is_refused_before_it_is_simulated(results: dse.Results, folder: Path) -> None:
    point = {**shown(results, 0), "controller.kp_speed": -1.0}
    with pytest.raises(DseError, match=r"^controller\.kp_speed=-1\.0.*: kp_speed = -1 is outside its range 0 … 10 1/s"):
        what_if_run(results.definition, results.run(0).configuration, point, workspace=folder)


def test_without_the_study_s_files_it_is_told_that_they_are_missing(
    results: dse.Results, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(DseError, match="not in a workspace"):
        what_if_run(results.definition, results.run(0).configuration, shown(results, 0), near=tmp_path)


@pytest.mark.thorough
def test_of_certain_values_one_is_taken_and_no_other(results: dse.Results, folder: Path) -> None:
    from dataclasses import replace

    variables = tuple(
        replace(each, values=(0.5, 1.5)) if each.name == "controller.kp_speed" else each
        for each in results.definition.variables
    )
    definition = replace(results.definition, variables=variables)
    point = {**shown(results, 0), "controller.kp_speed": 1.5 + 1e-12}
    tried = what_if_run(definition, results.run(0).configuration, point, workspace=folder)
    assert tried.run.is_done
    with pytest.raises(DseError, match=r"certain values only\n    hint: 0\.5, 1\.5"):
        what_if_run(definition, results.run(0).configuration, {**point, "controller.kp_speed": 1.0}, workspace=folder)
