"""How fast the report's page is in headless Chromium: first paint, a slider, a brush, and in Designs margin and brush.

    python benchmarks/bench_report_page.py [runs ...]

The runs are those of a made-up study of two metrics over four design variables, on a grid of two and scattered. First
paint is the processor time from the start of the navigation until the page stands; the others are what one change
takes, from the page's own marks. The median of nine changes is told. Where Plotly and HiPlot are installed, their pages
of the same runs stand below: a scatter of the first two variables in colour and parallel coordinates of all columns.
"""

from __future__ import annotations

import shutil
import statistics
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from playwright.sync_api import Browser, Page, sync_playwright

from dse.report.content.data import (
    ConfigurationEntry,
    MetricColumn,
    ReportContent,
    ReportVariable,
    RequirementRow,
    Runs,
    SamplerKind,
)
from dse.report.page.html import write_report

VARIABLES = ("kp_speed", "kd_speed", "kp_gap", "kd_gap")


def study(runs: int, sampler: SamplerKind) -> ReportContent:
    """About *runs* runs; on a grid the last two variables stay where they are."""
    random = np.random.default_rng(1)
    if sampler is SamplerKind.FULL_FACTORIAL:
        side = round(runs**0.5)
        runs = side * side
        levels = np.linspace(0, 1, side)
        points = np.stack([np.tile(levels, side), np.repeat(levels, side), np.full(runs, 0.5), np.full(runs, 0.5)])
    else:
        points = random.random((4, runs))
    a, b, c, d = points
    overshoot = 12 * a * (1.2 - b) + 2 * np.sin(6 * c) + 0.5 * d - 4
    undershoot = 8 * (1 - a) * b + 3 * (c - d) ** 2 - 2
    return ReportContent(
        "Benchmark",
        sampler,
        "out/benchmark",
        Runs(np.arange(runs), ("c1",) * runs, np.ones(runs, dtype=bool), ("",) * runs),
        (ConfigurationEntry("c1", {}, {}),),
        tuple(ReportVariable(name, name, "1/s", 0.0, 1.0, None, 0.5, points[i]) for i, name in enumerate(VARIABLES)),
        (MetricColumn("overshoot", "overshoot", "%", overshoot), MetricColumn("gap", "undershoot", "%", undershoot)),
        (
            RequirementRow("R1", "no overshoot", "overshoot", 0.5, None, np.ones(runs, dtype=bool)),
            RequirementRow("R2", "no undershoot", "gap", 1.0, None, a + b > 0.2),
        ),
    )


def plotly_page(content: ReportContent, target: Path) -> None:
    """A scatter and parallel coordinates by Plotly, offline in one file. ImportError without it."""
    import plotly.graph_objects as go
    from plotly.subplots import make_subplots

    x, y, *_ = content.variables
    colour = content.metrics[0].values
    figure = make_subplots(rows=2, cols=1, specs=[[{"type": "xy"}], [{"type": "domain"}]])
    figure.add_trace(go.Scattergl(x=x.values, y=y.values, mode="markers", marker={"color": colour, "size": 4}), 1, 1)
    columns = [{"label": each.name, "values": each.values} for each in (*content.variables, *content.metrics)]
    figure.add_trace(go.Parcoords(dimensions=columns, line={"color": colour}), 2, 1)
    figure.write_html(target, include_plotlyjs=True, post_script="document.documentElement.dataset.ready = 'yes'")


def hiplot_page(content: ReportContent, target: Path) -> None:
    """Parallel coordinates by HiPlot, offline in one file. ImportError without it."""
    import hiplot

    columns = {each.name: each.values.tolist() for each in (*content.variables, *content.metrics)}
    rows = [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]
    text = hiplot.Experiment.from_iterable(rows).to_html()
    target.write_text(text.replace("</body>", f"<script>{_WHEN_DRAWN}</script></body>"), encoding="utf-8")


_WHEN_DRAWN = """const drawn = setInterval(() => {
  if (!document.querySelector("canvas")) return;
  clearInterval(drawn);
  document.documentElement.dataset.ready = "yes";
}, 5);"""

OTHERS = {"Plotly": plotly_page, "HiPlot": hiplot_page}


def opened(browser: Browser, report: Path) -> tuple[Page, float, float]:
    """The page, and what its first paint took: seconds of processor time and of wall time."""
    page = browser.new_page(viewport={"width": 1440, "height": 900})
    session = page.context.new_cdp_session(page)
    session.send("Performance.enable", {"timeDomain": "threadTicks"})
    started = time.perf_counter()
    page.goto(report.as_uri())
    page.wait_for_selector("html[data-ready]", timeout=120_000)
    page.evaluate("() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")
    wall = time.perf_counter() - started
    metrics = {entry["name"]: entry["value"] for entry in session.send("Performance.getMetrics")["metrics"]}
    return page, metrics["TaskDuration"], wall


CHANGES = """async (kind) => {
  const took = [];
  const frame = () => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)));
  for (let turn = 0; turn < 9; turn++) {
    performance.clearMeasures("update");
    if (kind !== "brush") {
      const slider = document.getElementById(kind === "slider" ? "slider-atMost-0" : "demand");
      slider.value = Number(slider.min) + (0.3 + 0.05 * turn) * (slider.max - slider.min);
      slider.dispatchEvent(new Event("input"));
    } else {
      document.getElementById("limit-low").value = 0.1 + 0.02 * turn;
      document.getElementById("limit-high").value = 0.8;
      document.getElementById("limit").requestSubmit();
    }
    await frame();
    // What waits until a slider rests is no part of a move.
    if (kind !== "slider") await new Promise(done => setTimeout(done, 400));
    took.push(performance.getEntriesByName("update").reduce((sum, { duration }) => sum + duration, 0));
  }
  return took;
}"""


def others(browser: Browser, content: ReportContent, folder: Path) -> None:
    """A line for each page that another program makes of *content*."""
    for name, make in OTHERS.items():
        target = folder / f"{name}.html"
        started = time.process_time()
        try:
            make(content, target)
        except ImportError:
            continue
        written = time.process_time() - started
        page, processor, wall = opened(browser, target)
        page.close()
        size = target.stat().st_size / 1e6
        print(f"{name:>28} {size:6.1f} MB {written:7.1f} s {processor:6.2f} s ({wall:5.2f} s wall)")


def main(sizes: list[int]) -> None:
    """Prints one line for each study."""
    chromium = shutil.which("chromium") or shutil.which("google-chrome")
    heads = "".join(f" {each:>9}" for each in ("slider", "brush", "margin", "brush"))
    print(f"{'study':28} {'file':>9} {'written':>9} {'first paint':>22}{heads}")
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
        for runs in sizes:
            for sampler in (SamplerKind.FULL_FACTORIAL, SamplerKind.SCATTERED):
                report = Path(folder) / "report.html"
                started = time.process_time()
                write_report(study(runs, sampler), report)
                written = time.process_time() - started
                page, processor, wall = opened(browser, report)
                took = [statistics.median(page.evaluate(CHANGES, kind)) for kind in ("slider", "brush")]
                page.click("#tab-designs")
                page.wait_for_timeout(1000)
                took += [statistics.median(page.evaluate(CHANGES, kind)) for kind in ("margin", "brush")]
                page.close()
                print(
                    f"{runs:>9} {sampler!s:18} {report.stat().st_size / 1e6:6.1f} MB {written:7.1f} s "
                    f"{processor:6.2f} s ({wall:5.2f} s wall) " + " ".join(f"{each:6.1f} ms" for each in took)
                )
                others(browser, study(runs, sampler), Path(folder))
        browser.close()


if __name__ == "__main__":
    main([int(size) for size in sys.argv[1:]] or [2178, 100_000])
