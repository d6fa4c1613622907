from __future__ import annotations

import json
import re
from pathlib import Path

WEB = Path(__file__).parents[2] / "dse" / "report" / "web"


def test_the_lock_file_pins_contents_but_no_address() -> None:
    packages = json.loads((WEB / "package-lock.json").read_text(encoding="utf-8"))["packages"]
    assert all("resolved" not in package for package in packages.values())
    assert all("integrity" in package for name, package in packages.items() if name)


def test_only_the_chosen_libraries_come_with_the_page() -> None:
    wanted = json.loads((WEB / "package.json").read_text(encoding="utf-8"))["dependencies"]
    assert sorted(wanted.keys() - {"esbuild"}) == ["d3-contour", "d3-scale", "three", "uplot"]  # it makes the bundle


def test_the_sources_write_text_never_markup() -> None:
    sources = "\n".join(path.read_text(encoding="utf-8") for path in sorted((WEB / "src").rglob("*.ts")))
    assert not re.search(r"innerHTML|outerHTML|insertAdjacentHTML|document\.write|\beval\(|new Function", sources)


def test_page_and_python_agree_on_what_the_numbers_mean() -> None:
    marks = (WEB / "src" / "marks.ts").read_text(encoding="utf-8")
    from dse.report.verdicts import Mark

    names = {"PASS": Mark.PASS, "FAIL": Mark.FAIL, "NOT_EXERCISED": Mark.NOT_EXERCISED, "FAILED": Mark.FAILED_TO_RUN}
    for name, mark in names.items():
        assert f"export const {name} = {int(mark)};" in marks


def test_the_bundle_is_not_older_than_its_sources() -> None:
    built = (WEB / "dist" / "report.js").stat().st_mtime
    newer = [path.name for path in (WEB / "src").rglob("*") if path.is_file() and path.stat().st_mtime > built]
    assert newer == [], "build it: make web"
