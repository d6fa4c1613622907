"""A few of the faults that ``make faults`` tries one by one: the same command ends the study as if nothing had been."""

from __future__ import annotations

import sys

import pytest
from faults import shim
from faults.everything import KINDS, SCENARIOS
from faults.undisturbed import Studies

pytestmark = [
    pytest.mark.thorough,
    pytest.mark.skipif(sys.platform != "linux", reason="the library is for Linux"),
]


@pytest.fixture(scope="module")
def studies(tmp_path_factory: pytest.TempPathFactory) -> Studies:
    folder = tmp_path_factory.mktemp("faults")
    return Studies(folder, shim.build(folder))


@pytest.mark.parametrize("stays", [False, True])
@pytest.mark.parametrize(("kind", "role"), [("write", "coordinator"), ("write", "worker"), ("fork", "coordinator")])
def test_the_same_command_ends_a_study_with_which_something_went_wrong(studies, kind, role, stays):
    scenario = SCENARIOS[0]
    error = next(error for name, error, _ in KINDS if name == kind)
    count = studies.counts(scenario)[role, kind]
    case = studies.disturbed(scenario, shim.Fault(kind, role, error, count * 2 // 3, stays))
    assert case.happened
    assert case.wrong == []
