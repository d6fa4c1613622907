"""The sheet of requirements in a real browser: it says what `dse results --format requirements` says, and prints."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Callable
from pathlib import Path

import pytest
from pair_cases import PAIR_CASES, pair_study, pair_table
from playwright.sync_api import Page
from report_pages import open_tab

from dse.domain.provenance import Provenance, SourceText, digest_of
from dse.report import ReportContent, read_content
from dse.storage import EXPORTS, StudyFolder, Units

pytestmark = [pytest.mark.browser, pytest.mark.thorough]

Open = Callable[[ReportContent], Page]


def test_the_sheet_is_the_table_of_requirements(tmp_path: Path, open_report: Open) -> None:
    folder = tmp_path / "study"
    pair_table(folder, [row for row in PAIR_CASES["runs"] if row[1] == 0])
    digest = digest_of("study: pair")
    with StudyFolder.resume(folder, pair_study()) as store:
        store.note(Provenance((SourceText("study", "pair.pet.yaml", "study: pair", digest),)))
        rows = [*csv.DictReader(io.StringIO(EXPORTS["requirements"](store, Units.SHOWN).decode()))]
        fingerprint = store.header.fingerprint
    page = open_report(read_content(folder))
    open_tab(page, "sheet")
    order = page.locator("#sheet-designs code").all_inner_texts()
    assert order[0] == "q"  # it misses nothing
    for row in rows:
        cells = (
            page.locator(".sheet-table tbody tr").nth(order.index(row["configuration"])).locator("td").all_inner_texts()
        )
        assert cells[0][2:] == row["verdict"]
        assert cells[1:6] == [row[name] for name in ("points", "pass", "fail", "not exercised", "failed to run")]
        assert float(cells[6].replace("\u2212", "-")) == pytest.approx(float(row["least margin"]), abs=1e-3)
        assert cells[7] == row["run"]
        value, low, high = map(int, re.findall(r"\d+", cells[8]))
        assert [value, low, high] == [round(100 * float(row[name])) for name in ("met in", "from", "to")]
        assert len(cells[9].split(", ")) == max(1, int(row["fail"]))
    text = page.inner_text(".sheet-files")
    assert fingerprint in text
    assert digest in text


def test_the_sheet_prints_as_a_document(sliced: ReportContent, open_report: Open) -> None:
    page = open_report(sliced)
    open_tab(page, "sheet")
    page.emulate_media(media="print")
    assert not page.locator("#print-sheet").is_visible()
    assert not page.locator("nav").is_visible()
    assert page.locator(".sheet-table .run-button").first.is_visible()
    borders = page.eval_on_selector_all(
        ".sheet .card", "cards => cards.map(card => getComputedStyle(card).borderTopWidth)"
    )
    assert set(borders) == {"0px"}
    # Nothing is cut off at the right.
    page.set_viewport_size({"width": 700, "height": 1000})
    widths = page.eval_on_selector_all(
        ".sheet-table", "tables => tables.map(table => table.getBoundingClientRect().right)"
    )
    assert max(widths) <= 700
    assert page.pdf(format="A4").startswith(b"%PDF-")
