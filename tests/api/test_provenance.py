"""What exploring keeps with a study besides its runs."""

from __future__ import annotations

import shutil
from dataclasses import replace
from pathlib import Path

import pytest

import dse
from dse.api.studies.provenance import note_sources, note_space
from dse.domain.provenance import Provenance, digest_of
from dse.errors import DseError, fail
from dse.loading import Workspace as Files
from dse.space import open_space
from dse.storage import StudyFolder


def test_a_study_keeps_its_files_as_they_were_run(results: dse.Results, folder: Path) -> None:
    with StudyFolder.open(results.folder) as store:
        notes = store.notes()
    assert notes is not None
    names = {"study": "small.pet.yaml", "test bench": "acc_following.yaml", "design space": "acc_vehicle.yaml"}
    assert {each.kind: each.file for each in notes.sources} == names
    for each in notes.sources:
        (file,) = folder.rglob(each.file)
        assert each.text == file.read_text(encoding="utf-8")
        assert each.digest == digest_of(each.text)


def test_a_study_keeps_what_the_constraints_leave_of_its_design_space(results: dse.Results, ws: dse.Workspace) -> None:
    with StudyFolder.open(results.folder) as store:
        notes = store.notes()
    assert notes is not None
    assert notes.funnel is not None
    impacts = open_space(ws.designs["acc_vehicle"].space).impact()
    assert [(each.constraint, each.count) for each in notes.funnel.steps] == [
        (each.constraint.name, float(each.after.value)) for each in impacts
    ]
    assert notes.funnel.count == 624
    assert notes.funnel.absent == ()


def test_a_study_keeps_which_parameters_are_marked_as_assumed(
    folder: Path, results: dse.Results, tmp_path: Path
) -> None:
    place = tmp_path / "marked"
    shutil.copytree(folder, place)
    file = place / "components" / "controllers" / "pd_acc" / "component.yaml"
    lines = file.read_text(encoding="utf-8").splitlines()
    marks = {"kp_speed": "   # assumed", "kd_speed": "   # assumed by nobody but us", "kp_gap": "   # not assumed"}
    lines = [line + next((mark for name, mark in marks.items() if line.startswith(f"  {name}:")), "") for line in lines]
    file.write_text("\n".join(lines), encoding="utf-8")
    with StudyFolder.open(results.folder) as store:
        definition, unmarked = store.header.definition, store.notes()
    assert unmarked is not None
    assert unmarked.assumed is not None
    with StudyFolder.create(tmp_path / "out", definition) as store:
        note_sources(Files(place).study("small"), store)
        notes = store.notes()
    assert notes is not None
    assert notes.assumed is not None
    assert {*notes.assumed} - {*unmarked.assumed} == {"pd_acc.kp_speed", "pd_acc.kd_speed"}


@pytest.mark.thorough
def test_an_alternative_that_no_design_has_is_told_with_what_forbids_it(folder: Path, results, tmp_path: Path) -> None:
    place = tmp_path / "strict"
    shutil.copytree(folder, place)
    design = place / "designs" / "acc_vehicle.yaml"
    text = design.read_text(encoding="utf-8")
    assert "compute >= 1 TOPS" in text
    design.write_text(text.replace("compute >= 1 TOPS", "compute >= 1000 TOPS"), encoding="utf-8")
    study = Files(place).study("small")
    with StudyFolder.open(results.folder) as store:
        definition = store.header.definition
    with StudyFolder.create(tmp_path / "out", definition) as store:
        note_sources(study, store)
        note_space(study, store)
        notes = store.notes()
        assert notes is not None
        assert notes.funnel is not None
        (absent,) = notes.funnel.absent
        assert (absent.place, absent.choice, absent.constraints) == ("sensor", "lidar_905nm", ("lidar_computing",))
        # What is known is not counted again, and goes with the files it was counted of.
        store.note(replace(notes, funnel=None, unfunnelled="no"))
        note_space(study, store)
        assert store.notes() == replace(notes, funnel=None, unfunnelled="no")
        design.write_text(text, encoding="utf-8")
        note_sources(Files(place).study("small"), store)
        note_space(Files(place).study("small"), store)
        later = store.notes()
        assert later is not None
        assert later.funnel is not None
        assert later.funnel.absent == ()


def test_a_space_that_is_too_large_is_not_counted_and_why(monkeypatch: pytest.MonkeyPatch, folder, results, tmp_path):
    monkeypatch.setattr("dse.space.questions.impact.MOST_CONSTRAINTS", 3)
    with StudyFolder.open(results.folder) as store:
        definition = store.header.definition
    with StudyFolder.create(tmp_path / "out", definition) as store:
        note_space(Files(folder).study("small"), store)
        assert store.notes() == Provenance(
            unfunnelled="'acc_vehicle' is too large to look at 7 constraints one after the other"
        )


def test_a_database_that_cannot_be_written_is_no_reason_for_which_there_is_no_funnel(
    results: dse.Results, folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    study = Files(folder).study("small")
    with StudyFolder.open(results.folder) as store:
        definition = store.header.definition
    with StudyFolder.create(tmp_path / "out", definition) as store:
        note = store.note

        def full(notes: Provenance) -> None:
            monkeypatch.setattr(store, "note", note)
            raise fail("the disk is full")

        monkeypatch.setattr(store, "note", full)
        with pytest.raises(DseError, match="the disk is full"):
            note_space(study, store)
        assert store.notes() is None
        note_space(study, store)
        notes = store.notes()
        assert notes is not None
        assert notes.funnel is not None
