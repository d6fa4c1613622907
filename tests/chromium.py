"""The Chromium that pages are tested with."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

NAMES = ("chromium", "chromium-browser", "google-chrome")


@contextmanager
def started_chromium() -> Iterator[Browser]:
    """A browser of the machine; without one the test is skipped, in CI it fails."""
    from playwright.sync_api import sync_playwright

    found = next((path for path in map(shutil.which, NAMES) if path), None)
    if found is None:
        if os.environ.get("CI"):
            pytest.fail(f"browser tests need one of {', '.join(NAMES)}")
        pytest.skip(f"none of {', '.join(NAMES)} is installed")
    with sync_playwright() as playwright:
        # Without its sandbox Chromium also starts for root in a container; the pages are our own.
        started = playwright.chromium.launch(executable_path=found, args=["--no-sandbox"])
        yield started
        started.close()


def rest(page: Page, milliseconds: int) -> None:
    """Wait until the page has done and drawn what it does by itself within so many ms, of its own clock."""
    drawn = "() => requestAnimationFrame(() => requestAnimationFrame(done))"
    page.evaluate(f"pause => new Promise(done => setTimeout({drawn}, pause))", milliseconds)
