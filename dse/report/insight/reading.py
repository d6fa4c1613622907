"""A study folder → its insight: everything is bounded, and what cannot be told is named with its reason."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from dse.analysis import drawn, essentials, planes
from dse.report.content.data import ReportContent
from dse.report.content.insight import Insight
from dse.report.content.reading import MAX_WAVEFORMS, read_content
from dse.report.insight.findings import boxes_of, centres_of, insight_findings
from dse.report.insight.naming import Naming
from dse.report.insight.probability_maps import chances_of
from dse.report.insight.question import question_of
from dse.report.insight.responses import part_of
from dse.report.insight.sample import part_of_table
from dse.report.insight.search import search_of
from dse.storage import RunTable, StudyFolder

MOST_RUNS = 20_000
"""Of more runs, findings are told of so many drawn from them, and the page says so."""


def read_report(path: Path, most: int = MAX_WAVEFORMS) -> ReportContent:
    """All that a page shows of the study at *path*: `read_content`, and what its runs tell."""
    return replace(read_content(path, most), insight=read_insight(path))


def read_insight(path: Path) -> Insight:
    """What the study at *path* asked and what its runs tell. DseError if the folder is damaged."""
    with StudyFolder.open(path) as folder:
        folder.require_definition()
        return insight_of(folder.table())


def insight_of(table: RunTable) -> Insight:
    """The same of a table; equal tables give equal insights."""
    import scipy.linalg  # noqa: F401  # loads its own library, which is limited only once it is there
    from threadpoolctl import threadpool_limits

    # Sums then come in the same order on any number of processors; systems this small are no faster on more.
    with threadpool_limits(limits=1, user_api="blas"):
        return _insight(table)


def _insight(table: RunTable) -> Insight:
    naming = Naming(table.header.definition)
    asked = question_of(table, naming)
    if not len(table):
        return Insight(asked)
    every = np.arange(len(table))
    looked = table if len(table) <= MOST_RUNS else part_of_table(table, drawn(every, MOST_RUNS))
    parts = planes(looked)
    findings = essentials(looked, parts)
    chances, around, withheld = chances_of(looked, parts, naming)
    search, reasons = search_of(table, naming)
    return Insight(
        asked,
        insight_findings(findings, naming),
        tuple(box for data in parts for box in boxes_of(data, findings, naming)),
        tuple(centre for data in parts for centre in centres_of(data, naming)),
        tuple(part_of(data, naming) for data in parts if len(data)),
        chances,
        around,
        search,
        (*withheld, *reasons),
        len(looked) if looked is not table else 0,
    )
