"""A study folder that something else has written into: refused by name, never a traceback."""

from __future__ import annotations

import json
import math
import shutil
import sqlite3
from collections.abc import Callable
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from dse.domain.definition import StudyDefinition
from dse.domain.run import Run, Waveforms
from dse.errors import DseError
from dse.storage.database.definition import definition_from_json, definition_to_json, unit_flaws
from dse.storage.export.tables import EXPORTS
from dse.storage.folder import StudyFolder
from dse.storage.waveform_check import facts_of
from dse.storage.waveforms import read_all_waveforms, waveform_file, write_waveforms

Add = Callable[[StudyFolder, Run], None]


def execute(folder: Path, statement: str, *values: object) -> None:
    with closing(sqlite3.connect(folder / "study.sqlite")) as connection:
        connection.execute(statement, values)
        connection.commit()


@pytest.mark.parametrize(
    "statement",
    [
        """UPDATE runs SET "verdict:R1" = 'perhaps' WHERE number = 1""",
        """UPDATE runs SET "p:controller.kp" = 'abc' WHERE number = 1""",
        """UPDATE runs SET "p:controller.kp" = '[1]' WHERE number = 1""",
        """UPDATE runs SET "p:controller.kp" = 'NaN' WHERE number = 1""",
        """UPDATE runs SET "p:controller.kp" = x'00' WHERE number = 1""",
        """UPDATE runs SET "p:controller.kp" = 9e999 WHERE number = 1""",
        """UPDATE runs SET "p:controller.kp" = 9e999""",
        "UPDATE runs SET configuration = 'elsewhere' WHERE number = 1",
        "UPDATE runs SET outcome = 'maybe' WHERE number = 1",
        "UPDATE runs SET number = -1 WHERE number = 1",
        "UPDATE runs SET number = 6 WHERE number = 1",
        "UPDATE runs SET problem = CAST(x'ff' AS TEXT) WHERE number = 1",
        "DROP TABLE runs",
        'ALTER TABLE runs DROP COLUMN "m:overshoot"',
    ],
)
def test_a_row_that_no_study_has_is_damage(stored: Path, statement: str) -> None:
    execute(stored, "UPDATE runs SET seal = NULL")  # as if an earlier version had written it
    execute(stored, statement)
    for export in EXPORTS.values():
        with (
            StudyFolder.open(stored) as folder,
            pytest.raises(DseError, match=r"study\.sqlite is damaged[\s\S]*--fresh"),
        ):
            export(folder)


def test_a_number_is_needed_for_what_is_varied(stored: Path) -> None:
    execute(stored, """UPDATE runs SET seal = NULL, "p:controller.kp" = '"eco"' WHERE number = 1""")
    with StudyFolder.open(stored) as folder, pytest.raises(DseError, match=r"a run has no number for controller\.kp"):
        folder.table()


@pytest.mark.parametrize(
    "text",
    [
        "{}",
        "[]",
        "3",
        "null",
        "[" * 100_000,
        '{"variables": 1, "metrics": [], "requirements": [], "configurations": []}',
        '{"variables": [], "metrics": ["m"], "requirements": [], "configurations": []}',
        '{"variables": [], "metrics": [{"name": 1}], "requirements": [], "configurations": []}',
        '{"variables": [], "metrics": [{"name": "m"}, {"name": "m"}], "requirements": [], "configurations": []}',
        '{"variables": [], "metrics": [], "requirements": [], "configurations": [{"name": "c"}]}',
        '{"variables": [], "metrics": [], "requirements": [], "configurations": [], "x": 1e999}',
        '{"variables": [], "metrics": [], "requirements": [], "configurations": [], "x": "\\ud800"}',
    ],
)
def test_a_definition_without_its_shape_is_damage(stored: Path, definition: StudyDefinition, text: str) -> None:
    execute(stored, "UPDATE facts SET value = ? WHERE key = 'definition'", text)
    with pytest.raises(DseError, match="damaged"):
        StudyFolder.open(stored)
    with pytest.raises(DseError, match="damaged"):
        StudyFolder.resume(stored, definition)


@pytest.mark.parametrize(("key", "value"), [("runs", '"many"'), ("runs", "-1"), ("era", "1.5"), ("asked", "5")])
def test_facts_of_another_kind_are_damage(stored: Path, key: str, value: str) -> None:
    execute(stored, "UPDATE facts SET value = ? WHERE key = ?", value, key)
    with pytest.raises(DseError, match="damaged"):
        StudyFolder.open(stored)


@pytest.mark.parametrize(
    "statement",
    [
        "INSERT INTO asks VALUES (2, 3, 'c1', 1, 0)",
        "UPDATE asks SET count = 0",
        "UPDATE asks SET count = 2",
        "DROP TABLE asks",
    ],
)
def test_asks_that_no_study_has_are_damage(stored: Path, statement: str) -> None:
    execute(stored, statement)
    with pytest.raises(DseError, match="damaged"):
        StudyFolder.open(stored)


def test_a_study_with_an_infinite_number_is_not_begun(tmp_path: Path, definition: StudyDefinition) -> None:
    endless = replace(definition, simulation=replace(definition.simulation, stop=math.inf))
    with pytest.raises(DseError, match="cannot be stored"):
        StudyFolder.create(tmp_path / "study", endless)


WHOLE: dict[str, Any] = {
    "format": 2,
    "study": "gains",
    "title": "Gains",
    "dse": "0.1.0",
    "bench": {"name": "following"},
    "design": {"name": "vehicle", "places": ["sensor"]},
    "variables": [{"name": "k", "title": "", "unit": "1/s", "low": 0.0, "high": 1, "levels": 3, "nominal": 0.5}],
    "sampler": {"kind": "full_factorial", "options": {}, "slices": [["k", "l"]]},
    "seed": 1,
    "metrics": [{"name": "m", "title": "M", "unit": "%", "expression": "maximum(world.gap)"}],
    "requirements": [
        {
            "name": "R1",
            "title": "",
            "metric": "m",
            "unit": "%",
            "at_most": 0.1,
            "at_least": None,
            "exercised_when": None,
        }
    ],
    "figures": [{"name": "f", "title": "", "unit": "m", "current": "world.gap", "target": None}],
    "simulation": {"stop": 60.0, "step": 0.01, "record_every": 0.1},
    "configurations": [
        {
            "id": "c",
            "choices": {"sensor": "radar"},
            "components": {"sensor": "radar"},
            "totals": {"cost": {"value": 45.0, "unit": "EUR"}},
            "constants": {"k": 0.5},
            "wires": ["a.x -> b.y"],
        }
    ],
    "explored": ["c"],
    "fmus": {"radar": "0123"},
}


def flaws(data: dict[str, Any]) -> list[str]:
    try:
        return list(unit_flaws(definition_from_json(data)))
    except ValueError as error:
        return [str(error)]


def test_a_whole_definition_has_no_flaw_and_comes_back_as_it_was() -> None:
    assert flaws(WHOLE) == []
    definition = definition_from_json(WHOLE)
    assert definition_from_json(json.loads(json.dumps(definition_to_json(definition)))) == definition


def paths(value: object, at: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    entries = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    return [path for key, entry in entries for path in [(*at, key), *paths(entry, (*at, key))]]


@pytest.mark.parametrize("path", paths(WHOLE), ids=lambda path: ".".join(map(str, path)))
def test_every_entry_of_a_whole_definition_is_looked_at(path: tuple[Any, ...]) -> None:
    broken = json.loads(json.dumps(WHOLE))
    inner = broken
    for key in path[:-1]:
        inner = inner[key]
    inner[path[-1]] = True
    assert flaws(broken)


@pytest.mark.parametrize(
    "changed",
    [
        {"sampler": {"options": {}}},
        {"format": 3},
        {"metrics": []},
        {"explored": ["d"]},
        {"figures": [{**WHOLE["figures"][0], "unit": "parsecs of joy"}]},
    ],
)
def test_entries_that_do_not_fit_each_other_are_flaws(changed: dict[str, Any]) -> None:
    assert flaws({**WHOLE, **changed})


@pytest.mark.parametrize(
    "name", ["../../elsewhere/runs-00000000-00000031.parquet", "/etc/passwd", "runs-00000000-00000031.parquet\n", "x"]
)
def test_waveforms_are_read_from_the_study_folder_only(stored: Path, definition: StudyDefinition, name: str) -> None:
    execute(stored, "INSERT INTO kept VALUES (0, ?, NULL)", name)
    with StudyFolder.open(stored) as folder:
        for read in (folder.kept, folder.lost, lambda: folder.waveforms(0), lambda: folder.run(0)):
            with pytest.raises(DseError, match="is not a file of waveforms"):
                read()
    with pytest.raises(DseError, match="is not a file of waveforms"):
        StudyFolder.resume(stored, definition)


def test_going_on_forgets_waveforms_whose_file_is_gone(stored: Path, definition: StudyDefinition) -> None:
    there, gone = waveform_file(0, 1), waveform_file(4, 5)
    wave = Waveforms(np.array([0.0]), {"world.gap": np.array([1.0])})
    with StudyFolder.resume(stored, definition) as folder:
        write_waveforms(folder.waveform_folder / there, [(0, wave), (1, wave)])
        folder.add_kept((0, 1), there)
        folder.add_kept((2,), "")
        write_waveforms(folder.waveform_folder / gone, [(4, wave)])
        folder.add_kept((4,), gone)
        (folder.waveform_folder / gone).unlink()
    with StudyFolder.open(stored) as folder:
        assert folder.lost() == {4}
    with StudyFolder.resume(stored, definition) as folder:
        assert folder.kept() == {0: there, 1: there, 2: ""}
    shutil.rmtree(stored / "waveforms")
    with StudyFolder.resume(stored, definition) as folder:
        assert folder.kept() == {2: ""}
        assert folder.waveform_folder.is_dir()


@pytest.fixture
def kept(stored: Path, definition: StudyDefinition) -> Path:
    """The one file of waveforms of a study."""
    wave = Waveforms(np.linspace(0.0, 1.0, 50), {"world.gap": np.random.default_rng(1).normal(size=50)})
    with StudyFolder.resume(stored, definition) as folder:
        file = folder.waveform_folder / waveform_file(0, 1)
        write_waveforms(file, [(0, wave), (1, wave)])
        folder.add_kept((0, 1), file.name)
        folder.add_kept((2,), "")
    return file


@pytest.mark.parametrize(
    "harm",
    [
        lambda data: b"",
        lambda data: data[:-1],
        lambda data: data + b"x",
        lambda data: bytes([*data[:100], data[100] ^ 1, *data[101:]]),
    ],
    ids=["empty", "cut", "longer", "one bit"],
)
def test_going_on_forgets_waveforms_that_are_not_what_was_kept(
    stored: Path, definition: StudyDefinition, kept: Path, harm: Callable[[bytes], bytes]
) -> None:
    whole = kept.read_bytes()
    kept.write_bytes(harm(whole))
    with StudyFolder.open(stored) as folder:
        assert folder.lost() == (set() if kept.stat().st_size == len(whole) else {0, 1})
    with StudyFolder.resume(stored, definition) as folder:
        assert folder.damaged == {0, 1}
        assert folder.kept() == {2: ""}
        write_waveforms(kept, read_all_waveforms(_written(kept, whole)))
        folder.add_kept((0, 1), kept.name)
    with StudyFolder.resume(stored, definition) as folder:
        assert folder.damaged == set()


def _written(file: Path, data: bytes) -> Path:
    other = file.with_name("other")
    other.write_bytes(data)
    return other


def test_waveforms_that_were_copied_are_read_once_and_stay(
    stored: Path, definition: StudyDefinition, kept: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    data = kept.read_bytes()
    kept.unlink()
    kept.write_bytes(data)
    for reads in (1, 0):
        read: list[Path] = []
        with monkeypatch.context() as patch:
            patch.setattr(
                "dse.storage.waveform_check.facts_of", lambda file, read=read: read.append(file) or facts_of(file)
            )
            with StudyFolder.resume(stored, definition) as folder:
                assert folder.kept() == {0: kept.name, 1: kept.name, 2: ""}
        assert len(read) == reads


@pytest.mark.parametrize("size", [None, 0, 500])
def test_waveforms_of_a_study_of_the_second_version_must_be_readable(
    stored: Path, definition: StudyDefinition, kept: Path, size: int | None
) -> None:
    execute(stored, "DELETE FROM files")
    kept.write_bytes(kept.read_bytes()[:size])
    for _ in range(2):
        with StudyFolder.resume(stored, definition) as folder:
            assert folder.kept() == ({2: ""} if size is not None else {0: kept.name, 1: kept.name, 2: ""})


def test_a_parquet_file_of_something_else_is_no_waveforms(tmp_path: Path) -> None:
    import pyarrow as pa
    import pyarrow.parquet as pq

    right = {"run": pa.array([0], pa.int32()), "time": pa.array([0.0]), "gap": pa.array([1.0])}
    wrong = (
        {**right, "gap": pa.array(["near"])},
        {**right, "gap": pa.array([None], pa.float64())},
        {name: right[name] for name in ("run", "gap")},
        {name: right[name] for name in ("time", "gap")},
    )
    for number, columns in enumerate(wrong):
        file = tmp_path / f"{number}.parquet"
        pq.write_table(pa.table(columns), file)
        with pytest.raises(DseError, match="no waveforms of a study"):
            list(read_all_waveforms(file))
