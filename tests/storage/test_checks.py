"""Checks of runs as they are stored, and which verdicts they leave certain."""

from __future__ import annotations

import math
import sqlite3
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest

from dse.domain.bench import VERDICTS
from dse.domain.definition import StudyDefinition
from dse.errors import DseError
from dse.storage.checks import CERTAINTIES, Certainty, Checks, certainties, certainties_by_bars
from dse.storage.export.tables import EXPORTS
from dse.storage.folder import StudyFolder

PASS, FAIL, SKIPPED, FAILED = range(4)


def execute(path: Path, *statements: str) -> None:
    with closing(sqlite3.connect(path / "study.sqlite")) as connection:
        for statement in statements:
            connection.execute(statement)
        connection.commit()


CHECKS = Checks(
    np.array([0, 2]),
    np.array([[0.25, math.nan], [math.inf, 0.0]]),
    np.array([[1, 3], [2, 0]]),
    {2: "with half the step"},
)


def test_checks_come_back_as_they_were_stored_and_stay(stored: Path, definition: StudyDefinition) -> None:
    with StudyFolder.resume(stored, definition) as folder:
        folder.add_checks(CHECKS)
        folder.add_checks(Checks(np.array([2]), np.zeros((1, 2)), np.ones((1, 2), np.int64), {}))
    with StudyFolder.open(stored) as folder:
        whole, (one, other) = folder.table(), (folder.table((n,)) for n in (0, 1))
    for name in ("numbers", "errors", "verdicts"):
        np.testing.assert_array_equal(getattr(whole.checks, name), getattr(CHECKS, name))
    assert whole.checks.problems == CHECKS.problems
    assert one.checks.numbers.tolist() == [0]
    assert not len(other.checks)
    np.testing.assert_array_equal(whole.errors("overshoot"), [0.25, math.nan, math.inf, math.nan])


def test_a_study_of_the_third_version_has_no_checks_and_takes_them(stored: Path, definition: StudyDefinition) -> None:
    def exported() -> list[bytes]:
        with StudyFolder.open(stored) as folder:
            return [export(folder) for export in EXPORTS.values()]

    before = exported()
    execute(stored, "DROP TABLE checks", "PRAGMA user_version = 3")
    assert exported() == before
    with StudyFolder.resume(stored, definition) as folder:
        folder.add_checks(CHECKS)
        assert len(folder.table().checks) == 2


def test_a_run_that_is_made_anew_has_no_check(stored: Path, definition: StudyDefinition) -> None:
    with StudyFolder.resume(stored, definition) as folder:
        folder.add_checks(CHECKS)
        folder.forget({0})
        assert folder.table().checks.numbers.tolist() == [2]


@pytest.mark.parametrize(
    "change",
    [
        'UPDATE checks SET "e:overshoot" = 0.125 WHERE number = 0',
        'UPDATE checks SET "v:R1" = 3 WHERE number = 0',
        "UPDATE checks SET problem = '' WHERE number = 2",
        "UPDATE checks SET number = 1 WHERE number = 2",
        "DELETE FROM runs WHERE number = 2",
    ],
)
def test_a_check_that_is_not_what_was_written_is_found(stored: Path, definition: StudyDefinition, change: str) -> None:
    with StudyFolder.resume(stored, definition) as folder:
        folder.add_checks(CHECKS)
    execute(stored, change)
    with StudyFolder.open(stored) as folder, pytest.raises(DseError, match="check of run"):
        folder.table()


@pytest.mark.parametrize(
    ("verdict", "margin", "bar", "under", "expected"),
    [
        (PASS, 3.0, 1.0, {PASS}, "certain"),
        (FAIL, -3.0, 1.0, {FAIL}, "certain"),
        (PASS, 1.0, 1.0, {PASS}, "doubtful"),
        (PASS, 0.0, 0.0, {PASS}, "doubtful"),
        (PASS, 3.0, 1.0, {PASS, SKIPPED}, "doubtful"),
        (PASS, 3.0, 1.0, {PASS, FAILED}, "doubtful"),
        (PASS, 3.0, math.nan, set(), "doubtful"),  # nobody can tell how exact a part is
        (PASS, math.inf, 0.0, {PASS}, "certain"),
        (FAIL, math.nan, math.nan, {FAIL}, "certain"),  # undefined in all of them
        (FAIL, math.nan, math.inf, {FAIL, PASS}, "doubtful"),
        (SKIPPED, 0.5, 1.0, {SKIPPED}, "certain"),
        (SKIPPED, 9.0, 1.0, {SKIPPED, PASS}, "doubtful"),
    ],
)
def test_a_verdict_is_certain_if_no_variation_changes_it_nor_the_error_could(
    verdict: int, margin: float, bar: float, under: set[int], expected: str
) -> None:
    sums = np.array([sum(1 << code for code in under)])
    (code,) = certainties(np.array([verdict], np.uint8), np.array([margin]), np.array([bar]), sums)
    assert CERTAINTIES[code] == expected


def test_of_error_bars_alone_nothing_is_known_of_verdicts_that_no_margin_decides() -> None:
    margins = np.array([3.0, 1.0, 3.0, math.nan, math.nan, 3.0, math.nan])
    bars = np.array([1.0, 1.0, math.nan, math.nan, math.inf, 1.0, math.nan])
    verdicts = np.array([PASS, FAIL, PASS, FAIL, FAIL, SKIPPED, FAILED], np.uint8)
    words = [CERTAINTIES[code] for code in certainties_by_bars(verdicts, margins, bars)]
    certain, doubtful, unchecked = Certainty.CERTAIN, Certainty.DOUBTFUL, Certainty.UNCHECKED
    assert words == [certain, doubtful, doubtful, certain, doubtful, unchecked, unchecked]
    assert len(VERDICTS) == 5
