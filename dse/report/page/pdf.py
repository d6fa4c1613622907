"""The page as PDF, printed by a Chromium of the machine."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

from dse.errors import Location, fail
from dse.report.content.data import ReportContent
from dse.report.figure import shown_figures
from dse.report.page.html import page_of
from dse.scratch import ScratchFolder, written_whole

BROWSERS = (
    "chromium",
    "chromium-browser",
    "google-chrome",
    "google-chrome-stable",
    "chrome",
    "msedge",
    "microsoft-edge",
)
"""What a Chromium is called, in the order in which they are looked for."""

PATIENCE = 180.0
"""Seconds it may take."""

OPTIONS = (
    "--headless",
    "--disable-extensions",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-default-browser-check",
    "--no-first-run",
    # The page asks for nothing, and neither may the browser.
    "--host-resolver-rules=MAP * ~NOTFOUND",
)
"""How a Chromium is started that shows a page of ours to nobody."""

_PRINTED = (
    "--disable-gpu",
    "--no-pdf-header-footer",
    # What the page draws as pixels is as fine as print wants it, in a window as wide as a sheet.
    "--force-device-scale-factor=3",
    "--window-size=757,1000",
    # Its clock goes on only while the page has nothing to do: what it is drawing is waited for.
    "--virtual-time-budget=60000",
)


def print_report(content: ReportContent, target: Path) -> None:
    """Write the page to *target* as PDF, all its views one after the other. Nothing is fetched.

    Raises DseError if there is no Chromium (``$CHROMIUM``, else one of `BROWSERS` on the path), or it fails.
    """
    browser = browser_for("printing")
    text = page_of(content, shown_figures(content))
    with ScratchFolder() as scratch:
        page, printed = Path(scratch, "report.html"), Path(scratch, "report.pdf")
        page.write_text(text, encoding="utf-8")
        profile = f"--user-data-dir={Path(scratch, 'profile')}"
        command = [
            browser,
            *OPTIONS,
            *_PRINTED,
            *rights(),
            profile,
            f"--print-to-pdf={printed}",
            f"{page.as_uri()}#print=all",
        ]
        where = Location(browser)
        try:
            done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, timeout=PATIENCE, check=False)
        except subprocess.TimeoutExpired:
            hint = "print a report with fewer waveforms (--waveforms), or the HTML page from a browser"
            raise fail(f"the page was not printed within {PATIENCE:g} s", where, hint) from None
        except OSError as error:
            raise fail(f"cannot be started: {error.strerror or error}", where, _HINT) from error
        if done.returncode or not _is_pdf(printed):
            said = done.stderr.decode("utf-8", "replace").strip().splitlines()[-1:] or ["it prints nothing"]
            raise fail(f"the page could not be printed: {said[0][:300]}", where, _HINT)
        with written_whole(target) as path:
            shutil.copyfile(printed, path)


_HINT = "name another Chromium in the environment variable CHROMIUM, or print the HTML page from a browser"


def browser_for(what: str) -> str:
    """The Chromium that *what* is done with: ``$CHROMIUM``, else one of `BROWSERS` on the path; DseError if none is."""
    named = os.environ.get("CHROMIUM")
    for name in [named] if named else BROWSERS:
        if found := shutil.which(name):
            return found
    if named:
        raise fail(f"there is no '{named}', which CHROMIUM names", hint="name a Chromium or Chrome, or unset it")
    raise fail(f"{what} needs a Chromium: none of {', '.join(BROWSERS)} is on the path", hint=_HINT)


def rights() -> list[str]:
    """For root Chromium starts without its sandbox only; the pages are our own and run no other code."""
    return ["--no-sandbox"] if hasattr(os, "geteuid") and os.geteuid() == 0 else []


def _is_pdf(path: Path) -> bool:
    return path.is_file() and path.read_bytes()[:5] == b"%PDF-"
