"""The view that decides between two designs, in a real browser: it says what `dse compare` says."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from pair_cases import pair_table
from playwright.sync_api import Page
from report_pages import settle

from dse.analysis import decide_between
from dse.report import ReportContent, read_content, read_report
from dse.storage import RunTable

pytestmark = [pytest.mark.browser, pytest.mark.thorough]

Open = Callable[[ReportContent], Page]


@pytest.fixture(scope="module")
def studied(tmp_path_factory: pytest.TempPathFactory) -> tuple[RunTable, Path]:
    folder = tmp_path_factory.mktemp("pair") / "study"
    return pair_table(folder), folder


def test_two_designs_are_chosen_by_keyboard_and_decided_between(
    studied: tuple[RunTable, Path], open_report: Open
) -> None:
    table, folder = studied
    page = open_report(read_content(folder))
    page.click("#tab-pair")
    settle(page)
    for select, text in (("#pair-first", "a, gain 0"), ("#pair-second", "b, gain 0")):
        page.focus(select)
        page.keyboard.type(text)
        settle(page)
    assert "pair.designs=" in page.evaluate("new Promise(done => setTimeout(() => done(location.hash), 400))")
    found = decide_between(table, "0", str(table.configurations.index("b")))
    assert page.inner_text("#pair-order") == (
        "Both miss 2 of 3 verdicts. B is ahead: its cost is 200\u202fEUR, that of A 300\u202fEUR."
    )
    totals = page.locator("#pair-totals tbody td").all_inner_texts()
    draws = [sum(getattr(pair, what) for pair in found.pairs) for what in ("both", "first", "second", "neither")]
    assert totals[:7] == ["3", "1", "1", *map(str, draws)]
    page.keyboard.press("Tab")
    page.keyboard.press("Enter")
    settle(page)
    assert "A is ahead" in page.inner_text("#pair-order")
    assert page.evaluate("document.activeElement.id") == "pair-swap"
    rows = page.locator("#pair-cases tbody tr").count()
    page.check("#pair-all")
    settle(page)
    assert (rows, page.locator("#pair-cases tbody tr").count()) == (2, 3)
    assert page.inner_text("#pair-assumed") == "Which numbers are assumed was not kept with this study."


def test_a_threshold_that_is_moved_is_judged_in_every_draw(studied: tuple[RunTable, Path], open_report: Open) -> None:
    _, folder = studied
    page = open_report(read_content(folder))
    page.evaluate("location.hash = 'view=pair&pair.designs=0,30&bounds=0:-100:'")
    settle(page)
    assert "Both miss none of 3 verdicts" in page.inner_text("#pair-order")
    assert page.locator("#pair-totals tbody td").all_inner_texts()[3:7] == ["15", "0", "0", "0"]


def test_the_overview_names_the_design_to_take_at_the_thresholds_that_are_set(
    studied: tuple[RunTable, Path], open_report: Open
) -> None:
    _, folder = studied
    page = open_report(read_report(folder))
    page.click("#tab-overview")
    settle(page)
    assert page.inner_text("#choice-name") == "q (q, run 63)"
    page.click("#choice-worst")
    settle(page)
    assert page.get_attribute("#tab-plot", "aria-selected") == "true"
    page.evaluate("location.hash = 'view=overview&bounds=0:-100:'")
    settle(page)
    assert page.inner_text("#choice-name").startswith("b (b, run ")
    assert "6 of 6 designs do." in page.inner_text("#choice")
    page.click("#choice-against")
    settle(page)
    assert "A is ahead" in page.inner_text("#pair-order")
