"""What ``dse check`` prints for programs: JSON, SARIF and workflow commands, from hostile problems too."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
import typer

from dse.cli.commands.check import check
from dse.cli.diagnostics import Checked, CheckFormat, as_data, as_github, as_sarif
from dse.errors import Location, Problem

HOSTILE = "50 %\n::error::forged\r"
FOUND = Checked(
    problems=[
        Problem("wrong", Location("designs/a b.yaml", 3, 5), "did you mean 'x'?"),
        Problem(HOSTILE, Location("a:b,c.yaml", 2)),
        Problem("nowhere"),
    ],
    ignored=[Problem("unused", Location("x.ssp"))],
    notes=[Problem("of no use", Location("/far/x.ssp"))],
    counts={"study": 2},
)


def test_json_has_level_place_and_hint():
    data = as_data(FOUND)
    assert data["checked"] == {"study": 2}
    assert data["problems"][0] == {
        "level": "error",
        "file": "designs/a b.yaml",
        "line": 3,
        "column": 5,
        "message": "wrong",
        "hint": "did you mean 'x'?",
    }
    assert [each["level"] for each in data["problems"]] == ["error", "error", "error", "warning", "note"]
    assert data["problems"][2] == {"level": "error", "message": "nowhere", "hint": ""}


def test_sarif_places_are_addresses_and_regions():
    (run,) = as_sarif(FOUND)["runs"]
    rules = {rule["id"] for rule in run["tool"]["driver"]["rules"]}
    assert {result["ruleId"] for result in run["results"]} == rules
    assert run["results"][0]["message"]["text"] == "wrong (did you mean 'x'?)"
    places = [result["locations"][0]["physicalLocation"] for result in run["results"] if "locations" in result]
    assert places == [
        {"artifactLocation": {"uri": "designs/a%20b.yaml"}, "region": {"startLine": 3, "startColumn": 5}},
        {"artifactLocation": {"uri": "a%3Ab%2Cc.yaml"}, "region": {"startLine": 2, "startColumn": 1}},
        {"artifactLocation": {"uri": "x.ssp"}},
        {"artifactLocation": {"uri": "file:///far/x.ssp"}},
    ]


def test_a_message_cannot_forge_a_workflow_command():
    lines = as_github(FOUND)
    assert lines == [
        "::error file=designs/a b.yaml,line=3,col=5::wrong%0Ahint: did you mean 'x'?",
        "::error file=a%3Ab%2Cc.yaml,line=2::50 %25%0A::error::forged%0D",
        "::error ::nowhere",
        "::warning file=x.ssp::unused",
        "::notice file=/far/x.ssp::of no use",
    ]


@pytest.mark.parametrize("form", [CheckFormat.JSON, CheckFormat.SARIF, CheckFormat.GITHUB])
def test_mistakes_go_to_standard_output_and_end_with_1(
    form: CheckFormat, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    (tmp_path / "components").mkdir()
    (tmp_path / "designs").mkdir()
    (tmp_path / "designs" / "car.yaml").write_text("design: car\nrot: {}\n", encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    with pytest.raises(typer.Exit) as ended:
        check(form=form)
    told = capsys.readouterr().out
    assert ended.value.exit_code == 1
    assert "car.yaml" in told
    if form is not CheckFormat.GITHUB:
        json.loads(told)
    (tmp_path / "designs" / "car.yaml").unlink()
    with pytest.raises(typer.Exit) as ended:
        check(form=form)
    assert ended.value.exit_code == 0
