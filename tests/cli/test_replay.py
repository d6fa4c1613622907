"""``dse replay`` says "the same" only of what is the same; and what becomes of a folder that was tampered with."""

from __future__ import annotations

import json
import math
import shutil
import sqlite3
from contextlib import closing

import numpy as np
import pytest

from dse.cli.terminal import print_json
from dse.domain.run import Waveforms
from dse.report.content.reading import read_content
from dse.storage.folder import StudyFolder
from dse.storage.waveforms import read_all_waveforms, write_waveforms


@pytest.fixture
def workspace(example, tmp_path):
    """A copy of the example that a test may change, by the file of its study."""
    shutil.copytree(example, tmp_path / "changed")
    return tmp_path / "changed" / "testbenches" / "small.pet.yaml"


@pytest.fixture
def folder(explored, tmp_path):
    """A copy of the explored study that a test may damage."""
    return shutil.copytree(explored, tmp_path / "small")


def change(file, old, new):
    text = file.read_text(encoding="utf-8")
    assert old in text
    file.write_text(text.replace(old, new, 1), encoding="utf-8")


def execute(folder, statement, *values):
    with closing(sqlite3.connect(folder / "study.sqlite")) as connection:
        connection.execute(statement, values)
        connection.commit()


@pytest.mark.thorough
def test_a_replayed_run_is_given_with_its_own_point(dse, explored):
    data = json.loads(dse("replay", str(explored), "8", "--format", "json").stdout)
    stored = json.loads(dse("results", str(explored), "--format", "json").stdout)["runs"][8]
    del stored["run"]
    assert data.pop("units").items() >= {"speed_overshoot": "%", "R1.margin": "%", "consumption": "kWh/km"}.items()
    assert data == stored
    assert data["point"].keys() == {"controller.kp_speed", "controller.kd_speed"}


@pytest.mark.thorough
def test_what_was_compared_is_said(dse, explored):
    done = dse("replay", str(explored), "8")
    assert "bit for bit (metrics, verdicts and waveforms)" in done.stderr


@pytest.mark.thorough
def test_another_bound_is_not_the_same(dse, explored, workspace):
    bench = workspace.parent / "acc_following.yaml"
    change(bench, "at_most: 0.1 %", "at_most: -99 %")
    done = dse("replay", str(explored), "8", "--source", str(workspace))
    assert done.returncode == 1
    assert "run 8 did not give the same again" in done.stderr
    assert "R1" in done.stderr
    assert "changed since: requirement R1" in done.stderr
    assert "bit for bit" not in done.stderr


@pytest.mark.thorough
def test_another_fmu_is_not_the_same_even_if_it_gives_the_same(dse, explored, workspace):
    (source,) = workspace.parents[1].rglob("pd_acc.c")
    source.write_text(source.read_text(encoding="utf-8") + "\n/* another */\n", encoding="utf-8")
    done = dse("replay", str(explored), "8", "--source", str(workspace))
    assert done.returncode == 1
    assert "run 8 gave the same, but not from the same: FMU pd_acc changed since" in done.stderr
    assert "bit for bit" not in done.stderr


@pytest.mark.thorough
def test_another_waveform_is_not_the_same(dse, folder):
    with StudyFolder.open(folder) as store:
        file = folder / "waveforms" / store.kept()[8]
    runs = dict(read_all_waveforms(file))
    gap = runs[8].values["world.gap"].copy()
    gap[7] = np.nextafter(gap[7], 0.0)
    runs[8] = Waveforms(runs[8].time, {**runs[8].values, "world.gap": gap})
    write_waveforms(file, list(runs.items()))
    done = dse("replay", str(folder), "8")
    assert done.returncode == 1
    assert "did not give the same again: waveform of world.gap" in done.stderr
    assert dse("replay", str(folder), "7").returncode == 0


@pytest.mark.thorough
def test_a_copied_study_gives_the_same_report(dse, folder, explored, tmp_path):
    for study, page in ((explored, "a.html"), (folder, "b.html")):
        assert dse("report", str(study), "-o", str(tmp_path / page)).returncode == 0
    assert (tmp_path / "a.html").read_bytes() == (tmp_path / "b.html").read_bytes()


def cut_short(folder):
    for file in folder.iterdir():
        content = file.read_bytes()
        file.write_bytes(content[: len(content) // 2])


@pytest.mark.thorough
@pytest.mark.parametrize("lose", [shutil.rmtree, cut_short])
def test_lost_waveforms_are_left_out_of_the_report_and_made_again(dse, folder, explored, tmp_path, lose):
    lose(folder / "waveforms")
    facts = dict(read_content(folder).facts)
    assert facts["waveforms"] == (
        "kept of 0 runs; files of 20 runs are gone or damaged: the same explore command makes them again"
    )
    assert dse("report", str(folder), "-o", str(tmp_path / "page.html")).returncode == 0
    assert dse("figure", str(folder), "-o", str(tmp_path / "figures")).returncode == 0
    replayed = dse("replay", str(folder), "8")
    assert replayed.returncode == 1
    assert "the same explore command makes its waveforms again" in replayed.stderr
    assert dse("explore", "small", "-o", str(folder)).returncode == 0
    assert {p.name: p.read_bytes() for p in (folder / "waveforms").iterdir()} == {
        p.name: p.read_bytes() for p in (explored / "waveforms").iterdir()
    }
    assert dse("replay", str(folder), "8").returncode == 0


DAMAGE = {
    "a file elsewhere": "UPDATE kept SET file = '../../elsewhere/' || file",
    "waveforms of a run that is not there": "DELETE FROM runs WHERE number = 7",
    "an unknown verdict": """UPDATE runs SET "verdict:R1" = 'perhaps'""",
    "a point that is no number": """UPDATE runs SET "p:controller.kp_speed" = 'abc'""",
    "an infinite point": """UPDATE runs SET "p:controller.kp_speed" = 9e999""",
    "an unknown configuration": "UPDATE runs SET configuration = 'elsewhere'",
    "an empty definition": "UPDATE facts SET value = '{}' WHERE key = 'definition'",
    "no definition": "UPDATE facts SET value = '[]' WHERE key = 'definition'",
    "no title": "UPDATE facts SET value = json_remove(value, '$.title') WHERE key = 'definition'",
    "a lost metric": "UPDATE facts SET value = json_set(value, '$.metrics[0].name', 'm') WHERE key = 'definition'",
    "an empty range": "UPDATE facts SET value = json_set(value, '$.variables[0].low', 99) WHERE key = 'definition'",
    "no table": "DROP TABLE runs",
}


@pytest.mark.sampled(3)
@pytest.mark.parametrize("damage", DAMAGE)
def test_a_report_of_a_damaged_folder_is_refused(dse, folder, damage):
    execute(folder, DAMAGE[damage])
    done = dse("report", str(folder))
    assert done.returncode == 1
    assert "study.sqlite is damaged" in done.stderr
    assert "--fresh" in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize("damage", ["a file elsewhere", "an unknown verdict", "no title", "no table"])
def test_a_run_of_a_damaged_folder_is_not_replayed(dse, folder, damage):
    execute(folder, DAMAGE[damage])
    done = dse("replay", str(folder), "8")
    assert done.returncode == 1
    assert "study.sqlite is damaged" in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.sampled(2)
@pytest.mark.parametrize("damage", ["an unknown verdict", "a point that is no number", "no definition", "no table"])
def test_a_damaged_folder_is_not_gone_on_with(dse, folder, damage):
    execute(folder, DAMAGE[damage])
    done = dse("explore", "small", "-o", str(folder))
    assert done.returncode == 1
    assert "study.sqlite is damaged" in done.stderr
    assert "Traceback" not in done.stderr


def test_infinities_are_words_and_what_is_undefined_is_null(capsys):
    print_json({"metrics": {"a": math.inf, "b": -math.inf, "c": math.nan, "d": 1.5}, "all": [math.inf, 2]})
    data = json.loads(capsys.readouterr().out)
    assert data == {"metrics": {"a": "inf", "b": "-inf", "c": None, "d": 1.5}, "all": ["inf", 2]}
