"""Two designs of a study on the terminal, in the sentences of the report's page (`pair.test.ts`)."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from command_line import run_dse
from pair_cases import pair_table


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("pair") / "study"
    pair_table(folder)
    return folder


def test_two_designs_are_decided_between(study: Path, tmp_path: Path) -> None:
    done = run_dse(study, "compare", ".", "--designs", "0", "30", cache=tmp_path)
    assert done.returncode == 0, done.stderr
    lines = done.stdout.splitlines()
    assert lines[0] == "A  a: cost 300 EUR, part a"
    assert lines[2:4] == [
        "Both miss 2 of 3 verdicts. B is ahead: its cost is 200 EUR, that of A 300 EUR.",
        (
            "In the same draws, the rates differ with 95 % confidence in none of 3 verdicts: with other draws the"
            " order may differ."
        ),
    ]
    told = done.stdout.split("What would change the order\n")[1].splitlines()
    assert told == [
        "  R: with at least 1.897 instead of 2, A is ahead",
        "  R: with more than 2.102 instead of 2, A is ahead",
        "  cost: if A's is lower by more than 100 EUR, or B's higher by more than that, A is ahead",
        "no certain change of the difference with speed, gain",
        "Which numbers are assumed was not kept with this study.",
    ]


def test_a_decision_is_also_plain_data(study: Path, tmp_path: Path) -> None:
    done = run_dse(study, "compare", ".", "--designs", "0", "q", "--format", "json", cache=tmp_path)
    assert done.returncode == 1
    assert "'q' is the start of several designs" in done.stderr
    done = run_dse(study, "compare", ".", "--designs", "0", "60", "--format", "json", cache=tmp_path)
    found = json.loads(done.stdout)
    assert (found["ahead"], found["first"]["missed"], found["second"]["missed"]) == ("B", 2, 0)
    assert [pair["case"] for pair in found["pairs"]] == [[10], [20], [30]]
    assert found["leading"]["R"]["value"] == 0
