"""Every view with contents that are hard to show, at every width, light and dark."""

from __future__ import annotations

import pytest
from hard_contents import CONTENTS
from report_pages import Open, open_tab, settle

pytestmark = [pytest.mark.browser, pytest.mark.thorough]

WIDTHS = (400, 768, 1440, 2560)

OUTSIDE = """() => [...document.querySelectorAll('main *, header *, nav *')].filter(each => {
    const box = each.getBoundingClientRect();
    if (!box.width || !box.height || box.right <= innerWidth + 1) return false;
    // What lies in a box of its own that scrolls or cuts may be wider.
    for (let parent = each.parentElement; parent; parent = parent.parentElement) {
        if (getComputedStyle(parent).overflowX !== 'visible') return false;
    }
    return true;
}).map(each => each.outerHTML.slice(0, 120))"""


@pytest.mark.parametrize("name", CONTENTS)
def test_every_view_shows_it_at_every_width(name: str, open_report: Open) -> None:
    page = open_report(CONTENTS[name]())
    tabs = page.locator("[role=tab]").evaluate_all("tabs => tabs.map(tab => tab.id.slice(4))")
    assert {"plot", "overview"} <= set(tabs)
    for theme in ("light", "dark"):
        for view in tabs:
            open_tab(page, view)
            for width in WIDTHS:
                page.set_viewport_size({"width": width, "height": 900})
                settle(page)
                assert page.evaluate("document.documentElement.scrollWidth") <= width, (view, width)
                assert page.evaluate(OUTSIDE) == [], (view, width)
            assert not set(page.inner_text("body")) & {"\u202e", "\u2067"}, view
        if theme == "light":
            page.click("#theme")
    assert page.evaluate("window.pwned") is None
    assert page.locator("main img").count() == 0
    assert "NaN" not in page.inner_text("main")
