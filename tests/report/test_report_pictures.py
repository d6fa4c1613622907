"""Pictures that the page saves: SVG and PNG of what is shown."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np
import pytest
from playwright.sync_api import Browser, Page
from report_pages import Open, counts, open_tab

from dse.report.content.data import Floats, ReportContent

pytestmark = pytest.mark.browser


def saved_picture(page: Page, name: str, kind: str, target: Path) -> Path:
    """What the menu *name* saves as a picture of *kind*."""
    if page.locator(f"#save-{name}").locator("..").get_attribute("open") is None:
        page.click(f"#save-{name}")
    with page.expect_download() as saved:
        page.get_by_role("button", name=f"Picture ({kind})").locator("visible=true").click()
    saved.value.save_as(target)
    return target


@pytest.mark.thorough
def test_the_plot_saved_as_svg_is_the_plot_that_is_shown(
    sliced: ReportContent, open_report: Open, browser: Browser, tmp_path: Path
) -> None:
    from matplotlib.image import imread

    hostile = '<b>&"no\x07 \ud83d'
    named = (dataclasses.replace(sliced.requirements[0], title=hostile), *sliced.requirements[1:])
    # Numbers that are wide, so that the last stands at the very end of its axis.
    gain, *others = sliced.variables
    wide = dataclasses.replace(gain, low=1e5 * gain.low, high=1e5 * gain.high, values=1e5 * gain.values)
    page = open_report(dataclasses.replace(sliced, requirements=named, variables=(wide, *others)))
    svg = saved_picture(page, "constraint-plot", "SVG", tmp_path / "plot.svg")
    png = saved_picture(page, "constraint-plot", "PNG", tmp_path / "plot.png")
    root = ET.parse(svg).getroot()  # noqa: S314  # written by the page a line before
    space = "{http://www.w3.org/2000/svg}"
    texts = ["".join(text.itertext()) for text in root.iter(f"{space}text")]
    assert {"speed P gain [1/s]", "speed D gain [\u2013]", "speed overshoot = 0.5\u202f%", "pass"} <= set(texts)
    assert any(hostile[:7] in text and "\u2264 0.5" in text for text in texts)
    hatched = [path for path in root.iter(f"{space}path") if "url(" in path.get("fill", "")]
    assert len(hatched) == 2  # the region, and its sign in the legend
    assert not list(root.iter(f"{space}image"))
    # Of the points those that pass are one path, a circle each.
    passing = counts(page)[0]
    assert any(
        path.get("d", "").count("M") == passing == path.get("d", "").count("A") / 2
        for path in root.iter(f"{space}path")
    )
    width, height = (int(root.get(side, "0")) for side in ("width", "height"))
    drawn = browser.new_page(viewport={"width": width, "height": height}, device_scale_factor=2)
    drawn.goto(svg.as_uri())
    assert "300000" in texts
    ends = drawn.evaluate("[...document.querySelectorAll('text')].map(text => text.getBoundingClientRect().right)")
    assert max(ends) <= width
    drawn.screenshot(path=tmp_path / "drawn.png")
    drawn.close()
    there, here = (blurred(imread(path)[..., :3]) for path in (tmp_path / "drawn.png", png))
    assert there.shape == here.shape
    # Edges are smoothed differently; what is missing, or drawn elsewhere, is more than that.
    assert float(np.mean(np.abs(there - here).max(axis=2) > 0.06)) < 0.01


def blurred(pixels: Floats, side: int = 8) -> Floats:
    """Means of squares, (rows, columns, 3)."""
    rows, columns = (size // side for size in pixels.shape[:2])
    squares = pixels[: rows * side, : columns * side].reshape(rows, side, columns, side, 3)
    return np.asarray(squares.mean(axis=(1, 3)))


@pytest.mark.thorough
def test_every_panel_that_is_drawn_is_saved_as_svg(sliced: ReportContent, open_report: Open, tmp_path: Path) -> None:
    page = open_report(sliced)
    page.wait_for_selector(".figures .u-wrap")
    for view, names in {
        "plot": ("waveforms",),
        "designs": ("designs",),
        "runs": ("runs",),
        "figures": ("figures",),
    }.items():
        open_tab(page, view)
        for name in names:
            text = saved_picture(page, name, "SVG", tmp_path / f"{name}.svg").read_text(encoding="utf-8")
            ET.fromstring(text)  # noqa: S314  # written by the page a line before
            assert "<image" not in text
            assert "NaN" not in text
            assert text.count("<path") > 10
            assert "[%]" in text if name != "waveforms" else "time [s]" in text
