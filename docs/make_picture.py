"""Makes the pictures of the README and of the tour, and its table of the picked run.

Run it after `make demo` and, for the third picture, `dse explore electric_acc_search` and
`dse report electric_acc_search`.
"""

from __future__ import annotations

import re
import shutil
import sys
from pathlib import Path

from playwright.sync_api import sync_playwright

from dse.report.content.reading import read_content
from dse.report.figures.waveforms import default_run

ROOT = Path(__file__).resolve().parents[1]
STUDY = ROOT / "out" / "acc_gains"
SEARCH = ROOT / "out" / "electric_acc_search"
MARKS = ("<!-- picked run: begin -->", "<!-- picked run: end -->")


def main() -> None:
    """Write docs/images/*.png and the lines between the tour's marks."""
    browser_path = shutil.which("chromium") or shutil.which("google-chrome")
    missing = [str(study) for study in (STUDY, SEARCH) if not (study / "report.html").exists()]
    if browser_path is None or missing:
        sys.exit(f"needs chromium, and a report in {' and '.join(missing) or 'every study'}")
    images = ROOT / "docs" / "images"
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=browser_path, args=["--no-sandbox"])
        page = browser.new_page(viewport={"width": 1440, "height": 900})
        page.goto((STUDY / "report.html").as_uri())
        page.wait_for_selector("html[data-ready]")
        page.wait_for_timeout(1500)
        page.screenshot(path=images / "acc_gains.png")
        page.get_by_text("distance P gain × distance D gain").first.click()
        page.wait_for_timeout(500)
        box = page.locator('[aria-roledescription="constraint plot"]').bounding_box()
        page.screenshot(path=images / "acc_gains_distance.png", clip=box)
        page.goto((SEARCH / "report.html").as_uri())
        page.wait_for_selector("html[data-ready]")
        page.click("#tab-designs")
        page.wait_for_timeout(500)
        page.screenshot(path=images / "electric_acc_designs.png")
        browser.close()
    tour = ROOT / "docs/tour.md"
    text = tour.read_text(encoding="utf-8")
    pattern = re.compile(f"{re.escape(MARKS[0])}.*?{re.escape(MARKS[1])}", re.DOTALL)
    tour.write_text(pattern.sub(lambda _: f"{MARKS[0]}\n{_table()}\n{MARKS[1]}", text), encoding="utf-8")


def _table() -> str:
    content = read_content(STUDY)
    number = default_run(content)
    row = content.runs.numbers.tolist().index(number)
    columns = [*content.variables, *(m for m in content.metrics if m.name in _SHOWN)]
    heads = [f"{c.title} [{c.unit_symbol}]" if c.unit_symbol else c.title for c in columns]
    cells = [f"{c.values[row]:.4g}" for c in columns]
    lines = [["run", *heads], ["--:"] * (len(heads) + 1), [str(number), *cells]]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


_SHOWN = ("speed_overshoot", "gap_undershoot", "settling_time", "final_gap", "final_speed")


if __name__ == "__main__":
    main()
