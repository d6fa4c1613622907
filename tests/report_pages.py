"""What a reader sees of a page in a browser, and what Python says it should be."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

import numpy as np
from playwright.sync_api import Page

from dse.report import insight_of
from dse.report.content.data import (
    ConfigurationEntry,
    MetricColumn,
    ReportContent,
    ReportVariable,
    RequirementRow,
    Runs,
    SamplerKind,
)
from dse.report.verdicts import overall_marks
from dse.storage import RunTable

Open = Callable[[ReportContent], Page]
PLANE = slice(0, 121)
"""Runs of the plane that is shown first of the sliced study."""


def counts(page: Page) -> list[int]:
    """What the legend says: pass, fail, not exercised, failed to run."""
    open_cockpit(page)
    texts = [page.inner_text(f"#count-{kind}") for kind in ("pass", "fail", "open", "broken")]
    return [int(text.replace("\u202f", "")) for text in texts]


def expected(content: ReportContent, *bounds: float, runs: slice = slice(None)) -> list[int]:
    """The same of *runs* from Python, with the requirements' upper bounds replaced."""
    requirements = tuple(
        dataclasses.replace(requirement, at_most=bound)
        for requirement, bound in zip(content.requirements, bounds, strict=True)
    )
    marks = overall_marks(dataclasses.replace(content, requirements=requirements))[runs]
    return [int(count) for count in np.bincount(marks, minlength=4)]


def settle(page: Page) -> None:
    """Wait until what was changed has been drawn."""
    page.evaluate("() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")


def ground(page: Page) -> str:
    """The constraint plot's pixels."""
    settle(page)
    return str(page.evaluate("document.querySelector('canvas.ground').toDataURL()"))


def open_tab(page: Page, view: str) -> None:
    """Open a view, and wait until it stands."""
    page.click(f"#tab-{view}")
    settle(page)


def open_cockpit(page: Page) -> None:
    """Open the first view, unless it is open; a click would take the focus."""
    if page.get_attribute("#tab-plot", "aria-selected") == "false":
        page.click("#tab-plot")
    settle(page)


def selected(page: Page) -> int:
    open_cockpit(page)
    return int(page.inner_text("#selected-run").split()[1])


def content_of(table: RunTable, title: str = "made up", problem: str = "it broke at t = 3.5 s") -> ReportContent:
    """The report's content of a table, as its reading makes it of a folder."""
    definition = table.header.definition
    metrics = tuple(MetricColumn(m.name, m.title, m.unit, table.metric(m.name).copy()) for m in definition.metrics)
    return ReportContent(
        title,
        SamplerKind.SCATTERED,
        "out/made_up",
        Runs(
            table.numbers.copy(),
            table.configurations,
            table.done.copy(),
            tuple("" if ok else problem for ok in table.done),
        ),
        tuple(ConfigurationEntry(c.id, dict(c.choices), {}) for c in definition.configurations),
        tuple(
            ReportVariable(
                v.name, v.title, v.unit, v.low, v.high, v.levels or None, v.nominal, table.points[v.name].astype(float)
            )
            for v in definition.variables
        ),
        metrics,
        tuple(
            RequirementRow(r.name, r.title, r.metric, r.at_most, r.at_least, table.done & (table.verdicts(r.name) != 2))
            for r in definition.requirements
        ),
        insight=insight_of(table),
    )
