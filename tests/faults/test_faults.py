"""A few of the faults and signals of ``make faults``: the same command ends the study as if nothing had been."""

from __future__ import annotations

import sys
import time

import pytest
from faults import page, shim
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


@linux
@pytest.mark.nightly
def test_a_storm_of_signals_leaves_no_trace_in_the_results(studies):
    told = storm(studies, signals=12, seed=1, until=time.monotonic() + 3600)
    assert told.sent >= 12
    assert told.wrong == []


def test_the_page_tells_of_every_kind_of_call_and_that_what_is_ours_is_right():
    rows = [line.split(" | ") for line in page.PAGE.read_text(encoding="utf-8").splitlines() if line.startswith("| ")]
    tried = [row for row in rows if len(row) == 6 and row[2].isdigit()]
    assert {kind for kind, text in page.FAILS.items() if any(text in row[0] for row in tried)} == set(shim.KINDS)
    # Where mapping memory fails at the wrong moment, Python itself is broken: the page says so.
    ours = [row for row in tried if page.FAILS["mmap"] not in row[0] and row[0] != "| all"]
    assert {row[5] for row in ours} == {"0 |"}
