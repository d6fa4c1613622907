"""Verdicts of runs at thresholds that the reader may move; the page computes the same in the browser."""

from __future__ import annotations

from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from dse.report.content.nouns import Floats, ReportContent, RequirementRow


class Mark(IntEnum):
    """How a run is marked in the plot and counted; the numbers are those of the page's ``verdicts.ts``."""

    PASS = 0
    FAIL = 1
    NOT_EXERCISED = 2
    FAILED_TO_RUN = 3


Marks = NDArray[np.uint8]


def marks_of(content: ReportContent, requirement: RequirementRow) -> Marks:
    """The mark of every run for one requirement. An undefined metric does not pass: comparisons with NaN are false."""
    values = content.metric(requirement.metric).values
    inside = np.ones(len(values), dtype=np.bool_)
    if requirement.at_most is not None:
        inside &= values <= requirement.at_most
    if requirement.at_least is not None:
        inside &= values >= requirement.at_least
    marks = np.where(inside, Mark.PASS, Mark.FAIL).astype(np.uint8)
    marks[~requirement.exercised] = Mark.NOT_EXERCISED
    marks[~content.runs.done] = Mark.FAILED_TO_RUN
    return marks


def overall_marks(content: ReportContent) -> Marks:
    """The mark of every run for all requirements: one failure fails it, and without one a gap leaves it open."""
    overall = np.full(len(content.runs), Mark.PASS, dtype=np.uint8)
    for requirement in content.requirements:
        marks = marks_of(content, requirement)
        overall[(marks == Mark.NOT_EXERCISED) & (overall == Mark.PASS)] = Mark.NOT_EXERCISED
        overall[marks == Mark.FAIL] = Mark.FAIL
    overall[~content.runs.done] = Mark.FAILED_TO_RUN
    return overall


def margins(values: Floats, requirement: RequirementRow) -> Floats:
    """The distance of *values* to the nearer bound, in their unit: negative outside, NaN where they are."""
    margin = np.full(values.shape, np.inf)
    if requirement.at_least is not None:
        margin = np.minimum(margin, values - requirement.at_least)
    if requirement.at_most is not None:
        margin = np.minimum(margin, requirement.at_most - values)
    return margin


def outside(requirement: RequirementRow) -> str:
    """What values fail the requirement: ``> 5``, ``< 3`` or ``outside 3 … 5``."""
    if requirement.at_least is None:
        return f"> {requirement.at_most:g}"
    if requirement.at_most is None:
        return f"< {requirement.at_least:g}"
    return f"outside {requirement.at_least:g} \u2026 {requirement.at_most:g}"
