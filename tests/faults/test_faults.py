"""A few of the faults and signals of ``make faults``: the same command ends the study as if nothing had been."""

from __future__ import annotations

import random
import sys
import time
from datetime import date
from itertools import product

import pytest
from faults import page, shim
from faults.commands import COMMANDS, ERRORS, LARGEST, Commands
from faults.everything import KINDS
from faults.storm import storm
from faults.undisturbed import Scenario, Studies

linux = pytest.mark.skipif(sys.platform != "linux", reason="the library and the signals are Linux's")


@pytest.fixture(scope="module")
def studies(tmp_path_factory: pytest.TempPathFactory) -> Studies:
    folder = tmp_path_factory.mktemp("faults")
    return Studies(folder, shim.build(folder))


@linux
@pytest.mark.thorough
@pytest.mark.parametrize(
    ("kind", "role", "stays"),
    [
        ("write", "coordinator", True),
        ("write", "worker", True),
        ("fsync", "coordinator", False),
        ("open", "coordinator", False),
        ("malloc", "worker", False),
        ("fork", "coordinator", False),
    ],
)
def test_the_same_command_ends_a_study_in_which_a_call_failed(studies, kind, role, stays):
    scenario = Scenario("all")
    error = next(error for name, error, _ in KINDS if name == kind)
    nth = studies.counts(scenario)[role, kind] * 2 // 3
    case = studies.disturbed(scenario, shim.Fault(kind, role, error, nth, stays))
    assert case.happened
    assert (case.wrong, case.litter) == ([], []), f"{case.call}\n{case.said}"


@pytest.fixture(scope="module")
def commands(tmp_path_factory: pytest.TempPathFactory) -> Commands:
    folder = tmp_path_factory.mktemp("commands")
    return Commands(folder, shim.build(folder))


SAMPLE = (
    *product(("report", "merge", "build"), ("coordinator",), ERRORS, (0.4,)),
    *product(("explore",), ("coordinator",), ERRORS, (0.5,)),
    *product(("explore",), ("worker",), ("full", "broken"), (0.1,)),
    ("explore, two workers", "worker", "denied", 0.3),
    ("explore, a pool of processes", "coordinator", "full", 0.7),
    ("explore, Dask", "worker", "files", 0.6),
)
"""Commands, processes, errors, and how far through the calls n is."""


@linux
@pytest.mark.thorough
@pytest.mark.parametrize(("name", "role", "kind", "share"), SAMPLE)
def test_a_command_of_which_each_nth_file_call_fails_says_why_and_the_next_time_gives_the_same_bytes(
    commands: Commands, name: str, role: str, kind: str, share: float
) -> None:
    _require_good(commands, name, role, kind, share)


@linux
@pytest.mark.nightly
@pytest.mark.parametrize("name", COMMANDS)
def test_each_night_other_file_calls_fail(commands: Commands, name: str) -> None:
    chance = random.Random(date.today().toordinal())  # whichever day it is here
    roles = ("coordinator", "worker") if name.startswith("explore") else ("coordinator",)
    for role, kind in product(roles, ERRORS):
        _require_good(commands, name, role, kind, chance.random())


def _require_good(commands: Commands, name: str, role: str, kind: str, share: float) -> None:
    nth = 1 + int(share * min(LARGEST, commands.counts(name)[role, kind]))
    case = commands.disturbed(name, shim.Fault(kind, role, ERRORS[kind], nth, shim.EACH))
    assert (case.wrong, case.litter) == ([], []), f"{case.fault}: {case.call}\n{case.said}"


@linux
@pytest.mark.nightly
def test_a_storm_of_signals_leaves_no_trace_in_the_results(studies):
    told = storm(studies, signals=12, seed=1, until=time.monotonic() + 3600)
    assert told.sent >= 12
    assert told.wrong == []


def test_the_page_tells_of_every_kind_of_call_and_that_what_is_ours_is_right():
    rows = [line.split(" | ") for line in page.PAGE.read_text(encoding="utf-8").splitlines() if line.startswith("| ")]
    tried = [row for row in rows if len(row) == 6 and row[2].isdigit()]
    assert {kind for kind, text in page.FAILS.items() if any(text in row[0] for row in tried)} == {
        kind for kind, *_ in KINDS
    }
    # Where mapping memory fails at the wrong moment, Python itself is broken: the page says so.
    ours = [row for row in tried if page.FAILS["mmap"] not in row[0] and row[0] != "| all"]
    assert {row[5] for row in ours} == {"0 |"}
