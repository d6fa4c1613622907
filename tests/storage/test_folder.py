from __future__ import annotations

import math
import sqlite3
from collections.abc import Callable
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, strategies as st

from dse.domain.bench import VERDICTS, Verdict
from dse.domain.component import Value
from dse.domain.definition import DefinedConfiguration, DefinedMetric, DefinedObjective, StudyDefinition
from dse.domain.run import Outcome, Run, RunRequest, Waveforms
from dse.errors import DseError
from dse.storage.attempts import Attempt, this_process
from dse.storage.database.schema import cell_of, value_of
from dse.storage.export.tables import EXPORTS
from dse.storage.folder import StudyFolder
from dse.storage.rows import Measures, block_of
from dse.storage.waveforms import waveform_file, write_waveforms
from dse.storage.write_ahead_log import LogWriter

Add = Callable[[StudyFolder, Run], None]


def test_a_stored_run_is_read_back_as_it_was(stored: Path, runs: list[Run]) -> None:
    with StudyFolder.open(stored) as folder:
        first, second, failed = folder.run(0), folder.run(1), folder.run(2)
    assert first.request == runs[0].request
    assert first.metrics["overshoot"] == 0.1 + 0.2
    assert math.isnan(first.metrics["rise_time"])
    assert first.judgements[0] == runs[0].judgements[0]
    assert math.isnan(first.judgements[1].margin)
    assert second.metrics == runs[1].metrics
    assert failed.outcome is Outcome.FAILED
    assert failed.problem == runs[2].problem
    assert failed.metrics == {}
    assert {judgement.verdict for judgement in failed.judgements} == {Verdict.FAILED_TO_RUN}


def test_the_table_is_sorted_by_run_number_whatever_the_order_of_arrival(stored: Path) -> None:
    with StudyFolder.open(stored) as folder:
        table = folder.table()
    assert table.numbers.tolist() == [0, 1, 2, 4]
    assert table.configurations == ("c1", "c1", "c1", "c2")
    assert table.done.tolist() == [True, True, False, True]
    assert table.points["controller.kp"].tolist() == [0.1, 0.2, 0.3, 0.2]
    np.testing.assert_array_equal(table.metric("rise_time"), [np.nan, np.inf, np.nan, -np.inf])
    assert [VERDICTS[code] for code in table.verdicts("R1")] == [
        Verdict.PASS,
        Verdict.FAIL,
        Verdict.FAILED_TO_RUN,
        Verdict.PASS,
    ]
    np.testing.assert_array_equal(table.margins("R1"), [0.25, -1.5, np.nan, 0.0])
    assert table.problems == ("", "", 'world: "t" < 3 s\x00 & more', "")


def test_the_header_comes_back(stored: Path, definition: StudyDefinition) -> None:
    with StudyFolder.open(stored) as folder:
        assert folder.header.definition == definition
        assert (folder.header.runs, folder.header.asked, folder.header.numbers) == (6, 6, 6)
        assert folder.header.configurations == ("c1", "c2")


def test_a_study_whose_configurations_come_later_may_aim_at_their_totals(
    tmp_path: Path, definition: StudyDefinition
) -> None:
    aims = (DefinedObjective("cost", is_total=True),)
    StudyFolder.create(tmp_path, replace(definition, configurations=(), explored=(), objectives=aims)).close()
    with StudyFolder.open(tmp_path) as folder:
        assert folder.header.definition.objectives == aims
    with pytest.raises(DseError, match="objective 'price' is neither a metric nor a total"):
        StudyFolder.create(tmp_path / "other", replace(definition, objectives=(replace(aims[0], name="price"),)))


def test_a_new_study_is_an_empty_table(tmp_path: Path, definition: StudyDefinition) -> None:
    with StudyFolder.create(tmp_path / "deep" / "study", definition) as folder:
        assert folder.finished() == set()
        assert len(folder.table()) == 0
        assert folder.table().metric("overshoot").shape == (0,)


def test_a_closed_folder_is_one_database_and_one_folder(stored: Path) -> None:
    with StudyFolder.open(stored) as folder:
        folder.table()
    assert sorted(entry.name for entry in stored.iterdir()) == ["study.sqlite", "waveforms"]


def test_a_run_keeps_its_first_row(stored: Path, runs: list[Run], add: Add, definition: StudyDefinition) -> None:
    with StudyFolder.resume(stored, definition) as folder:
        add(folder, replace(runs[0], metrics={"overshoot": 7.0, "rise_time": 7.0}))
        assert folder.run(0).metrics["overshoot"] == 0.1 + 0.2


def test_a_reader_sees_what_a_writer_committed(
    tmp_path: Path, definition: StudyDefinition, runs: list[Run], add: Add
) -> None:
    with StudyFolder.create(tmp_path, definition) as writer, StudyFolder.open(tmp_path) as reader:
        add(writer, runs[0])
        assert reader.finished() == set()
        writer.commit()
        assert reader.finished() == {0}


def test_a_reader_cannot_write(stored: Path, runs: list[Run], add: Add) -> None:
    with StudyFolder.open(stored) as folder, pytest.raises(DseError, match="readonly"):
        add(folder, runs[0])


def test_each_row_is_an_attempt_in_the_order_of_arrival(stored: Path) -> None:
    with StudyFolder.open(stored) as folder:
        assert folder.attempts() == [Attempt(number, this_process(), "", 0.5) for number in (4, 2, 1, 0)]


def test_attempts_without_a_row_come_back_and_make_no_row(stored: Path, definition: StudyDefinition) -> None:
    tries = [
        Attempt(3, "other.example/17", "killed by signal 9", 1.5),
        Attempt(3, "other.example/18", "stopped with the program", math.inf),
        Attempt(0, "other.example/17", "", 0.25),
        Attempt(5, "", "lost", 0.0),
        Attempt(5, "cloud", "lost", 0.0),
    ]
    with StudyFolder.resume(stored, definition) as folder:
        before = folder.attempts()
        folder.add_attempts(tries)
        assert folder.finished() == {0, 1, 2, 4}
        folder.add_attempts([Attempt(5, "a/1", "", math.nan)])
    with StudyFolder.open(stored) as folder:
        *after, last = folder.attempts()
        assert after == before + tries
        assert math.isnan(last.seconds)


def to_second_version(path: Path) -> None:
    """Turn the study in *path* into what version 2 wrote."""
    with closing(sqlite3.connect(path / "study.sqlite")) as connection:
        connection.execute("CREATE TABLE timing (number INTEGER PRIMARY KEY, wall REAL) STRICT")
        connection.execute("INSERT INTO timing SELECT run, seconds FROM attempts")
        for table in ("attempts", "makers", "files", "checks"):
            connection.execute(f"DROP TABLE {table}")
        for table in ("runs", "kept"):
            connection.execute(f"ALTER TABLE {table} DROP COLUMN seal")
        connection.execute("DELETE FROM facts WHERE key = 'seal'")
        connection.execute("PRAGMA user_version = 2")
        connection.commit()


def test_a_study_of_the_second_version_is_read_and_goes_on(
    stored: Path, definition: StudyDefinition, runs: list[Run], add: Add
) -> None:
    exported = {}
    for version in (3, 2):
        with StudyFolder.open(stored) as folder:
            exported[version] = [export(folder) for export in EXPORTS.values()]
            attempts = sorted(folder.attempts(), key=lambda attempt: attempt.run)
            maker = this_process() if version == 3 else ""
            assert attempts == [Attempt(number, maker, "", 0.5) for number in (0, 1, 2, 4)]
        to_second_version(stored) if version == 3 else None
    assert exported[2] == exported[3]
    with StudyFolder.resume(stored, definition) as folder:
        add(folder, replace(runs[0], request=replace(runs[0].request, number=3)))
        assert folder.attempts() == [*attempts, Attempt(3, this_process(), "", 0.5)]


@given(
    st.one_of(
        st.floats(allow_nan=False), st.integers(-(2**70), 2**70), st.booleans(), st.text(st.characters(codec="utf-8"))
    )
)
def test_a_point_value_comes_back_with_its_type(value: Value) -> None:
    with closing(sqlite3.connect(":memory:")) as connection:
        connection.execute("CREATE TABLE t (x ANY) STRICT")
        connection.execute("INSERT INTO t VALUES (?)", (cell_of(value),))
        (cell,) = connection.execute("SELECT x FROM t").fetchone()
    assert value_of(cell) == value
    assert type(value_of(cell)) is type(value)


def test_waveforms_come_back_through_the_folder(tmp_path: Path, definition: StudyDefinition) -> None:
    wave = Waveforms(np.array([0.0, 0.1]), {"world.gap": np.array([150.0, math.nan])})
    with StudyFolder.create(tmp_path, definition) as folder:
        name = waveform_file(0, 31)
        write_waveforms(folder.waveform_folder / name, [(3, wave)])
        folder.add_kept((3,), name)
        folder.add_kept((4,), "")
        read = folder.waveforms(3)
        assert read is not None
        np.testing.assert_array_equal(read.values["world.gap"], wave.values["world.gap"])
        assert folder.waveforms(4) is None
        assert folder.waveforms(5) is None
        assert folder.kept() == {3: "runs-00000000-00000031.parquet", 4: ""}
        (folder.waveform_folder / name).unlink()
        with pytest.raises(DseError, match="waveforms of run 3 cannot be read"):
            folder.waveforms(3)


def test_another_study_does_not_go_into_the_same_folder(stored: Path, definition: StudyDefinition) -> None:
    with pytest.raises(DseError, match=r"another study \(different: fmus\)[\s\S]*--fresh"):
        StudyFolder.resume(stored, replace(definition, fmus={"pd_acc": "4567"}))
    changed = replace(definition.requirements[0], at_most=2.0)
    with pytest.raises(DseError, match=r"another study \(different: requirements\)"):
        StudyFolder.resume(stored, replace(definition, requirements=(changed, definition.requirements[1])))


def test_titles_may_change_and_the_folder_has_the_new_ones(stored: Path, definition: StudyDefinition) -> None:
    renamed = replace(definition, title="Gains again")
    with StudyFolder.resume(stored, renamed) as folder:
        assert (folder.header.era, folder.header.runs) == (0, 6)
    with StudyFolder.open(stored) as folder:
        assert folder.header.definition == renamed


def test_other_points_or_configurations_extend_a_study_and_its_runs_stay(
    stored: Path, definition: StudyDefinition
) -> None:
    wider = replace(definition, variables=(replace(definition.variables[0], high=2.0, levels=5),))
    with StudyFolder.resume(stored, wider) as folder:
        assert (folder.header.era, folder.header.base, folder.header.earlier) == (1, 6, 4)
        assert folder.finished() == {0, 1, 2, 4}
    more = replace(
        wider, configurations=(DefinedConfiguration("c3"), definition.configurations[1]), explored=("c3", "c2")
    )
    with StudyFolder.resume(stored, more) as folder:
        assert folder.header.era == 2
        assert folder.header.configurations == ("c3", "c2", "c1")
        assert len(folder.table()) == 4


def test_an_ask_that_is_noted_must_stay_as_it_was(
    stored: Path, definition: StudyDefinition, asked: Callable[[StudyFolder], StudyFolder]
) -> None:
    with StudyFolder.resume(stored, definition) as folder:
        asked(folder)
        with pytest.raises(DseError, match=r"asks for other runs than it did before[\s\S]*--fresh"):
            folder.ask(0, [RunRequest(0, "c2", {"controller.kp": 0.1})], 1)


def test_a_study_is_not_created_over_another(stored: Path, definition: StudyDefinition) -> None:
    with pytest.raises(DseError, match="holds a study already"):
        StudyFolder.create(stored, definition)


def test_a_study_does_not_go_among_other_files(tmp_path: Path, definition: StudyDefinition) -> None:
    (tmp_path / "thesis.txt").write_text("x", encoding="utf-8")
    with pytest.raises(DseError, match="not empty and not a study folder"):
        StudyFolder.resume(tmp_path, definition)
    with pytest.raises(DseError, match="not a study folder"):
        StudyFolder.discard(tmp_path)
    assert (tmp_path / "thesis.txt").exists()


def test_a_file_is_no_place_for_a_study(tmp_path: Path, definition: StudyDefinition) -> None:
    file = tmp_path / "file"
    file.write_text("x", encoding="utf-8")
    with pytest.raises(DseError, match="is a file, not a folder"):
        StudyFolder.resume(file, definition)
    with pytest.raises(DseError, match="is not a study folder"):
        StudyFolder.open(file)


def test_a_missing_folder_and_an_empty_one_are_told_apart(tmp_path: Path) -> None:
    with pytest.raises(DseError, match="there is no such folder"):
        StudyFolder.open(tmp_path / "nowhere")
    with pytest.raises(DseError, match=r"there is no study\.sqlite in it"):
        StudyFolder.open(tmp_path)


def test_a_database_of_another_program_is_refused(tmp_path: Path) -> None:
    with closing(sqlite3.connect(tmp_path / "study.sqlite")) as connection:
        connection.execute("CREATE TABLE notes (x)")
    with pytest.raises(DseError, match="written by another program"):
        StudyFolder.open(tmp_path)


def test_a_newer_study_asks_for_a_newer_dse(stored: Path) -> None:
    with closing(sqlite3.connect(stored / "study.sqlite")) as connection:
        connection.execute("PRAGMA user_version = 99")
    with pytest.raises(DseError, match="newer dse"):
        StudyFolder.open(stored)


@pytest.mark.parametrize("where", [0, 4096])
def test_a_damaged_database_is_named(stored: Path, where: int) -> None:
    file = stored / "study.sqlite"
    data = bytearray(file.read_bytes())
    data[where : where + 4096] = b"\xff" * 4096
    file.write_bytes(data)
    with pytest.raises(DseError, match=r"study\.sqlite is damaged"), StudyFolder.open(stored) as folder:
        folder.table()


def test_facts_that_are_no_json_are_damage(stored: Path) -> None:
    with closing(sqlite3.connect(stored / "study.sqlite")) as connection:
        connection.execute("UPDATE facts SET value = '{' WHERE key = 'definition'")
        connection.commit()
    with pytest.raises(DseError, match="damaged"):
        StudyFolder.open(stored)


def test_a_creation_that_was_cut_short_is_done_again(tmp_path: Path, definition: StudyDefinition) -> None:
    (tmp_path / "study.sqlite.part").write_bytes(b"torn")
    (tmp_path / "waveforms").mkdir()
    with StudyFolder.resume(tmp_path, definition) as folder:
        assert folder.finished() == set()
    assert not (tmp_path / "study.sqlite.part").exists()


def test_going_on_sweeps_away_torn_waveform_files(stored: Path, definition: StudyDefinition) -> None:
    torn = stored / "waveforms" / "runs-00000000-00000031.parquet.77.part"
    torn.write_bytes(b"PAR1")
    StudyFolder.resume(stored, definition).close()
    assert not torn.exists()


def test_the_spool_of_a_batch_goes_when_its_rows_are_committed(
    stored: Path, definition: StudyDefinition, runs: list[Run]
) -> None:
    with StudyFolder.resume(stored, definition) as folder:
        for name in ("runs-00000000", "runs-00000003"):
            with LogWriter(folder.log_folder, name, "a/1", folder.header.measures) as writer:
                writer.add(runs[0], 0.5)
        folder.add_attempts([Attempt(0, "a/1", "", 0.5)])
        folder.release("runs-00000000")
        assert len([*folder.log_folder.iterdir()]) == 2
        folder.commit()
        assert len([*folder.log_folder.iterdir()]) == 1
        folder.release("runs-00000003")
        folder.end()
    assert not (stored / "spool").exists()


def test_a_discarded_study_leaves_room_for_another(stored: Path, definition: StudyDefinition) -> None:
    (stored / "spool").mkdir()
    (stored / "spool" / "runs-00000000.7-0.spool").touch()
    (stored / "replays").mkdir()
    StudyFolder.discard(stored)
    assert not (stored / "spool").exists()
    with StudyFolder.resume(stored, replace(definition, seed=2)) as folder:
        assert folder.finished() == set()


def test_names_that_differ_only_in_case_are_refused(tmp_path: Path, definition: StudyDefinition) -> None:
    metrics = tuple(DefinedMetric(name, "", "", "") for name in ("gap", "Gap"))
    bare = replace(definition, metrics=metrics, requirements=())
    with pytest.raises(DseError, match="'gap' and 'Gap' cannot both be stored"):
        StudyFolder.create(tmp_path, bare)


def test_names_may_hold_any_character(tmp_path: Path, definition: StudyDefinition) -> None:
    odd = 'a"b; DROP TABLE runs --'
    named = replace(definition, variables=(replace(definition.variables[0], name=odd),), metrics=(), requirements=())
    run = Run(RunRequest(0, "c1", {odd: 0.5}), Outcome.DONE)
    with StudyFolder.create(tmp_path, named) as folder:
        folder.ask(0, [run.request], 1)
        folder.add("c1", [(0.5,)], block_of((run,), Measures(), (0.0,)))
        assert folder.run(0).request.point == {odd: 0.5}


def test_a_run_that_was_not_made_is_named(stored: Path) -> None:
    with StudyFolder.open(stored) as folder, pytest.raises(DseError, match=r"no run 3[\s\S]*runs 0 to 5"):
        folder.run(3)
