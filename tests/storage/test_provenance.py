"""What is kept with a study besides its runs: its files, what its design space holds, and tries made again."""

from __future__ import annotations

import shutil
import sqlite3
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import pytest

from dse.domain.provenance import Absent, Funnel, Left, Provenance, SourceText, digest_of
from dse.errors import DseError
from dse.storage import merge_studies
from dse.storage.attempts import STOPPED, Attempt
from dse.storage.database.connection import NAME
from dse.storage.folder import StudyFolder

TEXT = "study: <ä>\n# \u202e and a\ttab\n"
NOTES = Provenance(
    (SourceText("study", "gains.pet.yaml", TEXT, digest_of(TEXT)),),
    Funnel(
        "vehicle",
        624.0,
        "624",
        (Left("budget", "the price", "sum(cost) < 9", 582.0, "582"),),
        (Absent("sensor", "lidar", ("budget",)),),
    ),
)


def test_notes_come_back_as_they_were(stored: Path) -> None:
    with StudyFolder.open(stored) as folder:
        assert folder.notes() is None
        definition = folder.header.definition
    with StudyFolder.resume(stored, definition) as folder:
        folder.note(NOTES)
    with StudyFolder.open(stored) as folder:
        assert folder.notes() == NOTES


def test_the_latest_notes_are_kept(stored: Path) -> None:
    later = Provenance(unfunnelled="too large")
    with StudyFolder.resume(stored, _definition(stored)) as folder:
        folder.note(NOTES)
        folder.note(later)
        assert folder.notes() == later


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (("gains.pet", "other.pet"), None),
        (("a\\ttab", "another tab"), "the text of gains.pet.yaml is not what was written"),
        (('"count":624.0', '"count":"many"'), "count"),
    ],
)
def test_a_text_that_was_changed_is_told(stored: Path, change: tuple[str, str], said: str | None) -> None:
    with StudyFolder.resume(stored, _definition(stored)) as folder:
        folder.note(NOTES)
    with closing(sqlite3.connect(stored / NAME)) as connection, connection:
        (text,) = connection.execute("SELECT value FROM facts WHERE key = 'notes'").fetchone()
        assert change[0] in text
        connection.execute("UPDATE facts SET value = ? WHERE key = 'notes'", (text.replace(*change),))
    with StudyFolder.open(stored) as folder:
        if said is None:
            assert folder.notes()
            return
        with pytest.raises(DseError, match=said):
            folder.notes()


def test_a_merged_study_has_the_notes_of_its_shards(stored: Path, tmp_path: Path) -> None:
    with StudyFolder.resume(stored, _definition(stored)) as folder:
        folder.note(NOTES)
    shards = [tmp_path / "all" / f"shard-{number}-of-2" for number in (1, 2)]
    for shard in shards:
        shutil.copytree(stored, shard)
    merge_studies(tmp_path / "merged", shards)
    with StudyFolder.open(tmp_path / "merged") as folder:
        assert folder.notes() == NOTES


def test_tries_that_were_made_again_are_told_by_their_causes(stored: Path) -> None:
    with StudyFolder.resume(stored, _definition(stored)) as folder:
        assert folder.retried() == {}
        tries = [Attempt(0, "host/1", "crashed", 1.0), Attempt(1, "host/1", "crashed", 1.0)]
        tries += [Attempt(1, "host/1", STOPPED, 1.0), Attempt(2, "host/2", "", 1.0), Attempt(9, "host/2", "hung", 1.0)]
        folder.add_attempts(tries)
    with StudyFolder.open(stored) as folder:
        # Run 9 was never tried again.
        assert folder.retried() == {"crashed": [0, 1], STOPPED: [1]}


def _definition(stored: Path):
    with StudyFolder.open(stored) as folder:
        return replace(folder.header.definition)
