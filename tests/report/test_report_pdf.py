"""The report as PDF."""

from __future__ import annotations

import os
import re
import shutil
import sys
from pathlib import Path

import pytest

from dse.errors import DseError
from dse.report.content.data import ReportContent
from dse.report.page import pdf
from dse.report.page.pdf import BROWSERS, print_report


@pytest.fixture
def chromium() -> str:
    found = next((path for path in map(shutil.which, BROWSERS) if path), None)
    if found is None:
        if os.environ.get("CI"):
            pytest.fail(f"printing is tested with one of {', '.join(BROWSERS)}")
        pytest.skip(f"none of {', '.join(BROWSERS)} is installed")
    return found


@pytest.mark.thorough
def test_the_whole_report_is_printed(chromium: str, sliced: ReportContent, tmp_path: Path) -> None:
    print_report(sliced, tmp_path / "report.pdf")
    data = (tmp_path / "report.pdf").read_bytes()
    assert data.startswith(b"%PDF-")
    assert data.rstrip().endswith(b"%%EOF")
    assert len(re.findall(rb"/Type\s*/Page\b", data)) > 1
    # A page that was not drawn yet is a line of text, of a few kilobytes.
    assert len(data) > 60_000
    assert [path.name for path in tmp_path.iterdir()] == ["report.pdf"]


def test_without_a_browser_it_is_told_which_are_looked_for(
    sliced: ReportContent, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("CHROMIUM", raising=False)
    with pytest.raises(DseError, match=r"printing needs a Chromium: none of chromium, .*\n    hint: name another"):
        print_report(sliced, tmp_path / "report.pdf")
    monkeypatch.setenv("CHROMIUM", "my-chrome")
    with pytest.raises(DseError, match="there is no 'my-chrome', which CHROMIUM names"):
        print_report(sliced, tmp_path / "report.pdf")


@pytest.mark.skipif(sys.platform == "win32", reason="the browser of this test is a shell script")
@pytest.mark.parametrize(
    ("script", "words"),
    [
        ("echo no display >&2; exit 3", "could not be printed: no display"),
        ("exit 0", "could not be printed"),
        ("exec sleep 60", "not printed within 0.3 s"),
    ],
)
def test_a_browser_that_fails_or_hangs_leaves_the_file_as_it_was(
    script: str, words: str, sliced: ReportContent, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    browser = tmp_path / "browser"
    browser.write_text(f"#!/bin/sh\n{script}\n", encoding="utf-8")
    browser.chmod(0o755)
    (tmp_path / "report.pdf").write_bytes(b"as it was")
    monkeypatch.setenv("CHROMIUM", str(browser))
    monkeypatch.setattr(pdf, "PATIENCE", 0.3 if "sleep" in script else 60.0)
    with pytest.raises(DseError, match=words):
        print_report(sliced, tmp_path / "report.pdf")
    assert (tmp_path / "report.pdf").read_bytes() == b"as it was"


@pytest.mark.thorough
def test_a_place_that_cannot_be_written_is_named(chromium: str, sliced: ReportContent, tmp_path: Path) -> None:
    with pytest.raises(DseError, match=r"cannot write .*missing"):
        print_report(sliced, tmp_path / "missing" / "report.pdf")
