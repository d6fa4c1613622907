"""docs/tutorial.md: whoever does what it says, from the first block to the last, has a study and its report."""

from __future__ import annotations

import csv
import re
import shlex
from collections.abc import Callable
from pathlib import Path

import pytest
from command_line import run_dse

TEXT = (Path(__file__).parents[2] / "docs" / "tutorial.md").read_text(encoding="utf-8")
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
FILE = re.compile(r"(?:# |/\* )([\w./]+?)(?: \*/)?\n")


@pytest.mark.thorough
def test_the_page_leads_from_an_empty_folder_to_a_report(tmp_path: Path, built_before: Callable[[Path], Path]) -> None:
    here, done, cache = tmp_path, [], built_before(tmp_path / "cache")
    for kind, text in BLOCK.findall(TEXT):
        if kind in ("yaml", "c"):
            named = FILE.match(text)
            assert named, text
            target = here / named[1]
            target.parent.mkdir(exist_ok=True, parents=True)
            target.write_text(text, encoding="utf-8")
            continue
        assert kind == "sh"
        for line in text.splitlines():
            command, *arguments = shlex.split(line, comments=True)
            if command in ("cd", "mkdir"):
                here = here / arguments[0] if command == "cd" else here
                (here if command == "cd" else here / arguments[0]).mkdir(exist_ok=True)
                continue
            assert command == "dse"
            result = run_dse(here, *arguments, cache=cache)
            assert result.returncode == 0, (line, result.stdout, result.stderr)
            done.append((line, result.stdout))
    said = dict(done)
    assert said["dse check"].startswith("ok: ")
    assert "2 of 2 configurations are valid" in said["dse enumerate drive"]
    assert said["dse explore gains"].startswith("out/gains: 216 runs, 216 of them new")
    assert "out/start_off  start_off  finished" in said["dse list"]
    learnt = said["dse findings gains"]
    assert "all requirements: met at both conditions in 19 %" in learnt
    assert "(estimated from 21 of 108 designs)" in learnt
    assert "all requirements: met at both conditions if keeper.gain > 140 kg/s and keeper.rate > 15 kg/s2: " in learnt
    assert "robot.mass is" not in learnt
    ranked = said["dse best gains --minimize roughness"].splitlines()
    assert ranked[0].startswith("of 108 designs 21 meet all requirements")
    assert re.search(r"148\.2 kg/s +30 kg/s2", ranked[2])
    assert (here / "out" / "gains" / "report.html").stat().st_size > 100_000
    with (here / "gains.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert {row["keeper"] for row in rows} == {"keeper"}
    # Without an integral, drag and rolling leave an error; a fast run reaches the pace by the motors' limit.
    plain = [float(row["rest [km/h]"]) / 3.6 for row in rows if float(row["keeper.rate [kg/s2]"]) == 0]
    assert min(plain) > 8 / 200 * 0.5
    assert {row["exact.verdict"] for row in rows if float(row["keeper.rate [kg/s2]"]) == 0} == {"fail"}
    verdicts = [{row[f"{name}.verdict"] for name in ("calm", "quick", "exact")} for row in rows]
    assert {"pass"} in verdicts


def test_every_file_of_the_page_is_named_in_its_first_line() -> None:
    named = [FILE.match(text) for kind, text in BLOCK.findall(TEXT) if kind != "sh"]
    assert len(named) > 8
    assert all(named)
