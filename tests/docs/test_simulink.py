"""docs/simulink.md: whoever does what it says has a study of a coded controller, and its report."""

from __future__ import annotations

import json
import re
import shlex
from collections.abc import Callable
from pathlib import Path

import pytest
from command_line import run_dse

pytest.importorskip("clang.cindex")

TEXT = (Path(__file__).parents[2] / "docs" / "simulink.md").read_text(encoding="utf-8")
BLOCK = re.compile(r"^```(sh|yaml)\n(.*?)^```$", re.DOTALL | re.MULTILINE)


@pytest.mark.thorough
def test_the_page_leads_from_a_folder_of_code_to_a_report(tmp_path: Path, built_before: Callable[[Path], Path]) -> None:
    cache = built_before(tmp_path / "cache")
    here, done, said = tmp_path, [], {}
    for kind, text in BLOCK.findall(TEXT):
        if kind == "yaml":
            (here / text.splitlines()[0].removeprefix("# ")).write_text(text, encoding="utf-8")
            continue
        for line in text.splitlines():
            command, *arguments = shlex.split(line, comments=True)
            if command == "cd":
                here = here / arguments[0]
                continue
            assert command == "dse"
            result = run_dse(here, *arguments, cache=cache)
            assert result.returncode == 0, (line, result.stdout, result.stderr)
            done.append(arguments[0])
            said[line] = result.stdout
    assert done == [
        *("init", "import", "check", "compare-components"),
        *("probe", "simulate", "explore", "explore", "report"),
    ]
    imported = next(said[line] for line in said if line.startswith("dse import"))
    shown = re.search(r"```text\n(.*?)```", TEXT, re.DOTALL)
    assert shown
    for line in shown[1].splitlines():
        words = line.split()
        assert words == ["…"] or any(words == told.split() for told in imported.splitlines()), line
    assert "kp_gap" in (here / "out" / "gains" / "report.html").read_text(encoding="utf-8")
    tables = [
        json.loads(run_dse(here, "results", f"out/{name}", "--format", "json", cache=cache).stdout)["runs"]
        for name in ("gains", "fused")
    ]
    assert len(tables[0]) == 32
    for one, other in zip(*tables, strict=True):
        assert one["metrics"] == other["metrics"]
    # Both controllers compute the same: each point has two runs with the same metrics.
    points: dict[str, set[str]] = {}
    for run in tables[0]:
        variables = json.dumps(run["point"], sort_keys=True)
        points.setdefault(variables, set()).add(json.dumps(run["metrics"], sort_keys=True))
    assert [len(metrics) for metrics in points.values()] == [1] * 16
