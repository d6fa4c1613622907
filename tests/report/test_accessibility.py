"""Every view of the page before axe-core, which looks for what keeps people from reading it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from report_pages import Open

from dse.report.content.nouns import ReportContent

if TYPE_CHECKING:
    from playwright.sync_api import Page

pytestmark = [pytest.mark.browser, pytest.mark.thorough]

AXE = Path(__file__).parents[2] / "dse" / "report" / "web" / "node_modules" / "axe-core" / "axe.min.js"


def complaints(page: Page) -> list[str]:
    """What axe-core says of the page as it stands; each with the first element it is about."""
    found: list[str] = page.evaluate(
        "() => axe.run(document).then(({ violations }) => violations.map(v => `${v.id}: ${v.nodes[0].html}`))"
    )
    return found


@pytest.mark.parametrize("study", ["sliced", "scattered", "bench_only"])
@pytest.mark.parametrize("theme", ["light", "dark"])
def test_axe_finds_nothing_in_any_view(
    study: str, theme: str, open_report: Open, request: pytest.FixtureRequest
) -> None:
    if not AXE.exists():
        pytest.fail("axe-core is missing: 'npm ci' in dse/report/web brings it")
    content: ReportContent = request.getfixturevalue(study)
    page = open_report(content)
    if page.evaluate("document.documentElement.dataset.theme || 'light'") != theme:
        page.click("#theme")
    page.evaluate(f"{AXE.read_text(encoding='utf-8')}\n;0")
    found = {}
    for tab in page.locator("[role=tab]").all():
        tab.click()
        page.wait_for_timeout(300)
        if said := complaints(page):
            found[tab.inner_text()] = said
    assert found == {}


def test_axe_finds_what_is_wrong(sliced: ReportContent, open_report: Open) -> None:
    page = open_report(sliced)
    page.evaluate(f"{AXE.read_text(encoding='utf-8')}\n;0")
    page.evaluate("document.querySelector('main').append(document.createElement('button'))")
    assert any(said.startswith("button-name") for said in complaints(page))
