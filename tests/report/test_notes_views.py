"""What is kept with a study besides its runs, in a real browser."""

from __future__ import annotations

from dataclasses import replace

import pytest
from report_pages import Open, open_tab

from dse.domain.provenance import Absent, Funnel, Left, Provenance, SourceText, digest_of
from dse.report.content.data import ReportContent, Retried
from dse.report.content.insight import Asked, Insight

pytestmark = pytest.mark.browser

HOSTILE = '</script><img src=x onerror="window.pwned=1"><b>\u202e'
TEXT = f"study: gains\n# {HOSTILE}\n{'x' * 10_000}\n"
FUNNEL = Funnel(
    f"vehicle{HOSTILE}",
    624.0,
    "624",
    (
        Left("budget", "the price", "sum(cost) < 9 EUR", 312.0, "312"),
        Left(HOSTILE, "", "sensor is radar", 312.0, "312"),
    ),
    (Absent("sensor", "lidar", ("budget",)), Absent("video", "wide", ())),
)


def _with(content: ReportContent, notes: Provenance | None, *retried: Retried) -> ReportContent:
    count = len(content.variables), len(content.metrics), len(content.requirements)
    asked = Asked((), *(("",) * number for number in (count[0], count[0], count[1], count[2])))
    return replace(content, insight=Insight(asked), notes=notes, retried=retried)


@pytest.mark.thorough
def test_files_are_shown_as_text_and_nothing_else(sliced: ReportContent, open_report: Open) -> None:
    source = SourceText("study", f"gains{HOSTILE}.yaml", TEXT, digest_of(TEXT))
    page = open_report(_with(sliced, Provenance((source,))))
    open_tab(page, "overview")
    page.click("#sources summary")
    shown = page.text_content("#sources pre")
    assert shown == TEXT.replace("\u202e", "\\u202e")
    assert digest_of(TEXT) in page.inner_text("#sources")
    assert page.evaluate("window.pwned") is None
    assert page.evaluate("document.documentElement.scrollWidth") <= 1440


@pytest.mark.thorough
def test_a_study_without_its_files_says_so(sliced: ReportContent, open_report: Open) -> None:
    page = open_report(_with(sliced, None))
    open_tab(page, "overview")
    assert "not kept with this study" in page.inner_text("#sources")


@pytest.mark.thorough
def test_tries_that_were_made_again_are_warned_of(sliced: ReportContent, open_report: Open) -> None:
    retried = (
        Retried("worker crashed (signal 11)", tuple(range(20))),
        Retried("stopped with the program", (3,)),
    )
    page = open_report(_with(sliced, None, *retried))
    open_tab(page, "overview")
    lines = {text for text in page.locator("#warnings li").all_inner_texts() if "more than one try" in text}
    assert len(lines) == 2
    assert any("20 runs (0, 1, 2, 3, 4, 5, 6, 7, …) needed more than one try: worker crashed" in line for line in lines)
    assert page.locator("#warnings li.warn", has_text="crashed").count() == 1
    assert page.locator("#warnings li.note", has_text="stopped with the program").count() == 1


@pytest.mark.thorough
def test_what_constraints_leave_is_a_waterfall(sliced: ReportContent, open_report: Open) -> None:
    page = open_report(_with(sliced, Provenance(funnel=FUNNEL)))
    open_tab(page, "designs")
    rows = page.locator("#funnel tbody tr").all()
    assert [row.locator("td").first.inner_text() for row in rows][:3] == [
        "624 (100\u202f%)",
        "312 (50\u202f%)",
        "312 (50\u202f%)",
    ]
    widths = [row.locator(".bar").bounding_box()["width"] for row in rows]  # type: ignore[index]
    assert widths[1] == pytest.approx(widths[0] / 2, abs=1)
    assert "excludes nothing more" in rows[2].inner_text()
    first, second = page.locator("#absent li").all_inner_texts()
    assert first == "sensor = lidar appears in no valid configuration because of budget (the price)."
    assert "other choices exclude it" in second
    assert page.evaluate("window.pwned") is None
