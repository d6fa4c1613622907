"""Every view of the page before axe-core, which looks for what keeps people from reading it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from chromium import rest
from hard_contents import driven, furnished
from report_pages import Open

from dse.report.content.data import ReportContent

if TYPE_CHECKING:
    from playwright.sync_api import Page

pytestmark = [pytest.mark.browser, pytest.mark.thorough]

AXE = Path(__file__).parents[2] / "dse" / "report" / "web" / "node_modules" / "axe-core" / "axe.min.js"


def complaints(page: Page, *rules: str) -> list[str]:
    """What axe-core says of the page as it stands, by these *rules* or all; each with the first element it is about."""
    found: list[str] = page.evaluate(
        "rules => axe.run(document, rules.length ? { runOnly: rules } : {})"
        ".then(({ violations }) => violations.map(v => `${v.id}: ${v.nodes[0].html}`))",
        rules,
    )
    return found


@pytest.mark.parametrize("study", ["sliced", "scattered", "bench_only", "conditions"])
def test_axe_finds_nothing_in_any_view(study: str, open_report: Open, request: pytest.FixtureRequest) -> None:
    if not AXE.exists():
        pytest.fail("axe-core is missing: 'npm ci' in dse/report/web brings it")
    content: ReportContent = furnished(driven()) if study == "conditions" else request.getfixturevalue(study)
    page = open_report(content)
    page.evaluate(f"{AXE.read_text(encoding='utf-8')}\n;0")
    themes, found = set(), {}
    # In the other theme only the colours are others.
    for rules in ((), ("color-contrast",)):
        theme = page.evaluate("document.documentElement.dataset.theme || 'light'")
        themes.add(theme)
        for tab in page.locator("[role=tab]").all():
            tab.click()
            rest(page, 300)
            if said := complaints(page, *rules):
                found[theme, tab.inner_text()] = said
        page.click("#theme")
    assert themes == {"light", "dark"}
    assert found == {}


def test_axe_sees_colours_that_are_too_near(sliced: ReportContent, open_report: Open) -> None:
    page = open_report(sliced)
    page.evaluate(f"{AXE.read_text(encoding='utf-8')}\n;0")
    page.evaluate("document.querySelector('h1').style = 'color: #888; background: #999'")
    assert any(said.startswith("color-contrast") for said in complaints(page, "color-contrast"))


def test_axe_finds_what_is_wrong(sliced: ReportContent, open_report: Open) -> None:
    page = open_report(sliced)
    page.evaluate(f"{AXE.read_text(encoding='utf-8')}\n;0")
    page.evaluate("document.querySelector('main').append(document.createElement('button'))")
    assert any(said.startswith("button-name") for said in complaints(page))
