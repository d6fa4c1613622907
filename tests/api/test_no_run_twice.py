"""What was simulated once is not simulated again: by another study, in another folder, after a change of the files."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

import dse

_STUDY = """\
study: pair
testbench: acc_following
configurations:
  where: >-
    sensor is radar_77ghz_mid and (controller is pd_acc or controller is pi_time_gap_acc) and brake is hydraulic_booster
    and powertrain is bev_ideal and video is absent
design_variables:
  sensor.max_range: {range: [120 m, 160 m], levels: 3}
  world.lead_speed: {range: [40 km/h, 60 km/h], levels: %d}
sampler: full_factorial
keep_waveforms: %s
"""

Edit = Callable[[str, str, str], None]


@pytest.fixture
def place(folder, tmp_path, monkeypatch) -> Path:
    """A workspace of its own with the study, and an empty store of runs beside the FMUs that were built."""
    for name in ("components", "designs", "roads", "testbenches"):
        shutil.copytree(folder / name, tmp_path / "work" / name)
    (tmp_path / "work" / "testbenches" / "pair.pet.yaml").write_text(_STUDY % (2, "all"), encoding="utf-8")
    import os

    cache = Path(os.environ["DSE_CACHE"])
    (tmp_path / "cache").mkdir()
    for entry in cache.iterdir():
        if entry.name != "runs":
            (tmp_path / "cache" / entry.name).symlink_to(entry)
    monkeypatch.setenv("DSE_CACHE", str(tmp_path / "cache"))
    return tmp_path / "work"


@pytest.fixture
def edit(place) -> Edit:
    """Replaces text in a file of the workspace."""

    def change(file: str, old: str, new: str) -> None:
        path = place / file
        text = path.read_text(encoding="utf-8")
        assert old in text
        path.write_text(text.replace(old, new, 1), encoding="utf-8")

    return change


@pytest.fixture
def study(place) -> Callable[[], dse.Study]:
    """The study as its file is now."""
    return lambda: dse.open(place).studies["pair"]


def bytes_of(folder: Path) -> dict[str, bytes]:
    """All that a study folder shows: tables, waveforms and report."""
    from dse.report.content.reading import read_content
    from dse.report.page.html import page_of

    shown = {kind: dse.results(folder).export(kind) for kind in ("csv", "json", "junit", "parquet")}
    waveforms = {file.name: file.read_bytes() for file in (folder / "waveforms").iterdir()}
    content = replace(read_content(folder), study_folder="pair", notes=None)  # the texts of files, as they were written
    return shown | waveforms | {"report": page_of(content).encode()}


@pytest.mark.thorough
def test_a_change_of_one_component_simulates_its_configurations_only(study, edit, tmp_path):
    first = study().explore(tmp_path / "out", workers=1)
    assert (first.explored.simulated, first.explored.taken) == (12, 0)
    before = bytes_of(tmp_path / "out")

    file = "components/controllers/pi_time_gap_acc/component.yaml"
    edit(file, "max_acceleration: {start: 2 m/s2", "max_acceleration: {start: 1.5 m/s2")
    plan = study().plan(tmp_path / "out", workers=1)
    assert plan.changes == ("FMU pi_time_gap_acc", "parameter controller.max_acceleration")
    assert (plan.runs, plan.configurations, plan.there, plan.known) == (12, 2, 6, 0)
    assert (plan.missing, plan.simulated, plan.again) == (6, 1, 0)
    assert plan.seconds > 0
    assert bytes_of(tmp_path / "out") == before

    changed = study().explore(tmp_path / "out", workers=1).explored
    assert (changed.simulated, changed.taken) == (6, 6)
    study().explore(tmp_path / "fresh", workers=1, fresh=True)
    assert bytes_of(tmp_path / "out") == bytes_of(tmp_path / "fresh") != before

    edit(file, "max_acceleration: {start: 1.5 m/s2", "max_acceleration: {start: 2 m/s2")
    assert study().plan(tmp_path / "out").missing == 0
    back = study().explore(tmp_path / "out", workers=1).explored
    assert (back.simulated, back.taken) == (0, 12)
    assert bytes_of(tmp_path / "out") == before


@pytest.mark.thorough
def test_the_same_study_in_another_folder_simulates_nothing(study, tmp_path):
    study().explore(tmp_path / "one", workers=1)
    assert study().plan(tmp_path / "two").known == 12
    again = study().explore(tmp_path / "two", workers=1).explored
    assert (again.simulated, again.taken, again.new, again.again) == (0, 12, 12, 0)
    assert bytes_of(tmp_path / "one") == bytes_of(tmp_path / "two")
    assert study().plan(tmp_path / "two", fresh=True).missing == 12
    assert study().explore(tmp_path / "two", workers=1, fresh=True).explored.simulated == 12


@pytest.mark.thorough
def test_another_study_takes_the_runs_that_are_the_same(study, edit, place, tmp_path):
    study().explore(tmp_path / "one", workers=1)
    (place / "testbenches" / "other.pet.yaml").write_text(
        (_STUDY % (2, "none")).replace("study: pair", "study: other").replace("levels: 3", "levels: 5"),
        encoding="utf-8",
    )
    other = dse.open(place).studies["other"].explore(tmp_path / "other", workers=1).explored
    assert (other.runs, other.taken, other.simulated) == (20, 12, 8)


@pytest.mark.thorough
def test_waveforms_near_the_boundary_are_taken_too(study, edit, tmp_path):
    edit("testbenches/pair.pet.yaml", "keep_waveforms: all", "keep_waveforms: near_boundary")
    first = study().explore(tmp_path / "one", workers=1).explored
    assert first.again == first.kept > 0
    again = study().explore(tmp_path / "two", workers=1).explored
    assert (again.simulated, again.kept) == (0, first.kept)
    assert bytes_of(tmp_path / "one") == bytes_of(tmp_path / "two")


@pytest.mark.thorough
def test_what_is_in_the_folder_stays_though_the_cache_was_emptied(study, edit, tmp_path):
    study().explore(tmp_path / "out", workers=1)
    before = bytes_of(tmp_path / "out")
    shutil.rmtree(tmp_path / "cache" / "runs")
    edit("testbenches/acc_following.yaml", "at_most: 0.25 %,", "at_most: 0.2 % ,")
    edit("testbenches/acc_following.yaml", "at_most: 0.2 % ,", "at_most: 2.5e-1 %,")
    file = "components/controllers/pi_time_gap_acc/component.yaml"
    edit(file, "max_acceleration: {start: 2 m/s2", "max_acceleration: {start: 1.5 m/s2")
    assert study().explore(tmp_path / "out", workers=1).explored.simulated == 6
    edit(file, "max_acceleration: {start: 1.5 m/s2", "max_acceleration: {start: 2 m/s2")
    assert study().explore(tmp_path / "out", workers=1).explored.simulated == 0
    assert bytes_of(tmp_path / "out") == before
