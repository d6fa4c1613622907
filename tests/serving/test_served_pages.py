"""Served pages in a real browser."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from chromium import rest, started_chromium
from playwright.sync_api import Browser, Page
from served_studies import TITLE, add_run

from dse.serving.open_studies import OpenStudies
from dse.storage import StudyFolder

pytestmark = [pytest.mark.browser, pytest.mark.thorough]


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with started_chromium() as started:
        yield started


@pytest.fixture
def opened(browser: Browser, client) -> Iterator[Callable[[str], Page]]:
    """Opens a page of the server; at the end nothing must have been logged, and nobody else asked."""
    base = f"http://127.0.0.1:{client.port}"
    context = browser.new_context(viewport={"width": 1440, "height": 900})
    complaints: list[str] = []

    def opened(path: str) -> Page:
        page = context.new_page()
        page.on("console", lambda message: complaints.append(message.text))
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.on(
            "request", lambda asked: None if asked.url.startswith((base, "data:")) else complaints.append(asked.url)
        )
        page.goto(base + path)
        return page

    yield opened
    context.close()
    assert complaints == []


def test_a_page_that_is_asked_for_again_has_the_new_runs(opened, workshop: Path) -> None:
    page = opened("/study/out/first/")
    page.wait_for_selector("nav.live[data-state=interrupted]")
    assert page.inner_text("#live-told") == "3 of 4 runs"
    assert not page.is_visible("#live-news")
    with StudyFolder.open(workshop / "out" / "first") as store:
        definition = store.header.definition
    with StudyFolder.resume(workshop / "out" / "first", definition) as folder:
        add_run(folder, 3, 0.25)
    page.reload()
    page.wait_for_selector("nav.live[data-state=finished]")
    assert page.inner_text("#live-told") == "4 of 4 runs"


def test_a_page_that_is_open_hears_of_new_runs(opened, workshop: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    told = {"state": "running", "runs": 40, "finished": 7, "rate": 12.0, "left": 100.0, "writer": "process 1 on vm"}
    monkeypatch.setattr(OpenStudies, "progress", lambda *_: told)
    page = opened("/study/out/first/")
    page.wait_for_selector("#live-news:visible")
    assert page.inner_text("#live-news") == "4 new runs – show"
    assert page.inner_text("#live-told") == "7 of 40 runs · 12 runs/s · about 2 min left"
    assert page.is_visible("#live-stop")
    with page.expect_navigation():
        page.click("#live-news")
    page.wait_for_selector("html[data-ready]")


def test_stopping_says_what_came_of_it(opened, workshop: Path, monkeypatch: pytest.MonkeyPatch, browser) -> None:
    monkeypatch.setattr(OpenStudies, "progress", lambda *_: {"state": "running", "runs": 4, "finished": 3})
    page = opened("/study/out/second/")
    page.route("**/stop?*", lambda route: route.fulfill(status=200, content_type="application/json", body="{}"))
    page.click("#live-stop")
    page.wait_for_function("document.getElementById('live-said').textContent.includes('finished runs are stored')")


def test_a_file_has_nothing_of_the_server(workshop: Path, browser: Browser, tmp_path: Path) -> None:
    from dse.api import results

    page = browser.new_page()
    page.goto(results(workshop / "out" / "first").report(tmp_path / "report.html").as_uri())
    page.wait_for_selector("html[data-ready]")
    assert page.locator("nav.live, .trying").count() == 0
    assert "connect-src" not in page.content()
    page.close()


def test_two_studies_are_ticked_and_compared(opened) -> None:
    page = opened("/")
    assert page.is_disabled("button[type=submit]")
    assert TITLE in page.inner_text("table")  # its markup is text
    page.check('input[value="out/first"]')
    page.check('input[value="out/second"]')
    page.click("button[type=submit]")
    page.wait_for_selector("h3")
    assert "1 of their verdicts differ" in page.inner_text("main")
    page.click("summary")
    assert "2 → 2" not in page.inner_text("details")
    assert "1 → 1" in page.inner_text("details")


@pytest.mark.parametrize("path", ["/", "/compare?a=out/first&b=out/second", "/study/out/first/"])
@pytest.mark.parametrize("width", [400, 1440])
def test_no_page_is_wider_than_its_window(opened, path: str, width: int) -> None:
    page = opened(path)
    page.set_viewport_size({"width": width, "height": 900})
    rest(page, 300)
    assert page.evaluate("document.documentElement.scrollWidth") <= width


def test_the_theme_can_be_changed_everywhere(opened) -> None:
    page = opened("/")
    before = page.evaluate("document.documentElement.dataset.theme")
    page.click("#theme")
    assert {before, page.evaluate("document.documentElement.dataset.theme")} == {"light", "dark"}
